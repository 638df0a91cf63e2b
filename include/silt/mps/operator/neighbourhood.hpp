// SPDX-License-Identifier: MIT
// Neighbours and their weights: updated once per step, and used by all operators of the step.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/weighted_rows.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace silt::mps {

/// All neighbours are visible, with all of their weight.
struct AllVisible {
  /// True, see HidesNeighbours.
  static constexpr bool sees_all(Index) { return true; }
  /// 1 [-], see HidesNeighbours.
  static constexpr double visible_share(Index, Index) { return 1; }
};

/// The neighbours of fluid and wall particles within one stencil. Their weights are in single precision,
/// sums are not.
template <int Dim, class RealType>
class Neighbourhood {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Updates all neighbours from the search. Throws if two particles coincide, to the round-off of
  /// weights in single precision.
  template <FluidParticles P, class S, class T>
  void find(const P& particles, const S& search, const T& stencil) {
    find(particles, search, stencil, AllVisible{});
  }
  /// The same with weights times visible.visible_share(i, j), for those neighbours j of i for which
  /// this is positive; visible.sees_all(i) tells that it is 1 for all of them.
  template <FluidParticles P, class S, class T, class Visible>
  void find(const P& particles, const S& search, const T& stencil, const Visible& visible) {
    const auto x = particles.with_ghosts(position);
    revision_ = 0;  // until all neighbours are found
    positions_.assign(x.begin(), x.end());
    rows_.assign(particles.size(), RowPlace{});
    density_.assign(particles.size(), 0);
    sets_.resize(row_sets(x.size()));
    for (WeightedRows<Real>& rows : sets_) rows.clear();
    const auto has_row = [kinds = particles[kind]](Index i) { return kinds[i] != Kind::dummy; };
    using Indices = std::span<const std::uint32_t>;
    for_each_row(particles, search, has_row, [&](Index set, Index i, Indices js) {
      const auto added =
          run_inlined([&] { return sets_[set].add(i, js, positions_, stencil, visible); });
      rows_[i] = {added.row, static_cast<std::uint32_t>(set)};
      density_[i] = added.density;
      if (!added.is_distinct) refuse_coincident(particles, i, js, stencil);
    });
    revision_ = particles.revision();
  }

  /// Whether no particle was added, removed, sorted or moved since the last update.
  template <FluidParticles P>
  bool is_current(const P& particles) const {
    const auto x = particles.with_ghosts(position);
    return has_rows_of(particles) && x.size() == positions_.size() &&
           first_where(x.size(), [&](Index i) { return x[i] != positions_[i]; }) == no_index;
  }

  /// Whether the rows of particles are those of the last update.
  template <FluidParticles P>
  bool has_rows_of(const P& particles) const {
    return particles.revision() == revision_;
  }

  /// f(j, r_ij, r) for the neighbours of i closer than `reach` [m]. All of them must have a weight
  /// above min_weight; the positions of others need not be read.
  template <class F>
  void for_each_closer(Index i, Real reach, float min_weight, F&& f) const {
    constexpr Index step = simd::lanes<float>;
    constexpr Index block = 4 * step;
    std::array<std::uint32_t, block> candidates;
    const WeightedRow row = (*this)[i];
    const Vec x_i = positions_[i];
    const auto limit = simd::broadcast<float>(min_weight);
    for (Index from = 0; from < row.size(); from += block) {
      Index count = 0;
      const Index end = std::min(row.size(), from + block);
      for (Index k = from; k < end; k += step) {
        const simd::Mask heavy = simd::less<float>(limit, simd::load(row.weight + k));
        count += simd::compress<std::uint32_t>(&candidates[count], simd::load(row.index + k),
                                               heavy & simd::first_lanes<step>(end - k));
      }
      for (Index k = 0; k < count; ++k) {
        const Vec r_ij = positions_[candidates[k]] - x_i;
        const Real r2 = r_ij.squaredNorm();
        if (r2 < reach * reach) f(Index(candidates[k]), r_ij, std::sqrt(r2));
      }
    }
  }

  WeightedRow operator[](Index i) const noexcept { return sets_[rows_[i].set][rows_[i].row]; }
  /// Position of a particle or ghost when the neighbours were found [m].
  Vec position_of(Index i) const noexcept { return positions_[i]; }
  /// Of all particles and ghosts.
  std::span<const Vec> positions() const noexcept { return positions_; }

  /// n_i = Σ w [-]      (5)
  Real density(Index i) const noexcept { return density_[i]; }

 private:
  struct RowPlace {
    typename WeightedRows<Real>::Place row;
    std::uint32_t set = 0;  // in sets_
  };

  // f(set, i, js) for the particles that have a row; js may include particles beyond the radius.
  // All rows of a set are processed by one thread.
  template <class P, class S, class HasRow, class F>
  static void for_each_row(const P& particles, const S& search, const HasRow& has_row, F&& f) {
    if constexpr (requires { search.for_each_row(has_row, f); }) {
      search.for_each_row(has_row, f);
    } else {
      for_each_range<rows_together>(particles.size(), [&](Index first, Index last) {
        static thread_local Buffer<std::uint32_t> js;  // keeps its capacity
        for (Index i = first; i < last; ++i) {
          if (!has_row(i)) continue;
          js.clear();
          search.for_each_neighbour(
              i, [](Index j, const Vec&, Real) { js.push_back(static_cast<std::uint32_t>(j)); });
          f(first / rows_together, i, std::span<const std::uint32_t>(js));
        }
      });
    }
  }

  template <class P, class T>
  [[noreturn, gnu::cold, gnu::noinline]] void refuse_coincident(const P& particles, Index i,
                                                                std::span<const std::uint32_t> js,
                                                                const T& stencil) const {
    const auto other = std::find_if(js.begin(), js.end(), [&](std::uint32_t j) {
      return !((positions_[j] - positions_[i]).squaredNorm() > least_square(stencil));
    });
    const Id id = particles.id(i);
    const Id id_of_other = particles.id(particles.owner(*other));
    fail({"mps::Flow: two particles have the same position, those with the ids ",
          std::min(id, id_of_other), " and ", std::max(id, id_of_other), "; move them apart"},
         {.particle = i, .id = id});
  }

  Buffer<RowPlace> rows_;  // by particle
  Buffer<WeightedRows<Real>> sets_;
  Buffer<Real> density_;
  Buffer<Vec> positions_;  // with ghosts
  std::uint64_t revision_ = 0;
};

/// f(j, r_ij, w, w/r²) for every neighbour of i, as for a search. Inlined, so that the sums of f
/// stay in registers; storing them in memory would dominate the run time.
template <int Dim, class Real, class T, class F>
[[gnu::always_inline]] inline void for_each_weighted(const Neighbourhood<Dim, Real>& neighbourhood,
                                                     Index i, const T&, F&& f) {
  const Vec<Dim, Real> x_i = neighbourhood.position_of(i);
  const auto row = neighbourhood[i];
  for (Index k = 0; k < row.size(); ++k) {
    const Vec<Dim, Real> r_ij = neighbourhood.position_of(row.index[k]) - x_i;
    f(Index(row.index[k]), r_ij, Real(row.weight[k]), Real(row.weight_over_square[k]));
  }
}

/// Whether f(j, w) is true for any neighbour of i.
template <int Dim, class Real, class T, class F>
bool any_weighted(const Neighbourhood<Dim, Real>& neighbourhood, Index i, const T&, F&& f) {
  const auto row = neighbourhood[i];
  for (Index k = 0; k < row.size(); ++k) {
    if (f(Index(row.index[k]), Real(row.weight[k]))) return true;
  }
  return false;
}

}  // namespace silt::mps
