// SPDX-License-Identifier: MIT
// The equations of motion of the leapfrog, [SahChoi2004] (15)–(33).
#pragma once

#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/integrate/motion_in_columns.hpp>
#include <silt/integrate/motion_in_rows.hpp>

#include <type_traits>

namespace silt {

namespace detail {
// Whichever is faster for the storage of the particles P.
template <class P>
using MotionInStorage =
    std::conditional_t<in_rows_of_four<P>() && 4 * sizeof(typename P::Real) <= simd::width,
                       MotionInRows<P>, MotionInColumns<P>>;
}  // namespace detail

/// The motion of particles, from the fields before a step to those after it: MotionInRows or
/// MotionInColumns, with the equations that are the same in both.
template <class P>
class MotionOf : public detail::MotionInStorage<P> {
  using Storage = detail::MotionInStorage<P>;
  using Real = typename P::Real;

 public:
  using State = typename Storage::State;
  using Storage::Storage;

  /// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33); dt [s].
  template <class D>
  [[gnu::always_inline]] void kick(State& p, const D& damping, double dt) const {
    Storage::template change_velocities<D>(
        p, [&](auto& v, const auto& a) { set(v, damping.kicked(v, a, Real(dt))); });
  }

  /// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28).
  template <class D>
  [[gnu::always_inline]] void kick_to_mean(State& p, const D& damping, double dt) const {
    Storage::template change_velocities<D>(
        p, [&](auto& v, const auto& a) { set(v, (damping.kicked(v, a, Real(dt)) + v) / 2); });
  }

  /// v^N → v^{N−½}.
  template <class D>
  [[gnu::always_inline]] void step_back(State& p, const D& damping, double dt) const {
    Storage::template change_velocities<D>(p, [&](auto& v, const auto& a) {
      if constexpr (requires { damping.half_step_before(v, a, Real(dt)); }) {
        set(v, damping.half_step_before(v, a, Real(dt)));
      } else {
        set(v, v - a * Real(dt / 2));
      }
    });
  }

 private:
  // A number may be computed with more digits than it is stored with.
  template <class Value>
  [[gnu::always_inline]] static void set(Value& v, const auto& value) {
    v = static_cast<Value>(value);
  }
};

}  // namespace silt
