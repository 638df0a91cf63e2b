// SPDX-License-Identifier: MIT
// Who is near whom, and with what weight: found once a step, and walked by every operator of it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
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
    rows_.assign(particles.size(), Row{});
    density_.assign(particles.size(), 0);
    entries_.resize(chunk_count(x.size()));
    used_.assign(entries_.size(), 0);
    const auto has_row = [kinds = particles[kind]](Index i) { return kinds[i] != Kind::dummy; };
    for_each_row(particles, search, has_row, [&](Index chunk, Index i, std::span<const std::uint32_t> js) {
      if (!add_row(chunk, i, js, stencil)) {
        fail("mps::Flow: two particles lie on one point; place them apart",
             {.particle = i, .id = particles.id(i)});
      }
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
    const std::span<const Neighbour> row = (*this)[i];
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

  std::span<const Neighbour> operator[](Index i) const noexcept {
    const Row& row = rows_[i];
    return {entries_[row.chunk].data() + row.first, row.length};
  }
  Vec position_of(Index i) const noexcept { return positions_[i]; }

  /// n_i = Σ w      (5)
  Real density(Index i) const noexcept { return density_[i]; }

 private:
  // Where the neighbours of a particle stand.
  struct Row {
    std::uint32_t chunk = 0;
    std::uint32_t first = 0;
    std::uint32_t length = 0;
  };

  // f(chunk, i, js) for the particles that have a row; js may hold some that are too far. What is
  // of one chunk comes from one thread.
  template <class P, class S, class HasRow, class F>
  static void for_each_row(const P& particles, const S& search, const HasRow& has_row, F&& f) {
    if constexpr (requires { search.for_each_row(has_row, f); }) {
      search.for_each_row(has_row, f);
    } else {
      for_each_chunk(particles.size(), [&](Chunk chunk) {
        std::vector<std::uint32_t> js;
        for (Index i = chunk.first; i < chunk.last; ++i) {
          if (!has_row(i)) continue;
          js.clear();
          search.for_each_neighbour(
              i, [&js](Index j, const Vec&, Real) { js.push_back(static_cast<std::uint32_t>(j)); });
          f(chunk.number, i, std::span<const std::uint32_t>(js));
        }
      });
    }
  }

  // False if one of them lies where i does.
  template <class T>
  bool add_row(Index chunk, Index i, std::span<const std::uint32_t> js, const T& stencil) {
    constexpr Index block = 32;  // so many at a time, so that the weights are taken in registers
    auto& entries = entries_[chunk];
    Index& used = used_[chunk];
    if (used + js.size() > entries.size()) {
      entries.reserve((used + js.size()) * 9 / 8);  // resize() alone would double it
      entries.resize(entries.capacity());
    }
    const Index first = used;
    const Vec x_i = positions_[i];
    const Real re2 = stencil.re * stencil.re;
    Real density = 0;
    bool apart = true;
    for (Index from = 0; from < js.size(); from += block) {
      const Index count = std::min(block, js.size() - from);
      std::array<Real, block> r2;
      std::array<Real, block> weight;
      r2.fill(re2);
      for (Index k = 0; k < count; ++k) r2[k] = (positions_[js[from + k]] - x_i).squaredNorm();
      for (Index k = 0; k < block; ++k) weight[k] = stencil.weight(std::sqrt(r2[k]));
      for (Index k = 0; k < count; ++k) {
        const bool near = r2[k] < re2;
        entries[used] = {js[from + k], static_cast<float>(weight[k])};
        used += near;
        density += near ? weight[k] : 0;
        apart &= r2[k] > 0;
      }
    }
    density_[i] = density;
    rows_[i] = {static_cast<std::uint32_t>(chunk), static_cast<std::uint32_t>(first),
                static_cast<std::uint32_t>(used - first)};
    return apart;
  }

  std::vector<Row> rows_;
  std::vector<std::vector<Neighbour>> entries_;  // by chunk, and room for more
  std::vector<Index> used_;                      // of these, by chunk
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
