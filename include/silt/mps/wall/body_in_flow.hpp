// SPDX-License-Identifier: MIT
// A rigid body in a flow, moved by the pressure, by gravity and by other forces.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/orientation.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/mps/wall/floating_body.hpp>
#include <silt/mps/wall/floating_body_checks.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace silt::mps {

/// What the fluid near a body has in common.
template <int Dim>
struct WettedBounds {
  Vec<Dim> size = Vec<Dim>::Zero();    ///< of the box around the wetted part of the body [m]
  Vec<Dim> centre = Vec<Dim>::Zero();  ///< of the box [m]
  double density = 0;                  ///< of the fluid [kg/m³]
};

/// A floating body in a flow. The velocity V of its momentum m V follows from the loads of each
/// step, exactly. Its faces move in the next step with a velocity W that follows V:
///
///   W ← W + θ (V − W) + Δt A,   A ← A + θ (V − W)/(4 Δt),   θ = m/(m + M)
///
/// as the load has a part −Mₐ ΔW/Δt, Mₐ the added mass: W = V (θ = 1) would be unstable for a body
/// lighter than its added mass. With M > 0.44 Mₐ − 0.56 m it is stable at every density; M is twice
/// the added mass of a plate as large as the wetted part. A, the acceleration, lets W keep up with
/// a V that changes steadily, and the poles of V − W are those of critical damping for Mₐ = M. The
/// spin follows likewise.
template <int Dim>
class BodyInFlow {
 public:
  using Vec = silt::Vec<Dim>;
  using Angular = AngularVec<Dim>;  ///< [1/s]

  /// Throws if the body is invalid; `name` identifies it.
  BodyInFlow(const std::string& name, const FloatingBody<Dim>& body) : body_(body) {
    require_finite((name + ": velocity").c_str(), body.velocity);
    require_finite((name + ": spin").c_str(), body.spin);
    require_not_negative((name + ": friction").c_str(), body.friction);
    if (body.keeps_orientation && squared_norm(body.spin) > 0) {
      fail({name, ": spin = ", to_text(body.spin), " 1/s, but it keeps its orientation; give no spin"});
    }
    if (body.mass_properties) {
      mass_ = *body.mass_properties;
      require_valid(name, mass_);
      const MassProperties<Dim> of_volume = mass_properties_of(name, body.faces, 1);  // or throws
      volume_ = of_volume.mass;
      centre_of_volume_ = of_volume.centre;
    } else {
      require_positive((name + ": density").c_str(), body.density);
      mass_ = mass_properties_of(name, body.faces, body.density);
      volume_ = mass_.mass / body.density;
      centre_of_volume_ = mass_.centre;
      require_positive((name + ": mass").c_str(), mass_.mass);
      if (!is_inertia(mass_.inertia)) {
        fail({name, ": the moment of inertia that follows from its faces is ",
              inertia_to_text(mass_.inertia),
              " kg m²; let no faces cross each other, and all normals be outwards"});
      }
    }
    if (body.radius != 0) {
      deviation_ = detail::deviation_of_round(name, body, volume_, centre_of_volume_);
    }
    Vec lower = body.faces[0].corners[0], upper = lower;
    for (const Face<Dim>& face : body.faces) {
      for (const Vec& corner : face.corners) {
        largest_distance_ = std::max(largest_distance_, (corner - mass_.centre).norm());
        lower = lower.cwiseMin(corner);
        upper = upper.cwiseMax(corner);
      }
    }
    const double size = (upper - lower).norm();
    if (!(largest_distance_ <= 3 * size)) {
      fail({name, ": the centre of mass ", to_text(mass_.centre), " m is ", largest_distance_,
            " m away from faces of a body of ", size,
            " m; give mass_properties of the body where its faces are defined"});
    }
    now_.position = mass_.centre;
    now_.velocity = now_.of_faces.velocity = body.velocity;
    now_.spin = now_.spin_of_faces.velocity = body.spin;
  }

