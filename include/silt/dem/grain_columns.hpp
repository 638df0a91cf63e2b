// SPDX-License-Identifier: MIT
// What contacts read of grains, eight at a time: from the places where they lie to one column per
// number, as vector instructions take them.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/transpose.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <span>

namespace silt::dem {

/// Contacts are worked on eight at a time.
inline constexpr int lanes = 8;

template <int Dim, class RealType>
class GrainColumns {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Spin = silt::Spin<Dim, Real>;

  /// One number of each of eight grains; these are their places.
  using Column = Real[lanes];
  static constexpr int x = 0;
  static constexpr int v = 4;
  static constexpr int w = 8;
  static constexpr int R = 12;
  static constexpr int m = 13;
  static constexpr int words = 14;

  /// Reads the grains, ghosts included, as long as they stay where they are.
  template <class P>
  explicit GrainColumns(const P& grains)
      : x_(grains.with_ghosts(position)),
        v_(grains.with_ghosts(velocity)),
        w_(grains.with_ghosts(spin)),
        R_(grains.with_ghosts(radius)),
        m_(grains.with_ghosts(mass)) {}

  /// columns[k][lane] = number k of the grain at places[lane].
  void load(const std::uint32_t* places, Column* columns) const {
    if constexpr (Dim == 2) {
      for (int lane = 0; lane < lanes; ++lane) {
        const Index i = places[lane];
        for (int k = 0; k < Dim; ++k) {
          columns[x + k][lane] = x_[i][k];
          columns[v + k][lane] = v_[i][k];
        }
        columns[w][lane] = w_[i];
      }
    } else {
      load_vectors(x_, places, columns + x);
      load_vectors(v_, places, columns + v);
      load_vectors(w_, places, columns + w);
    }
    for (int lane = 0; lane < lanes; ++lane) {
      columns[R][lane] = R_[places[lane]];
      columns[m][lane] = m_[places[lane]];
    }
  }

  /// Asks for grains that will be loaded soon.
  void prefetch(const std::uint32_t* places) const {
    for (int lane = 0; lane < lanes; ++lane) {
      __builtin_prefetch(&x_[places[lane]]);
      __builtin_prefetch(&v_[places[lane]]);
      __builtin_prefetch(&w_[places[lane]]);
    }
  }

 private:
  // Four numbers from where a vector of three begins: the fourth is of the next one, and of no use. The
  // last vector has no next one.
  static void load_vectors(std::span<const Vec> values, const std::uint32_t* places,
                           Column* columns) {
    Real last[4] = {};
    for (int k = 0; k < Dim; ++k) last[k] = values.back()[k];
    for (int half = 0; half < lanes; half += 4) {
      transpose_four<Real>(
          [&](int lane) -> const Real* {
            const Index i = places[half + lane];
            return i + 1 < values.size() ? values[i].data() : last;
          },
          [&](int number) { return &columns[number][half]; });
    }
  }

  std::span<const Vec> x_;
  std::span<const Vec> v_;
  std::span<const Spin> w_;
  std::span<const Real> R_;
  std::span<const Real> m_;
};

}  // namespace silt::dem
