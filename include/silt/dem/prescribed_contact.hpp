// SPDX-License-Identifier: MIT
// A contact that is led through a motion which nobody's forces change, and what a law answers on
// the way.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/law_history.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <vector>

namespace silt::dem {

/// How i's surface lies against j's, seen along the normal.
template <int Dim>
struct ContactPose {
  double overlap = 0;                       ///< δ [m]
  Vec<Dim> slip = Vec<Dim>::Zero();         ///< along the contact plane [m]
  AngularVec<Dim> turn = zero_of<AngularVec<Dim>>();    ///< of i against j [rad]
};

/// The instants of a motion, in order; where the overlap is not above 0 there is no contact.
template <int Dim>
using PrescribedContact = std::vector<Contact<Dim, double>>;

/// What surrounds a motion.
struct PrescribedMotion {
  double mass = 0;      ///< m* [kg]
  double radius = 0;    ///< R* [m]
  double duration = 0;  ///< [s]
  int steps = 2000;
};

/// The motion pose_at(u), u in [0, 1], along a normal at rest. The normal is the first axis.
template <int Dim, class PoseAt>
PrescribedContact<Dim> prescribe(const PrescribedMotion& motion, PoseAt&& pose_at) {
  const double dt = motion.duration / motion.steps;
  const Vec<Dim> n = Vec<Dim>::Unit(0);
  PrescribedContact<Dim> instants;
  ContactPose<Dim> before = pose_at(0.0);
  for (int k = 1; k <= motion.steps; ++k) {
    const ContactPose<Dim> now = pose_at(double(k) / motion.steps);
    Contact<Dim, double> contact;
    contact.normal = n;
    contact.overlap = now.overlap;
    contact.relative_velocity =
        ((before.overlap - now.overlap) * n + now.slip - before.slip) / dt;
    contact.relative_spin = (now.turn - before.turn) / dt;
    contact.effective_mass = motion.mass;
    contact.effective_radius = motion.radius;
    contact.time_step = dt;
    instants.push_back(contact);
    before = now;
  }
  return instants;
}

/// What acts on i at an instant, and what the law says that its springs store.
template <int Dim>
struct LawLoad {
  Vec<Dim> force = Vec<Dim>::Zero();        ///< [N]
  AngularVec<Dim> couple = zero_of<AngularVec<Dim>>();  ///< [N m]
  double stored = 0;                        ///< [J]; 0 if the law does not tell
};

template <class Real, int Dim>
Contact<Dim, Real> in_precision(const Contact<Dim, double>& contact) {
  Contact<Dim, Real> cast;
  cast.normal = contact.normal.template cast<Real>();
  cast.overlap = Real(contact.overlap);
  cast.relative_velocity = contact.relative_velocity.template cast<Real>();
  for (int k = 0; k < angular_size<Dim>; ++k) {
    component(cast.relative_spin, k) = Real(component(contact.relative_spin, k));
  }
  cast.effective_mass = Real(contact.effective_mass);
  cast.effective_radius = Real(contact.effective_radius);
  cast.time_step = Real(contact.time_step);
  return cast;
}

/// What a law answers about one contact, and remembers.
template <class Law, int Dim, class Real>
LawLoad<Dim> load_of(const Law& law, const Contact<Dim, Real>& contact,
                     typename LawHistory<Law, Dim, Real>::type& history) {
  LawLoad<Dim> load;
  const auto answer = [&] {
    if constexpr (LawWithHistory<Law, Dim, Real>) {
      return evaluate_law(law, contact, history);
    } else {
      return evaluate_law(law, contact);
    }
  }();
  load.force = in_double(force_of(answer, contact.normal));
  load.couple = in_double(couple_of(answer));
  if constexpr (TellsEnergy<Law, Dim, Real>) load.stored = law.elastic_energy(contact, history);
  return load;
}

/// The law's answer about one contact that goes on, and a law that meets a new one.
template <int Dim>
using AskLaw = std::function<LawLoad<Dim>(const Contact<Dim, double>&)>;
template <int Dim>
using MeetLaw = std::function<AskLaw<Dim>()>;

template <class Real, int Dim, class Law>
MeetLaw<Dim> meet_in_precision(const Law& law) {
  return [law] {
    return [law, history = typename LawHistory<Law, Dim, Real>::type{}](
               const Contact<Dim, double>& contact) mutable {
      return load_of(law, in_precision<Real>(contact), history);
    };
  };
}

/// What a law answers all the way.
template <int Dim>
std::vector<LawLoad<Dim>> loads_along(const MeetLaw<Dim>& meet,
                                      const PrescribedContact<Dim>& instants) {
  std::vector<LawLoad<Dim>> loads;
  AskLaw<Dim> ask;
  for (const auto& instant : instants) {
    if (instant.overlap > 0) {
      if (!ask) ask = meet();
      loads.push_back(ask(instant));
    } else {
      loads.emplace_back();
      ask = nullptr;
    }
  }
  return loads;
}

/// What a contact gave beyond what it took, over what went to and fro [-].
struct EnergyGain {
  double whole = 0;        ///< from touch to parting: above 0, it made energy
  double at_any_time = 0;  ///< most by which what it gave and says it stores grew
};
template <int Dim>
EnergyGain energy_gain(const PrescribedContact<Dim>& instants,
                       const std::vector<LawLoad<Dim>>& loads) {
  double given = 0, pressed = 0, sheared = 0, least = 0, growth = 0;
  for (Index k = 1; k < loads.size(); ++k) {
    const auto& contact = instants[k];
    const Vec<Dim> force = (loads[k].force + loads[k - 1].force) / 2;
    const AngularVec<Dim> couple = (loads[k].couple + loads[k - 1].couple) / 2;
    const double along_normal = -force.dot(contact.normal) * contact.approach_speed();
    const double power =
        force.dot(contact.tangential_velocity()) + dot(couple, contact.relative_spin);
    given += (along_normal + power) * contact.time_step;
    pressed += std::abs(along_normal) * contact.time_step;
    sheared += std::abs(power) * contact.time_step;
    least = std::min(least, given + loads[k].stored);
    growth = std::max(growth, given + loads[k].stored - least);
  }
  // Where it is sheared, that counts, unless it is next to nothing.
  const double scale = sheared > 1e-3 * pressed ? sheared : pressed;
  return {given / scale, growth / (pressed + sheared)};
}

/// The same contact from the side of j.
template <int Dim>
PrescribedContact<Dim> from_the_other_side(PrescribedContact<Dim> instants) {
  for (auto& contact : instants) {
    contact.normal = -contact.normal;
    contact.relative_velocity = -contact.relative_velocity;
    contact.relative_spin = -contact.relative_spin;
  }
  return instants;
}

/// A frame turned by an angle [rad] about an axis (3D), or in the plane.
template <int Dim>
Eigen::Matrix<double, Dim, Dim> turned_frame(double angle, const Vec<3>& axis) {
  if constexpr (Dim == 2) {
    return Eigen::Rotation2D<double>(angle).toRotationMatrix();
  } else {
    return Eigen::AngleAxis<double>(angle, axis.normalized()).toRotationMatrix();
  }
}
/// A spin in that frame.
template <int Dim>
AngularVec<Dim> in_frame(const Eigen::Matrix<double, Dim, Dim>& frame, const AngularVec<Dim>& spin) {
  if constexpr (Dim == 2) {
    return spin;
  } else {
    return frame * spin;
  }
}

/// The same contact, while both bodies turn rigidly: frame_at(u) is where they are, u in (0, 1].
template <int Dim, class FrameAt>
PrescribedContact<Dim> in_frames(PrescribedContact<Dim> instants, FrameAt&& frame_at) {
  for (Index k = 0; k < instants.size(); ++k) {
    const Eigen::Matrix<double, Dim, Dim> frame =
        frame_at(double(k + 1) / double(instants.size()));
    auto& contact = instants[k];
    contact.normal = frame * contact.normal;
    contact.relative_velocity = frame * contact.relative_velocity;
    contact.relative_spin = in_frame<Dim>(frame, contact.relative_spin);
  }
  return instants;
}

}  // namespace silt::dem
