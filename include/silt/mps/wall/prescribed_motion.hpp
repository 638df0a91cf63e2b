// SPDX-License-Identifier: MIT
// Walls of a flow with a given motion.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/any_rigid_motion.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace silt::mps {

/// Faces of the walls of a flow that move together, as a rigid body.
template <int Dim>
struct MovingFaces {
  std::vector<Face<Dim>> faces;  ///< where they are defined, see Pose
  /// A RigidMotion, such as Translation, Rotation or Vibration; at rest if none is given.
  AnyRigidMotion<Dim> motion = {};
};

namespace detail {

/// The given motion of a group of faces, in steps that resolve it.
template <int Dim>
class PrescribedMotion {
 public:
  using Vec = silt::Vec<Dim>;

  /// Throws if the motion is invalid, or if there are no faces; the name begins the message.
  PrescribedMotion(std::string name, const MovingFaces<Dim>& group)
      : name_(std::move(name)), motion_(group.motion) {
    motion_.check();
    if (const double period = motion_.period(); !(period > 0)) {
      fail({name_, ": its motion has a period() of ", period, " s; give one above 0, or infinity"});
    }
    if (group.faces.empty()) fail({name_, " has no faces; give some, or no motion"});
    bounds_ = bounds_of(group.faces[0]);
    for (const Face<Dim>& face : group.faces) bounds_.enclose(bounds_of(face));
  }

  /// At a time [s].
  Pose<Dim> pose_at(double t) const { return motion_.pose_at(t); }
  /// From a time [s] on, of this length [s]. Throws if the motion is not finite, if its rotation is
  /// none, or if the step is longer than a tenth of its period or moves a face by more than the
  /// spacing [m].
  StepOfFaces<Dim> step(double t, double time_step, double spacing) const {
    StepOfFaces<Dim> step;
    step.before = motion_.pose_at(t);
    step.move = motion_.move_in(t, time_step);
    if (!step.before.shift.allFinite() || !step.move.shift.allFinite() ||
        !step.before.rotation.allFinite() || !step.move.rotation.allFinite()) {
      fail({name_, " has no finite position at ", t, " s or ", t + time_step,
            " s; correct its motion"});
    }
    const double not_orthogonal = (step.before.rotation.transpose() * step.before.rotation -
                                   Eigen::Matrix<double, Dim, Dim>::Identity())
                                      .norm();
    if (not_orthogonal > 1e-9 || step.before.rotation.determinant() < 0) {
      fail({name_, ": the rotation of its pose at ", t,
            " s is no rotation matrix; give an orthogonal one of determinant 1"});
    }
    if (time_step > motion_.period() / 10) {
      fail({name_, ": a time step of ", time_step,
            " s is more than a tenth of the period of its motion, ", motion_.period(),
            " s; reduce the time step, or the frequency"});
    }
    for (unsigned corner = 0; corner < 1u << Dim; ++corner) {
      const Vec from = step.before.x_of(corner_of_bounds(corner));
      const double distance = (step.move.x_of(from) - from).norm();
      if (!(distance > spacing)) continue;
      fail({name_, " moves by ", distance, " m in a step of ", time_step, " s at ", t,
            " s, more than the spacing = ", spacing,
            " m; let it move continuously, or reduce the time step"});
    }
    step.velocity.about = step.before.x_of((bounds_.lower + bounds_.upper) / 2);
    step.velocity.linear = (step.move.x_of(step.velocity.about) - step.velocity.about) / time_step;
    step.velocity.spin = turn_of(step.move.rotation) / time_step;
    return step;
  }
  /// Of the fastest point in a step [m/s].
  double max_speed(const StepOfFaces<Dim>& step) const {
    return max_speed(step.before, step.velocity);
  }
  /// The longest time step from time t [s] on, in which no face moves by more than `distance` [m]
  /// or a twentieth of the period [s].
  double longest_step(double t, double distance) const {
    const double speed = max_speed(motion_.pose_at(t), motion_.velocity_at(t));
    return std::min(distance / speed, motion_.period() / 20);
  }

 private:
  // Where they are defined.
  Vec corner_of_bounds(unsigned corner) const {
    Vec X;
    for (int k = 0; k < Dim; ++k) {
      X[k] = (corner >> k & 1u) ? bounds_.upper[k] : bounds_.lower[k];
    }
    return X;
  }
  // The largest of the corners of the bounds, and so of all points inside.
  double max_speed(const Pose<Dim>& pose, const RigidVelocity<Dim>& velocity) const {
    double fastest = 0;
    for (unsigned corner = 0; corner < 1u << Dim; ++corner) {
      fastest = std::max(fastest, velocity.at(pose.x_of(corner_of_bounds(corner))).norm());
    }
    return fastest;
  }

  std::string name_;
  AnyRigidMotion<Dim> motion_;
  typename Faces<Dim>::Bounds bounds_;  // where they are defined [m]
};

}  // namespace detail
}  // namespace silt::mps
