// SPDX-License-Identifier: MIT
// The volume of fluid that passes a section.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/measure/wall_group.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

/// A surface through which fluid flows.
template <int Dim>
struct Section {
  std::vector<Face<Dim>> faces;  ///< fluid that passes along their normals counts as positive
  double spacing = 0;            ///< l0 [m]
  WallGroup moves_with = {};     ///< walls where the faces are defined, and with which they move
};

/// Counts the particles that cross a section, each as the volume l0^Dim: what it has counted is
/// always the volume that has passed, to one particle. It needs before_step(simulation) before
/// every step, and after_step(simulation) after it. Particles that are added or removed, or moved
/// by the program, do not count.
template <int Dim>
class Flux {
 public:
  /// Throws if there are no faces, if one has no size, or if the spacing is not positive.
  explicit Flux(Section<Dim> section) : section_(std::move(section)) {
    require_positive("Flux: spacing", section_.spacing);
    if (section_.faces.empty()) fail("Flux: no faces; give those of the section");
    for (std::size_t k = 0; k < section_.faces.size(); ++k) {
      require_size("Flux: face " + std::to_string(k), section_.faces[k]);
    }
  }

  /// Keeps where the particles near the section are. Throws if the walls have no such group.
  template <class Sim>
  void before_step(const Sim& simulation) {
    using P = std::remove_cvref_t<decltype(simulation.particles())>;
    static_assert(P::dimension == Dim, "silt::Flux: the particles have another dimension");
    static_assert(detail::are_of_one_process<P>,
                  "silt::Flux: a section counts the particles of one process");
    if (!has_begun_) {
      has_begun_ = true;
      begin_ = simulation.time();
    }
    const Pose<Dim> pose = pose_at(simulation);
    Vec<Dim> lower = Vec<Dim>::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
    for (const Face<Dim>& face : section_.faces) {
      for (const Vec<Dim>& corner : face.corners) {
        lower = lower.cwiseMin(corner);
        upper = upper.cwiseMax(corner);
      }
    }
    // Neither a particle nor a wall moves by more than a spacing in a step.
    const double margin = 2.5 * section_.spacing;
    const auto& particles = simulation.particles();
    const auto x = particles[position];
    near_.clear();
    for (Index i = 0; i < particles.size(); ++i) {
      const Vec<Dim> now = x[i].template cast<double>();
      bool is_near = false;
      for_each_copy(particles.box(), now, [&](const Vec<Dim>& copy) {
        const Vec<Dim> X = pose.X_of(copy);
        is_near = is_near || ((X - lower).minCoeff() > -margin && (upper - X).minCoeff() > -margin);
      });
      if (is_near) near_.push_back({particles.id(i), now});
    }
    pose_ = pose;
  }
  /// Counts those that have crossed it in the step.
  template <class Sim>
  void after_step(const Sim& simulation) {
    const auto& particles = simulation.particles();
    const auto& box = particles.box();
    const Pose<Dim> pose = pose_at(simulation);
    const auto x = particles[position];
    for (const Near& near : near_) {
      const Index i = particles.index_of(near.id);
      if (i == no_index) continue;
      Vec<Dim> move = x[i].template cast<double>() - near.position;
      for (int k = 0; k < Dim; ++k) {
        if (!box.periodic[std::size_t(k)]) continue;
        const double period = double(box.upper[k] - box.lower[k]);
        move[k] -= period * std::round(move[k] / period);
      }
      for_each_copy(box, near.position, [&](const Vec<Dim>& copy) {
        passed_ += crossings(pose_.X_of(copy), pose.X_of(copy + move));
      });
    }
    near_.clear();
  }

  /// The volume that has passed since the first step [m³], in 2D per metre of depth [m²].
  double volume() const { return double(passed_) * std::pow(section_.spacing, Dim); }

