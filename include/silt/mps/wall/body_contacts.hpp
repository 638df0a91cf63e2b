// SPDX-License-Identifier: MIT
// Contacts of floating bodies with walls and with each other.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/close_faces.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/face_crossing.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/places_of_pairs.hpp>
#include <silt/mps/wall/body_in_flow.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace silt::mps {

/// Keeps bodies a spacing l0 apart from walls and from each other, as the flow between closer faces
/// is not resolved: where a step would bring faces closer, impulses along the line between their
/// closest points end the approach, without rebound. Discs and spheres take part by their own
/// shape. Across them, friction of Coulomb resists the sliding, in the middle between both points,
/// where it keeps the angular momentum of bodies. They are found one after another, as often as it
/// takes (projected Gauss–Seidel, [Jean1999]), and change the momentum of the bodies.
template <int Dim>
class BodyContacts {
 public:
  using Vec = silt::Vec<Dim>;

  /// Changes the velocities of the bodies before a step of this length [s]. The faces are where the
  /// step begins; group_of_body(b) is the group of a body, velocity_of(group, x) that of other
  /// faces.
  template <class GroupOfBody, class VelocityOf>
  void end_approaches(std::vector<BodyInFlow<Dim>>& bodies, const Faces<Dim>& faces, double spacing,
                      double time_step, GroupOfBody&& group_of_body, VelocityOf&& velocity_of) {
    contacts_.clear();
    places_.clear();
    double deviation = 0;
    for (const auto& body : bodies) deviation = std::max(deviation, body.deviation_of_faces());
    // The faces of discs and spheres, by which they are found, may be farther away than they are.
    const double near = 3 * spacing + 2 * deviation;
    const std::uint32_t first_body = group_of_body(0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      Contact contact;
      contact.body = b;
      const auto add = [&](std::uint32_t group, const Vec& x, const Vec& y, const Vec& normal,
                           double distance) {
        // A particle between them moves by less than a spacing in a step, and so do they.
        if (!(distance < 3 * spacing)) return;
        const bool is_of_body = group >= first_body;
        contact.other = is_of_body ? group - first_body : bodies.size();
        contact.friction = is_of_body
                               ? std::min(bodies[b].friction(), bodies[contact.other].friction())
                               : bodies[b].friction();
        contact.x = x;
        contact.y = y;
        contact.normal = normal;
        if (!is_of_body) {
          contact.velocity_of_wall = velocity_of(group, y);
          contact.velocity_in_middle = velocity_of(group, contact.middle());
        }
        // They may come closer by this in the step, and never less than now.
        contact.approach = std::max(0.0, distance - spacing) / time_step;
        add_if_new(contact, spacing);
      };
      for (std::size_t other = b + 1; other < bodies.size(); ++other) {
        if (!(bodies[b].radius() > 0 && bodies[other].radius() > 0)) continue;
        add_of_round(group_of_body(other), bodies[b].centre_of_volume(), bodies[b].radius(),
                     bodies[other].centre_of_volume(), bodies[other].radius(), add);
      }
      std::uint32_t last_of_round = no_face;
      for_each_close_pair(
          faces, group_of_body(b), near, [&](std::uint32_t own, std::uint32_t other) {
            const std::uint32_t group = faces[other].group;
            if (group >= first_body && group < group_of_body(b))
              return;  // found from the other one
            const BodyInFlow<Dim>* const met =
                group >= first_body ? &bodies[group - first_body] : nullptr;
            const bool is_round = bodies[b].radius() > 0, meets_round = met && met->radius() > 0;
            if (is_round && meets_round) return;
            if (is_round) {
              // The pairs of a face follow each other.
              if (other == last_of_round) return;
              last_of_round = other;
              const Vec x = bodies[b].centre_of_volume();
              return add_of_round(group, x, bodies[b].radius(), nearest_of(faces[other].face, x), 0,
                                  add);
            }
            if (meets_round) {
              const Vec y = met->centre_of_volume();
              return add_of_round(group, nearest_of(faces[own].face, y), 0, y, met->radius(), add);
            }
            for_each_closest_points(
                faces[own].face, faces[other].face, [&](const Vec& x, const Vec& y) {
                  const double distance = (x - y).norm(), touching = 1e-2 * spacing;
                  Vec normal = Vec::Zero();
                  if (distance > touching) {
                    normal = (x - y) / distance;
                  } else if (!find_normal(faces[own], faces[other], y, touching, normal)) {
                    return;
                  }
                  add(group, x, y, normal, distance);
                });
          });
    }
    // Of the momentum first, then of the faces, which the fluid lets change less.
    for (const Of which : {Of::body, Of::faces}) push_all(which, bodies, spacing / time_step);
  }
  /// The same of the faces, which have got other velocities in the step.
  void end_approaches_of_faces(std::vector<BodyInFlow<Dim>>& bodies, double spacing,
                               double time_step) {
    push_all(Of::faces, bodies, spacing / time_step);
  }

