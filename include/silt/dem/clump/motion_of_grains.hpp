// SPDX-License-Identifier: MIT
// Writes the motion of grains one by one, those of clumps as their clump moves.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/tuples.hpp>
#include <silt/core/types.hpp>

#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace silt::dem::detail {

/// A step of grains of type P, of which every grain must be written once; threads may write
/// different ones. Particles::finish_advance() makes the results theirs.
template <class P>
class MotionOfGrains {
  static constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  using Angular = AngularVec<Dim>;

 public:
  /// Grains drift for dt [s], which may be 0.
  MotionOfGrains(P& grains, double dt)
      : dt_(dt),
        box_(grains.box()),
        image_(grains.box()),
        x_(grains.advance(position)),
        v_(grains.advance(velocity)),
        w_(grains.advance(spin)),
        angles_(angles_of(grains)),
        f_(std::as_const(grains)[force]),
        t_(std::as_const(grains)[torque]),
        m_(std::as_const(grains)[mass]),
        I_(std::as_const(grains)[inertia]) {}

  /// Grain i has this velocity and spin, and drifts to x.
  void put(Index i, const Vec<Dim>& x, const Vec<Dim>& v, const Angular& w) {
    const auto before = x_.before[i];
    auto after = typename P::Vec(before);
    if (dt_ != 0) after = box_.wrap(typename P::Vec(x.template cast<Real>()));
    x_.after[i] = after;
    v_.after[i] = v.template cast<Real>();
    double sum = v.sum();
    for (int k = 0; k < angular_size<Dim>; ++k) {
      component(w_.after[i], k) = Real(component(w, k));
      sum += component(w, k);
    }
    if constexpr (has_angle) {
      angles_.after[i] = angles_.before[i] + Real(w * dt_);
      sum += angles_.after[i];
    }
    const double squared = double(image_(typename P::Vec(after - before)).squaredNorm());
    if (!is_finite(Real(sum)) || !is_finite(squared) || !box_.contains(after)) {
      is_valid_.store(false, std::memory_order_relaxed);
    }
    double highest = farthest_.load(std::memory_order_relaxed);
    while (squared > highest &&
           !farthest_.compare_exchange_weak(highest, squared, std::memory_order_relaxed)) {
    }
  }

  /// A grain that belongs to no clump: change(v, a) for each component of its velocity and spin.
  template <class Change>
  void change(Index i, const Change& change_of) {
    Vec<Dim> v = in_double(v_.before[i]);
    Angular w = in_double(w_.before[i]);
    const double per_mass = 1 / double(m_[i]);
    const double per_inertia = 1 / double(I_[i]);
    for (int k = 0; k < Dim; ++k) v[k] = change_of(v[k], double(f_[i][k]) * per_mass);
    for (int k = 0; k < angular_size<Dim>; ++k) {
      component(w, k) = change_of(component(w, k), double(component(t_[i], k)) * per_inertia);
    }
    put(i, in_double(x_.before[i]) + v * dt_, v, w);
  }

  /// Whether all results are finite and all grains within the box.
  bool is_valid() const { return is_valid_.load(std::memory_order_relaxed); }
  /// [m], rounded up; infinite if a result is not valid.
  double max_displacement() const {
    if (!is_valid()) return std::numeric_limits<double>::infinity();
    return std::sqrt(farthest_.load(std::memory_order_relaxed)) *
           (1 + 8 * double(std::numeric_limits<Real>::epsilon()));
  }

 private:
  static constexpr bool has_angle = HasFields<P, angle_t>;
  template <class F>
  using Advance = decltype(std::declval<P&>().advance(F{}));
  template <class F>
  using Values = decltype(std::declval<const P&>()[F{}]);
  struct NoAngle {};
  static auto angles_of(P& grains) {
    if constexpr (has_angle) {
      return grains.advance(angle);
    } else {
      return NoAngle{};
    }
  }

  double dt_;
  const Box<Dim, Real>& box_;
  NearestImage<Dim, Real> image_;
  Advance<position_t> x_;
  Advance<velocity_t> v_;
  Advance<spin_t> w_;
  decltype(angles_of(std::declval<P&>())) angles_;
  Values<force_t> f_;
  Values<torque_t> t_;
  Values<mass_t> m_;
  Values<inertia_t> I_;
  std::atomic<bool> is_valid_ = true;
  std::atomic<double> farthest_ = 0;
};

}  // namespace silt::dem::detail