  /// For a file: the flow rate since the last row [m³/s], in 2D [m²/s], and the volume.
  std::vector<std::string> columns() const { return {"flux", "volume"}; }
  /// What the rows are made of.
  std::string filter() const {
    return message_of({"flow rate and volume through a section of ", section_.faces.size(),
                       " faces from ", to_text(section_.faces[0].corners[0]),
                       " m: particles that crossed it, each as ", std::pow(section_.spacing, Dim),
                       Dim == 2 ? " m²" : " m³",
                       ", in the time since the row before; no other average"});
  }
  /// The numbers of a row, after which the next flow rate begins.
  template <class Sim>
  std::vector<double> row(const Sim& simulation) {
    const double time = simulation.time() - (has_row_ ? time_of_row_ : begin_);
    const auto passed = double(passed_ - passed_at_row_);
    const double rate =
        time > 0 && has_begun_ ? passed * std::pow(section_.spacing, Dim) / time : 0.0;
    has_row_ = true;
    time_of_row_ = simulation.time();
    passed_at_row_ = passed_;
    return {rate, volume()};
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_begun", has_begun_);
    archive("begin", begin_);
    archive("passed", passed_);
    archive("has_row", has_row_);
    archive("time_of_row", time_of_row_);
    archive("passed_at_row", passed_at_row_);
  }

 private:
  struct Near {
    Id id;
    Vec<Dim> position;  // before the step [m]
  };

  template <class Sim>
  Pose<Dim> pose_at(const Sim& simulation) const {
    if (section_.moves_with.is_at_rest()) return {};
    return detail::WallsNow<Dim>(simulation)
        .pose_of(section_.moves_with.template number_in<Dim>(simulation, "Flux"));
  }
  // f(x) and f(image) beyond one periodic side or several: a section may be near a side.
  template <class Real, class F>
  static void for_each_copy(const Box<Dim, Real>& box, const Vec<Dim>& x, F&& f, int axis = 0) {
    if (axis == Dim) return f(x);
    for_each_copy(box, x, f, axis + 1);
    if (!box.periodic[std::size_t(axis)]) return;
    for (const double sign : {-1.0, 1.0}) {
      Vec<Dim> copy = x;
      copy[axis] += sign * double(box.upper[axis] - box.lower[axis]);
      for_each_copy(box, copy, f, axis + 1);
    }
  }

  // How often the segment from p to q crosses the section, along its normals or against them. A
  // particle on a plane is below it, and a line through an edge that two faces have in common
  // crosses one of them: their ends have the same numbers with opposite signs.
  std::int64_t crossings(const Vec<Dim>& p, const Vec<Dim>& q) const {
    std::int64_t number = 0;
    for (const Face<Dim>& face : section_.faces) {
      const Vec<Dim> normal = normal_of(face);
      const bool was_above = normal.dot(p - face.corners[0]) > 0;
      const bool is_above = normal.dot(q - face.corners[0]) > 0;
      if (was_above != is_above && is_met(face, p, q)) number += is_above ? 1 : -1;
    }
    return number;
  }
  static bool is_met(const Face<Dim>& face, const Vec<Dim>& p, const Vec<Dim>& q) {
    const auto& corners = face.corners;
    if constexpr (Dim == 2) {
      return (detail::side_of(p, q, corners[0]) > 0) != (detail::side_of(p, q, corners[1]) > 0);
    } else {
      int on_left = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec<3>&a = corners[k], &b = corners[(k + 1) % 3];
        const double side = detail::side_of(p, q, a, b);
        const bool a_is_first =
            std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
        on_left += side > 0 || (side == 0 && a_is_first);
      }
      return on_left == 0 || on_left == 3;
    }
  }

  Section<Dim> section_;
  std::vector<Near> near_;
  Pose<Dim> pose_;  // before the step
  bool has_begun_ = false;
  double begin_ = 0;         // [s]
  std::int64_t passed_ = 0;  // particles
  bool has_row_ = false;
  double time_of_row_ = 0;  // [s]
  std::int64_t passed_at_row_ = 0;
};

}  // namespace silt