 private:
  using Of = typename BodyInFlow<Dim>::Of;
  static constexpr int max_iterations = 200;
  static constexpr std::uint32_t no_face = 0xffffffff;

  struct Contact {
    std::size_t body = 0;
    std::size_t other = 0;                 // body, or that of all if it is a wall
    Vec x = Vec::Zero();                   // on the body [m]
    Vec y = Vec::Zero();                   // on the other one [m]
    Vec normal = Vec::Zero();              // from there to the body [-]
    Vec velocity_of_wall = Vec::Zero();    // at y [m/s]
    Vec velocity_in_middle = Vec::Zero();  // of the wall, too [m/s]
    double approach = 0;                   // the fastest that is allowed [m/s]
    double mass = 0;                       // that an impulse moves [kg]
    double impulse = 0;                    // so far [N s]
    double friction = 0;                   // coefficient [-]
    Vec across = Vec::Zero();              // impulse of friction, so far [N s]

    Vec middle() const { return (x + y) / 2; }
  };

  // add() for the closest points of two discs or spheres, or of one and a point, which has the
  // radius 0.
  template <class Add>
  static void add_of_round(std::uint32_t group, const Vec& x, double R, const Vec& y,
                           double R_of_other, Add&& add) {
    const double between = (x - y).norm();
    if (!(between > 0)) return;
    const Vec normal = (x - y) / between;
    add(group, Vec(x - R * normal), Vec(y + R_of_other * normal), normal, between - R - R_of_other);
  }
  // Until they change velocities by little, compared with a scale [m/s].
  void push_all(Of which, std::vector<BodyInFlow<Dim>>& bodies, double scale) {
    if (contacts_.empty()) return;
    for (Contact& contact : contacts_) {
      double mobility = bodies[contact.body].mobility(which, contact.x, contact.normal);
      if (contact.other < bodies.size()) {
        mobility += bodies[contact.other].mobility(which, contact.y, contact.normal);
      }
      contact.mass = mobility > 0 ? 1 / mobility : 0;
      contact.impulse = 0;
      contact.across.setZero();
    }
    for (int k = 0; k < max_iterations; ++k) {
      double largest_change = 0;
      for (Contact& contact : contacts_) {
        largest_change = std::max(largest_change, push(which, bodies, contact));
        if (!(contact.friction > 0)) continue;
        largest_change = std::max(largest_change, rub(which, bodies, contact));
      }
      if (largest_change < 1e-9 * scale) break;
    }
  }
  // Of faces that touch at x, to a tolerance: towards the middle of the body's one, that of the
  // face in which the corner of the other one is, if one is in the other.
  static bool find_normal(const FaceOfSurface<Dim>& own, const FaceOfSurface<Dim>& other,
                          const Vec& x, double tolerance, Vec& normal) {
    const auto height_of = [](const FaceOfSurface<Dim>& plane, const FaceOfSurface<Dim>& face) {
      Vec middle = Vec::Zero();
      for (const Vec& corner : face.face.corners) middle += corner / Dim;
      return plane.height(middle);
    };
    const double of_own = height_of(other, own), of_other = height_of(own, other);
    const bool is_in_other = silt::detail::is_within_rim(other, x, tolerance);
    const bool is_in_own = silt::detail::is_within_rim(own, x, tolerance);
    const bool takes_other =
        is_in_own == is_in_other ? std::abs(of_own) > std::abs(of_other) : is_in_other;
    const double height = takes_other ? of_own : of_other;
    if (std::abs(height) < tolerance) return false;  // one slides along the other
    if (takes_other) {
      normal = height > 0 ? other.normal : Vec(-other.normal);
    } else {
      normal = height > 0 ? Vec(-own.normal) : own.normal;
    }
    return true;
  }
  // Faces have common corners, and edges.
  void add_if_new(const Contact& contact, double spacing) {
    const double same = 1e-6 * spacing;
    const auto is_known = [&](std::uint32_t k) {
      const Contact& known = contacts_[k];
      return known.body == contact.body && known.other == contact.other &&
             (known.x - contact.x).norm() < same && (known.y - contact.y).norm() < same &&
             known.normal.dot(contact.normal) > 0.999;
    };
    if (places_.any_near(contact.x, contact.y, same, is_known)) return;
    places_.add(contact.x, contact.y, same);
    contacts_.push_back(contact);
  }
  // The change of the relative velocity [m/s].
  static double push(Of which, std::vector<BodyInFlow<Dim>>& bodies, Contact& contact) {
    BodyInFlow<Dim>& body = bodies[contact.body];
    const bool has_other = contact.other < bodies.size();
    const Vec relative = body.velocity_at(which, contact.x) -
                         (has_other ? bodies[contact.other].velocity_at(which, contact.y)
                                    : contact.velocity_of_wall);
    const double too_fast = -contact.approach - relative.dot(contact.normal);
    const double impulse = std::max(contact.impulse + contact.mass * too_fast, 0.0);
    const double change = impulse - contact.impulse;
    if (change == 0) return 0;
    contact.impulse = impulse;
    body.push(which, contact.x, Vec(change * contact.normal));
    if (has_other) bodies[contact.other].push(which, contact.y, Vec(-change * contact.normal));
    return std::abs(change) / contact.mass;
  }

