// SPDX-License-Identifier: MIT
// Walls of individual particles.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/operators.hpp>

namespace silt::mps {

/// Walls of individual fixed particles, as in the schemes of the paper. They are rough: fluid that
/// slides along them is slowed down by each particle. Wall particles on the free surface have
/// P = 0.
struct GrainyWalls {
  template <int Dim, class RealType>
  class InFlow;
};

template <int Dim, class RealType>
class GrainyWalls::InFlow {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  explicit InFlow(const GrainyWalls&) {}

  /// Does nothing: the walls are particles.
  template <class P, class Operators>
  void find(const P&, const Operators&) {}

  template <class View, class U>
  Real divergence(const View& at, const U& u) const {
    return mps::divergence(at.stencil(), Vec(u[at.index()]), at.values_of(u));
  }
  template <class View>
  bool is_dry(const View&) const {
    return false;
  }
  bool has_pressure(Kind of_kind, bool /*on_surface*/) const { return of_kind != Kind::dummy; }

  template <class Pairs, class CollisionModel>
  Vec velocity_change(const Pairs& pairs, const CollisionModel& collision) const {
    Vec change = Vec::Zero();
    pairs.for_each([&](const auto& pair, Index) { change += collision.velocity_change(pair); });
    return change;
  }
};

}  // namespace silt::mps
