// SPDX-License-Identifier: MIT
// A prescribed motion of any type, chosen at run time.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <concepts>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace silt {

/// A RigidMotion of any type.
template <int Dim>
class AnyRigidMotion {
 public:
  // This and the destructor are not = default: g++ 12 fails in nested lists where a motion is left out.
  /// At rest.
  AnyRigidMotion() noexcept {}
  AnyRigidMotion(const AnyRigidMotion&) = default;
  AnyRigidMotion(AnyRigidMotion&&) noexcept = default;
  AnyRigidMotion& operator=(const AnyRigidMotion&) = default;
  AnyRigidMotion& operator=(AnyRigidMotion&&) noexcept = default;
  ~AnyRigidMotion() noexcept {}
  template <class M>
    requires(RigidMotion<M, Dim, double> && !std::same_as<M, AnyRigidMotion>)
  AnyRigidMotion(M motion) : motion_(std::make_shared<const Of<M>>(std::move(motion))) {}

  /// See RigidMotion.
  Pose<Dim> pose_at(double t) const { return motion_ ? motion_->pose_at(t) : Pose<Dim>{}; }
  RigidVelocity<Dim> velocity_at(double t) const {
    return motion_ ? motion_->velocity_at(t) : RigidVelocity<Dim>{};
  }
  /// From the pose at t [s] to the one at the end of a step of this length [s]. A motion that jumps between
  /// steps has such a function of its own, RigidMotion::move_in(t, time_step).
  Pose<Dim> move_in(double t, double time_step) const {
    return motion_ ? motion_->move_in(t, time_step) : Pose<Dim>{};
  }
  /// The period of the motion [s]; infinite if it has none.
  double period() const {
    return motion_ ? motion_->period() : std::numeric_limits<double>::infinity();
  }
  /// Throws if a parameter of the motion is out of range.
  void check() const {
    if (motion_) motion_->check();
  }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual Pose<Dim> pose_at(double t) const = 0;
    virtual RigidVelocity<Dim> velocity_at(double t) const = 0;
    virtual Pose<Dim> move_in(double t, double time_step) const = 0;
    virtual double period() const = 0;
    virtual void check() const = 0;
  };
  template <class M>
  struct Of final : Any {
    explicit Of(M given) : motion(std::move(given)) {}
    Pose<Dim> pose_at(double t) const override { return motion.pose_at(t); }
    RigidVelocity<Dim> velocity_at(double t) const override { return motion.velocity_at(t); }
    Pose<Dim> move_in(double t, double time_step) const override {
      if constexpr (requires { motion.move_in(t, time_step); }) {
        return motion.move_in(t, time_step);
      } else {
        return motion.pose_at(t + time_step).after(motion.pose_at(t).inverse());
      }
    }
    double period() const override {
      if constexpr (requires { motion.period(); }) return motion.period();
      return std::numeric_limits<double>::infinity();
    }
    void check() const override {
      if constexpr (requires { motion.check(); }) motion.check();
    }
    M motion;
  };

  std::shared_ptr<const Any> motion_;
};

}  // namespace silt
