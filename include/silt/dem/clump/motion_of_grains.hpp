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
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
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
        radii_(grains.advance(radius)),
        masses_(grains.advance(clump_mass)),
        inertias_(grains.advance(inertia)),
        angles_(angles_of(grains)),
        f_(std::as_const(grains)[force]),
        t_(std::as_const(grains)[torque]),
        m_(std::as_const(grains)[mass]) {}

  /// Writes some of the grains, in one thread.
  class Range {
   public:
    explicit Range(MotionOfGrains& all) : all_(all) {}
    Range(const Range&) = delete;
    Range& operator=(const Range&) = delete;
    ~Range() { all_.add(squared_displacement_, broken_); }

    /// Soon needed.
    void fetch(Index i) const {
      __builtin_prefetch(&all_.f_[i]);
      __builtin_prefetch(&all_.t_[i]);
      __builtin_prefetch(&all_.x_.before[i][0]);
      __builtin_prefetch(&all_.x_.after[i][0], 1);
      __builtin_prefetch(&component(all_.w_.after[i], 0), 1);
    }
    /// Grain i has this velocity and spin, and drifts to x.
    void operator()(Index i, const Vec<Dim>& x, const Vec<Dim>& v, const Angular& w) {
      const typename P::Vec before = all_.x_.before[i];
      typename P::Vec after = before;
      if (all_.dt_ != 0) after = all_.wrapped(x.template cast<Real>());
      all_.x_.after[i] = after;
      all_.keep_constants(i);
      all_.v_.after[i] = v.template cast<Real>();
      double sum = v.sum() + double(after.sum());
      for (int k = 0; k < angular_size<Dim>; ++k) {
        component(all_.w_.after[i], k) = Real(component(w, k));
        sum += component(w, k);
      }
      if constexpr (has_angle) {
        all_.angles_.after[i] = all_.angles_.before[i] + Real(w * all_.dt_);
        sum += all_.angles_.after[i];
      }
      broken_ += sum - sum;
      if (!all_.box_.contains(after)) broken_ = std::numeric_limits<double>::quiet_NaN();
      const auto squared = double(all_.image_(typename P::Vec(after - before)).squaredNorm());
      squared_displacement_ = std::max(squared, squared_displacement_);
    }

    /// A grain that belongs to no clump: change(v, a) for each component of its velocity and spin.
    template <class Change>
    void change(Index i, const Change& change_of) {
      Vec<Dim> v = in_double(all_.v_.before[i]);
      Angular w = in_double(all_.w_.before[i]);
      const double per_mass = 1 / double(all_.m_[i]);
      const double per_inertia = 1 / double(all_.inertias_.before[i]);
      for (int k = 0; k < Dim; ++k) v[k] = change_of(v[k], double(all_.f_[i][k]) * per_mass);
      for (int k = 0; k < angular_size<Dim>; ++k) {
        component(w, k) =
            change_of(component(w, k), double(component(all_.t_[i], k)) * per_inertia);
      }
      (*this)(i, in_double(all_.x_.before[i]) + v * all_.dt_, v, w);
    }

   private:
    MotionOfGrains& all_;
    double squared_displacement_ = 0;
    double broken_ = 0;  // not 0 if a result is not valid
  };
  Range range() { return Range(*this); }

  /// Whether all results are finite and all grains within the box.
  bool is_valid() const { return is_valid_.load(std::memory_order_relaxed); }
  /// [m], rounded up; infinite if a result is not valid.
  double max_displacement() const {
    if (!is_valid()) return std::numeric_limits<double>::infinity();
    return std::sqrt(farthest_.load(std::memory_order_relaxed)) *
           (1 + 8 * double(std::numeric_limits<Real>::epsilon()));
  }

 private:
  void add(double squared_displacement, double broken) {
    if (broken != 0) is_valid_.store(false, std::memory_order_relaxed);
    double highest = farthest_.load(std::memory_order_relaxed);
    while (squared_displacement > highest &&
           !farthest_.compare_exchange_weak(highest, squared_displacement,
                                            std::memory_order_relaxed)) {
    }
  }
  // In the same rows as what changes: to write them here saves passes over all grains.
  void keep_constants(Index i) {
    radii_.after[i] = radii_.before[i];
    masses_.after[i] = masses_.before[i];
    inertias_.after[i] = inertias_.before[i];
  }
  typename P::Vec wrapped(const typename P::Vec& x) const {
    return image_.any() ? box_.wrap(x) : x;
  }

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
  Advance<radius_t> radii_;
  Advance<clump_mass_t> masses_;
  Advance<inertia_t> inertias_;
  decltype(angles_of(std::declval<P&>())) angles_;
  Values<force_t> f_;
  Values<torque_t> t_;
  Values<mass_t> m_;
  std::atomic<bool> is_valid_ = true;
  std::atomic<double> farthest_ = 0;
};

}  // namespace silt::dem::detail