  /// Where they are defined.
  const std::vector<Face<Dim>>& faces() const { return body_.faces; }
  const MassProperties<Dim>& mass_properties() const { return mass_; }
  /// With the velocity of its faces, W.
  BodyState<Dim> state() const {
    return {.pose = pose(),
            .position = now_.position,
            .orientation = now_.orientation,
            .velocity = now_.of_faces.velocity,
            .spin = now_.spin_of_faces.velocity};
  }
  double volume() const { return volume_; }  ///< inside its faces [m³]
  double friction() const { return body_.friction; }  ///< coefficient [-]
  double radius() const { return body_.radius; }  ///< of a disc or a sphere [m]; 0 if it is none
  /// Of its faces from its radius, at most [m].
  double deviation_of_faces() const { return deviation_; }
  Vec centre_of_volume() const { return pose().x_of(centre_of_volume_); }  ///< now [m]
  /// Whether the fluid cannot move it.
  bool is_held() const {
    return body_.keeps_orientation && std::ranges::all_of(body_.is_held, std::identity{});
  }
  Vec momentum() const { return mass_.mass * now_.velocity; }  ///< m V [kg m/s]
  /// Of contacts with walls and other bodies in the last step [N s].
  const Vec& impulse_of_contacts() const { return now_.impulse_of_contacts; }

  const BodyLoad<Dim>& load_of_user() const { return load_of_user_; }  ///< in the step
  /// Of its faces, at most [m/s].
  double max_speed() const {
    return now_.of_faces.velocity.norm() +
           largest_distance_ * std::sqrt(squared_norm(now_.spin_of_faces.velocity));
  }

  /// The step of its faces from now on, of this length [s].
  StepOfFaces<Dim> step(double time_step) const {
    const auto [velocity_of_faces, spin] = velocities();
    StepOfFaces<Dim> step;
    step.before = pose();
    step.velocity = {.linear = velocity_of_faces, .spin = spin, .about = now_.position};
    const Angular turn = spin * time_step;
    step.move.rotation = Orientation<Dim>{}.turned(turn).matrix();
    step.move.shift = now_.position + time_step * velocity_of_faces -
                      multiply<Dim, double>(step.move.rotation, now_.position);
    return step;
  }
  /// Begins a step at a time [s], of this length [s]. Throws if the load of the user is not finite;
  /// `name` identifies the body.
  void begin_step(const std::string& name, double time, double time_step) {
    time_step_ = time_step;
    now_.impulse_of_contacts.setZero();
    load_of_user_ = {};
    if (!body_.load) return;
    load_of_user_ = body_.load(state(), time);
    require_finite((name + ": load: force").c_str(), load_of_user_.force);
    require_finite((name + ": load: torque").c_str(), load_of_user_.torque);
  }
  /// Velocity of the centre of mass [m/s] and spin [1/s].
  struct Velocities {
    Vec linear;    ///< [m/s]
    Angular spin;  ///< [1/s]
  };
  /// V after a step with this load of the fluid, less W. The acceleration is that of gravity and other
  /// forces on each kilogram [m/s²].
  Velocities behind(const BodyLoad<Dim>& load, const Vec& acceleration, double time_step) const {
    const State end = after(load, acceleration, time_step);
    return {Vec(end.velocity - now_.of_faces.velocity),
            Angular(end.spin - now_.spin_of_faces.velocity)};
  }
  /// Changes W, within a step.
  void change_faces(const Velocities& change) {
    now_.of_faces.velocity += change.linear;
    now_.spin_of_faces.velocity += change.spin;
  }
  /// θ of this step [-], for each axis and for the spin.
  void set_shares(const WettedBounds<Dim>& wetted) {
    const Vec mass = added_mass(wetted);
    for (int k = 0; k < Dim; ++k) now_.share[k] = mass_.mass / (mass_.mass + mass[k]);
    // About the centre of mass; the axis of the spin may be any.
    const double inertia =
        added_inertia(wetted) + mass.maxCoeff() * (wetted.centre - now_.position).squaredNorm();
    now_.share_of_spin = least_inertia() / (least_inertia() + inertia);
  }
  const Vec& share() const { return now_.share; }             ///< θ of each axis [-]
  double share_of_spin() const { return now_.share_of_spin; }  ///< [-]
  double least_inertia() const {                               ///< about any axis [kg m²]
    if constexpr (Dim == 2) {
      return mass_.inertia;
    } else {
      // At most the least of the principal ones.
      const Vec diagonal = mass_.inertia.diagonal();
      return std::max(diagonal.minCoeff() - (mass_.inertia - Matrix(diagonal.asDiagonal())).norm(),
                      0.1 * diagonal.minCoeff());
    }
  }
  /// Ends a step of this length [s]; the load is that of the fluid, see behind().
  void end_step(const BodyLoad<Dim>& load, const Vec& acceleration, double time_step) {
    const auto [velocity_of_faces, spin_of_faces] = velocities();
    const State end = after(load, acceleration, time_step);
    now_.position += time_step * velocity_of_faces;
    now_.orientation = end.orientation;
    now_.velocity = end.velocity;
    now_.spin = end.spin;
    for (int k = 0; k < Dim; ++k) {
      if (body_.is_held[std::size_t(k)]) continue;
      now_.of_faces.follow(now_.velocity, k, now_.share[k], time_step);
    }
    if (body_.keeps_orientation) return;
    for (int k = 0; k < angular_size<Dim>; ++k) {
      now_.spin_of_faces.follow(now_.spin, k, now_.share_of_spin, time_step);
    }
  }

