// SPDX-License-Identifier: MIT
// What contacts read of a grain, side by side in memory: one or two cache lines for a grain that lies
// anywhere, where its columns would take six.
//
//   3D  x y z R | v v v m | w w w material          2D  x y R m | v v w material
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/transpose.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace silt::dem {

/// Contacts are worked on eight at a time.
inline constexpr int lanes = 8;

template <int Dim, class RealType>
class GrainRows {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  // Places of the numbers in a row.
  static constexpr int x = 0;
  static constexpr int R = Dim;
  static constexpr int m = Dim == 3 ? 7 : 3;
  static constexpr int v = 4;
  static constexpr int w = Dim == 3 ? 8 : 6;
  static constexpr int material = Dim == 3 ? 11 : 7;
  static constexpr int words = material + 1;

  /// One number of each of eight grains.
  using Column = Real[lanes];

  /// Where grains were, and how far from there a look finds them still near [m].
  struct Reference {
    const std::vector<Vec>& positions;  ///< of the owned grains, or empty
    Real near;
  };
  /// What a look at all grains tells.
  struct Look {
    Index odd = nowhere;  ///< first owned grain with radius or mass not positive, or of no material
    bool all_near = true;  ///< every owned grain is still near its reference
  };

  /// Copies owned grains and ghosts.
  template <class P>
  Look take(const P& grains, const Reference& reference, std::uint32_t materials_known) {
    const Index owned = grains.size();
    const Index total = grains.total();
    const auto xs = grains.with_ghosts(position);
    const auto vs = grains.with_ghosts(velocity);
    const auto ws = grains.with_ghosts(spin);
    const auto Rs = grains.with_ghosts(radius);
    const auto ms = grains.with_ghosts(mass);
    const auto materials = grains.with_ghosts(dem::material);
    rows_.resize(total * words);
    looks_.resize(chunk_count(total));
    const bool compares = reference.positions.size() == owned;
    const Real near_squared = squared(reference.near);
    for_each_chunk(total, [&](Chunk chunk) {
      for (Index i = chunk.first; i < chunk.last; ++i) {
        Real* const row = &rows_[i * words];
        for (int k = 0; k < Dim; ++k) {
          row[x + k] = xs[i][k];
          row[v + k] = vs[i][k];
        }
        row[R] = Rs[i];
        row[m] = ms[i];
        if constexpr (Dim == 2) {
          row[w] = ws[i];
        } else {
          for (int k = 0; k < Dim; ++k) row[w + k] = ws[i][k];
        }
        row[material] = static_cast<Real>(materials[i]);
      }
      Look look;
      bool all_near = compares;
      bool all_sound = true;
      for (Index i = chunk.first; i < std::min(chunk.last, owned); ++i) {
        all_sound &= (Rs[i] > 0) & (ms[i] > 0) & (materials[i] < materials_known);
        // Not "beyond": a NaN is not near.
        if (compares) all_near &= (xs[i] - reference.positions[i]).squaredNorm() <= near_squared;
      }
      look.all_near = all_near;
      for (Index i = chunk.first; !all_sound && look.odd == nowhere; ++i) {
        if (!(Rs[i] > 0 && ms[i] > 0 && materials[i] < materials_known)) look.odd = i;
      }
      looks_[chunk.number] = look;
    });
    Look all{.all_near = compares};
    for (const Look& look : looks_) {
      all.odd = std::min(all.odd, look.odd);
      all.all_near &= look.all_near;
    }
    return all;
  }

  const Real* operator[](Index i) const noexcept { return &rows_[i * words]; }

  /// Asks for the rows of eight grains that will be loaded soon.
  void prefetch(const std::uint32_t* places) const {
    for (int lane = 0; lane < lanes; ++lane) {
      const Real* const row = &rows_[Index(places[lane]) * words];
      __builtin_prefetch(row);
      __builtin_prefetch(row + words - 1);
    }
  }

  /// columns[k][lane] = number k of the grain at places[lane].
  void load(const std::uint32_t* places, Column* columns) const {
    for (int half = 0; half < lanes; half += 4) {
      for (int k = 0; k < words; k += 4) {
        transpose_four<Real>(
            [&](int lane) { return &rows_[Index(places[half + lane]) * words + Index(k)]; },
            [&](int number) { return &columns[k + number][half]; });
      }
    }
  }

 private:
  std::vector<Real> rows_;
  std::vector<Look> looks_;
};

}  // namespace silt::dem