  // The same, of the velocity along the faces, of which friction takes as much as it can.
  static double rub(Of which, std::vector<BodyInFlow<Dim>>& bodies, Contact& contact) {
    BodyInFlow<Dim>& body = bodies[contact.body];
    const bool has_other = contact.other < bodies.size();
    const Vec at = contact.middle();
    Vec slip =
        body.velocity_at(which, at) -
        (has_other ? bodies[contact.other].velocity_at(which, at) : contact.velocity_in_middle);
    slip -= slip.dot(contact.normal) * contact.normal;
    Vec across = contact.across;
    if (const double speed = slip.norm(); speed > 0) {
      const Vec along = slip / speed;
      double mobility = body.mobility(which, at, along);
      if (has_other) mobility += bodies[contact.other].mobility(which, at, along);
      if (mobility > 0) across -= slip / mobility;
    }
    // Also without slip: the impulse along the line may have become smaller.
    const double most = contact.friction * contact.impulse, size = across.norm();
    if (size > most) across *= most / size;
    const Vec change = across - contact.across;
    if (!(change.norm() > 0) || !(contact.mass > 0)) return 0;
    contact.across = across;
    body.push(which, at, change);
    if (has_other) bodies[contact.other].push(which, at, Vec(-change));
    return change.norm() / contact.mass;
  }

  Buffer<Contact> contacts_;
  PlacesOfPairs<Dim> places_;  // of the contacts
};

}  // namespace silt::mps