  /// Which velocity of a body contacts change.
  enum class Of : std::uint8_t {
    body,   ///< V, with the mass of the body: it takes the impulse
    faces,  ///< W, with the mass over θ, as the fluid resists
  };
  /// Changes a velocity by an impulse [N s] at x [m].
  void push(Of which, const Vec& x, const Vec& impulse) {
    const Velocities change = response(which, x, impulse);
    if (which == Of::faces) {
      for (int k = 0; k < Dim; ++k) now_.of_faces.resist(change.linear, k, time_step_);
      for (int k = 0; k < angular_size<Dim>; ++k) {
        now_.spin_of_faces.resist(change.spin, k, time_step_);
      }
      return change_faces(change);
    }
    now_.velocity += change.linear;
    now_.spin += change.spin;
    now_.impulse_of_contacts += mass_.mass * change.linear;
  }
  /// The velocity along n, a unit vector, that an impulse of 1 N s along n gives its point x [1/kg]; 0
  /// if it is held.
  double mobility(Of which, const Vec& x, const Vec& n) const {
    const auto [change, turn] = response(which, x, n);
    const double found = n.dot(change + cross(turn, Vec(x - now_.position)));
    constexpr double round_off = 1e-9;
    const double least_share = which == Of::faces ? now_.share.minCoeff() : 1;
    return found > round_off * least_share / mass_.mass ? found : 0;
  }
  /// Of its point x [m/s].
  Vec velocity_at(Of which, const Vec& x) const {
    const Vec arm = x - now_.position;
    if (which == Of::body) return now_.velocity + cross(now_.spin, arm);
    return now_.of_faces.velocity + cross(now_.spin_of_faces.velocity, arm);
  }

  void save() { saved_ = now_; }
  void restore() noexcept { now_ = saved_; }
  /// f(number) for each number of its state.
  template <class F>
  void for_each_number(F&& f) {
    const auto each = [&](auto& values) {
      for (int k = 0; k < Dim; ++k) f(values[k]);
    };
    const auto each_spin = [&](Angular& spin) {
      for (int k = 0; k < angular_size<Dim>; ++k) f(component(spin, k));
    };
    each(now_.position);
    now_.orientation.for_each_number(f);
    each(now_.velocity);
    each(now_.of_faces.velocity);
    each(now_.of_faces.acceleration);
    each_spin(now_.spin);
    each_spin(now_.spin_of_faces.velocity);
    each_spin(now_.spin_of_faces.acceleration);
    each(now_.impulse_of_contacts);
    each(now_.share);
    f(now_.share_of_spin);
  }

 private:
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  // W and A, of the velocity or the spin.
  template <class V>
  struct OfFaces {
    V velocity;      // [m/s] or [1/s]
    V acceleration;  // per second

    void follow(V& of_body, int k, double share, double time_step) {
      const double behind = component(of_body, k) - component(velocity, k);
      component(velocity, k) += share * behind + time_step * component(acceleration, k);
      component(acceleration, k) += share * behind / (4 * time_step);
    }
    // A contact that lasts takes the acceleration away that it withstands, as much as follow()
    // adds.
    void resist(const V& change, int k, double time_step) {
      const double before = component(acceleration, k);
      const double after = before + component(change, k) / (4 * time_step);
      if (before * component(change, k) >= 0) return;
      component(acceleration, k) = before > 0 ? std::max(after, 0.0) : std::min(after, 0.0);
    }
  };
  struct State {
    Vec position = Vec::Zero();
    Orientation<Dim> orientation;
    Vec velocity = Vec::Zero();  // V
    OfFaces<Vec> of_faces{Vec::Zero(), Vec::Zero()};
    Angular spin = zero_of<Angular>();
    OfFaces<Angular> spin_of_faces{zero_of<Angular>(), zero_of<Angular>()};
    Vec impulse_of_contacts = Vec::Zero();
    Vec share = Vec::Ones();   // θ
    double share_of_spin = 1;  // θ
  };

