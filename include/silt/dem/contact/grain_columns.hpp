// SPDX-License-Identifier: MIT
// Loads the data of several grains into SIMD registers, one register per number.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/four.hpp>

#include <algorithm>
#include <cstdint>

namespace silt::dem {

/// Contacts are evaluated eight at a time.
inline constexpr int lanes = 8;

template <int Dim, class RealType>
class GrainColumns {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  /// Number of grains per register.
  static constexpr int N = std::min(lanes, simd::lanes<Real>);
  using Pack = simd::Pack<Real, N>;
  struct Position {
    Pack x[Dim];  ///< [m]
    Pack R;       ///< [m]
  };
  struct Motion {
    Pack v[Dim];                ///< [m/s]
    Pack w[angular_size<Dim>];  ///< [1/s]
    Pack m;                     ///< [kg]
  };

  /// Refers to the grains, including ghosts; invalid once they move in memory.
  template <class P>
  explicit GrainColumns(const P& grains)
      : x_(grains.with_ghosts(position).data()),
        v_(grains.with_ghosts(velocity).data()),
        w_(grains.with_ghosts(spin).data()),
        R_(grains.with_ghosts(radius).data()),
        m_(grains.with_ghosts(mass).data()),
        last_(static_cast<std::uint32_t>(grains.total() - 1)) {}

  [[gnu::always_inline]] void load(const std::uint32_t* places, Position& grains) const {
    load(x_, places, grains.x);
    load(R_, places, grains.R);
  }
  [[gnu::always_inline]] void load(const std::uint32_t* places, Motion& grains) const {
    load(v_, places, grains.v);
    if constexpr (Dim == 2) {
      load(w_, places, grains.w[0]);
    } else {
      load(w_, places, grains.w);
    }
    load(m_, places, grains.m);
  }

 private:
  [[gnu::always_inline]] static void load(const Real* values, const std::uint32_t* places,
                                          Pack& numbers) {
    Real column[N];
    for (int lane = 0; lane < N; ++lane) column[lane] = values[places[lane]];
    numbers = simd::load<Real, N>(column);
  }
  [[gnu::always_inline]] void load(const Vec* values, const std::uint32_t* places,
                                   Pack (&columns)[Dim]) const {
    // Load four numbers from the beginning of a vector of three; the fourth belongs to the next
    // vector and is ignored. There is none after the last vector.
    const auto all = simd::first_lanes<N>(N);
    if (Dim == 3 && simd::differs<N>(simd::load<std::uint32_t, N>(places), last_) == all) {
      Pack four[4];
      columns_from<Real, N>([=](int lane) { return values[places[lane]].data(); }, four);
      std::copy_n(four, Dim, columns);
    } else {
      Real column[N];
      for (int k = 0; k < Dim; ++k) {
        for (int lane = 0; lane < N; ++lane) column[lane] = values[places[lane]][k];
        columns[k] = simd::load<Real, N>(column);
      }
    }
  }

  const Vec* x_;
  const Vec* v_;
  const AngularVec* w_;
  const Real* R_;
  const Real* m_;
  std::uint32_t last_;
};

}  // namespace silt::dem
