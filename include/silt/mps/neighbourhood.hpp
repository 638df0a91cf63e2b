// SPDX-License-Identifier: MIT
// Who is near whom, and with what weight: found once a step, and walked by every operator of it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace silt::mps {

/// The neighbours of fluid and wall particles within one stencil. Weights are kept in single precision
/// (their sums are not): half the memory to walk through.
template <int Dim, class RealType>
class Neighbourhood {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Neighbour {
    std::uint32_t index;  // owned or ghost
    float weight;
  };

  /// Asks the search for everyone's neighbours. Throws if two particles lie on one point.
  template <FluidParticles P, class S, class T>
  void find(const P& particles, const S& search, const T& stencil) {
    const auto x = particles.with_ghosts(position);
    positions_.assign(x.begin(), x.end());
    revision_ = particles.revision();
    density_.resize(particles.size());
    const auto kinds = particles[kind];
    rows_.build(particles.size(), [&](Index i, auto&& add) {
      Real density = 0;
      if (kinds[i] != Kind::dummy) {
        search.for_each_neighbour(i, [&](Index j, const Vec&, Real r) {
          if (!(r < stencil.re)) return;
          if (!(r > 0)) {
            fail("mps::Flow: two particles lie on one point; place them apart",
                 {.particle = i, .id = particles.id(i)});
          }
          const Real weight = stencil.weight(r);
          density += weight;
          add({static_cast<std::uint32_t>(j), static_cast<float>(weight)});
        });
      }
      density_[i] = density;
    });
  }

  /// Whether the particles still lie where they were found.
  template <FluidParticles P>
  bool is_of(const P& particles) const {
    const auto x = particles.with_ghosts(position);
    return particles.revision() == revision_ && x.size() == positions_.size() &&
           first_where(x.size(), [&](Index i) { return x[i] != positions_[i]; }) == nowhere;
  }

  /// f(j, r_ij, r) for the neighbours of i closer than `reach` [m].
  template <class F>
  void for_each_closer(Index i, Real reach, F&& f) const {
    // Which these are cannot be foreseen: noted without a branch, then handed over.
    std::array<std::uint32_t, 64> noted;
    const std::span<const Neighbour> row = rows_[i];
    const Vec x_i = positions_[i];
    for (Index from = 0; from < row.size(); from += noted.size()) {
      Index count = 0;
      for (Index k = from; k < std::min(row.size(), from + noted.size()); ++k) {
        const Vec r_ij = positions_[row[k].index] - x_i;
        noted[count] = row[k].index;
        count += r_ij.squaredNorm() < reach * reach;
      }
      for (Index k = 0; k < count; ++k) {
        const Vec r_ij = positions_[noted[k]] - x_i;
        f(Index(noted[k]), r_ij, r_ij.norm());
      }
    }
  }

  std::span<const Neighbour> operator[](Index i) const noexcept { return rows_[i]; }
  Vec position_of(Index i) const noexcept { return positions_[i]; }

  /// n_i = Σ w      (5)
  Real density(Index i) const noexcept { return density_[i]; }

 private:
  Rows<Neighbour> rows_;
  std::vector<Real> density_;
  std::vector<Vec> positions_;  // with ghosts
  std::uint64_t revision_ = 0;
};

/// f(j, r_ij, r, w) for every neighbour of i, as a search gives them to a stencil.
template <int Dim, class Real, class T, class F>
void for_each_weighted(const Neighbourhood<Dim, Real>& neighbourhood, Index i, const T&, F&& f) {
  const Vec<Dim, Real> x_i = neighbourhood.position_of(i);
  for (const auto& [j, weight] : neighbourhood[i]) {
    const Vec<Dim, Real> r_ij = neighbourhood.position_of(j) - x_i;
    f(Index(j), r_ij, r_ij.norm(), Real(weight));
  }
}

template <int Dim, class Real, class T, class F>
bool any_weighted(const Neighbourhood<Dim, Real>& neighbourhood, Index i, const T&, F&& f) {
  return std::ranges::any_of(neighbourhood[i],
                             [&f](const auto& j) { return f(Index(j.index), Real(j.weight)); });
}

}  // namespace silt::mps
