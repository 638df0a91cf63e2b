// SPDX-License-Identifier: MIT
// What contacts read of grains, eight at a time: from the places where they lie to one column per
// number, as vector instructions take them.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/four.hpp>
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

  /// columns[k][lane] = number k of the grain at places[lane]: position and radius …
  void load_places(const std::uint32_t* places, Column* columns) const {
    load_vectors(x_, places, columns + x);
    for (int lane = 0; lane < lanes; ++lane) columns[R][lane] = R_[places[lane]];
  }
  /// … and the rest.
  void load_motion(const std::uint32_t* places, Column* columns) const {
    load_vectors(v_, places, columns + v);
    if constexpr (Dim == 2) {
      for (int lane = 0; lane < lanes; ++lane) columns[w][lane] = w_[places[lane]];
    } else {
      load_vectors(w_, places, columns + w);
    }
    for (int lane = 0; lane < lanes; ++lane) columns[m][lane] = m_[places[lane]];
  }

 private:
  static void load_vectors(std::span<const Vec> values, const std::uint32_t* places,
                           Column* columns) {
    if constexpr (Dim == 2) {
      for (int lane = 0; lane < lanes; ++lane) {
        for (int k = 0; k < Dim; ++k) columns[k][lane] = values[places[lane]][k];
      }
    } else {
      // Four numbers from where a vector of three begins: the fourth is of the next one, and of no use. The
      // last vector has no next one.
      const auto end = static_cast<std::uint32_t>(values.size() - 1);
      unsigned any_is_last = 0;
      for (int lane = 0; lane < lanes; ++lane) any_is_last |= places[lane] == end;
      const auto load = [&](auto&& at) {
        for (int half = 0; half < lanes; half += 4) {
          transpose_four<Real>([&](int lane) { return at(places[half + lane]); },
                               [&](int number) { return &columns[number][half]; });
        }
      };
      if (any_is_last == 0) {
        load([&](std::uint32_t place) { return values[place].data(); });
      } else {
        const Real last[4] = {values[end][0], values[end][1], values[end][2], 0};
        load([&](std::uint32_t place) { return place == end ? last : values[place].data(); });
      }
    }
  }

  std::span<const Vec> x_;
  std::span<const Vec> v_;
  std::span<const Spin> w_;
  std::span<const Real> R_;
  std::span<const Real> m_;
};

}  // namespace silt::dem