  // At the end of a step.
  State after(const BodyLoad<Dim>& of_fluid, const Vec& acceleration, double time_step) const {
    State end = now_;
    const Vec force = of_fluid.force + load_of_user_.force;
    for (int k = 0; k < Dim; ++k) {
      if (body_.is_held[std::size_t(k)]) continue;
      end.velocity[k] += time_step * (force[k] / mass_.mass + acceleration[k]);
    }
    if (body_.keeps_orientation) return end;
    const Angular torque = of_fluid.torque + load_of_user_.torque;
    end.orientation = now_.orientation.turned(Angular(now_.spin_of_faces.velocity * time_step));
    if constexpr (Dim == 2) {
      end.spin += time_step * torque / mass_.inertia;
    } else {
      // The angular momentum is kept when the body turns.
      const Vec momentum = turned(mass_.inertia, now_.orientation) * now_.spin;
      end.spin = turned(mass_.inertia, end.orientation).inverse() * Vec(momentum + time_step * torque);
    }
    return end;
  }
  Velocities velocities() const { return {now_.of_faces.velocity, now_.spin_of_faces.velocity}; }
  Velocities response(Of which, const Vec& x, const Vec& impulse) const {
    const bool of_faces = which == Of::faces;
    Velocities change{Vec::Zero(), zero_of<Angular>()};
    for (int k = 0; k < Dim; ++k) {
      if (body_.is_held[std::size_t(k)]) continue;
      change.linear[k] = (of_faces ? now_.share[k] : 1) * impulse[k] / mass_.mass;
    }
    if (body_.keeps_orientation) return change;
    const Angular torque = cross(Vec(x - now_.position), impulse);
    if constexpr (Dim == 2) {
      change.spin = torque / mass_.inertia;
    } else {
      change.spin = turned(mass_.inertia, now_.orientation).inverse() * torque;
    }
    if (of_faces) change.spin *= now_.share_of_spin;
    return change;
  }
  Pose<Dim> pose() const {
    const Matrix rotation = now_.orientation.matrix();
    return {rotation, now_.position - multiply<Dim, double>(rotation, mass_.centre)};
  }
  static Matrix turned(const Matrix& inertia, const Orientation<Dim>& orientation) {
    const Matrix rotation = orientation.matrix();
    return rotation * inertia * rotation.transpose();
  }
  // Twice that of a plate, or a disc, as large as the wetted part across the axis.
  static Vec added_mass(const WettedBounds<Dim>& wetted) {
    Vec mass;
    for (int k = 0; k < Dim; ++k) {
      if constexpr (Dim == 2) {
        mass[k] = 2 * wetted.density * std::numbers::pi / 4 * squared(wetted.size[1 - k]);
      } else {
        const double area = wetted.size[(k + 1) % 3] * wetted.size[(k + 2) % 3];
        mass[k] = 2 * wetted.density * 8 / 3 * std::pow(area / std::numbers::pi, 1.5);
      }
    }
    return mass;
  }
  static double added_inertia(const WettedBounds<Dim>& wetted) {
    const double half = wetted.size.maxCoeff() / 2;
    if constexpr (Dim == 2) {
      return 2 * wetted.density * std::numbers::pi / 8 * std::pow(half, 4);
    } else {
      return 2 * wetted.density * 16 / 45 * std::pow(half, 5);
    }
  }

  FloatingBody<Dim> body_;
  MassProperties<Dim> mass_;
  double volume_ = 0;            // inside its faces [m³]
  Vec centre_of_volume_ = Vec::Zero();  // where the faces are defined [m]
  double deviation_ = 0;                // of the faces from the radius [m]
  double largest_distance_ = 0;  // of a corner from the centre of mass [m]
  double time_step_ = 1;         // [s]
  BodyLoad<Dim> load_of_user_;   // in the step
  State now_;
  State saved_;
};

}  // namespace silt::mps
