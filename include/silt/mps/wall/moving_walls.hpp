// SPDX-License-Identifier: MIT
// Walls of a flow that move, and bodies that float in it.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/point_checksum.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/geometry/rigid_motion.hpp>
#include <silt/mps/wall/floating_body.hpp>
#include <silt/mps/wall/moving_walls_in_flow.hpp>
#include <silt/mps/wall/prescribed_motion.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace silt::mps {

/// The moving walls of a flow: ImageWalls::moving_2d or moving_3d. Their groups are numbered from 1 on,
/// first those of the faces, then those of the bodies.
template <int Dim>
struct MovingWalls {
  std::vector<MovingFaces<Dim>> faces = {};
  std::vector<FloatingBody<Dim>> bodies = {};  ///< moved by the fluid

  /// See AnyMovingWalls. Throws if a face is invalid, see require_size().
  std::vector<std::vector<Face<Dim>>> groups() const {
    std::vector<std::vector<Face<Dim>>> all;
    const auto add = [&](const std::string& name, const std::vector<Face<Dim>>& group) {
      for (std::size_t k = 0; k < group.size(); ++k) {
        require_size("MovingWalls: " + name + ": face " + std::to_string(k), group[k]);
      }
      all.push_back(group);
    };
    for (std::size_t g = 0; g < faces.size(); ++g) {
      add("moving wall " + std::to_string(g), faces[g].faces);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      add("body " + std::to_string(b), bodies[b].faces);
    }
    return all;
  }
  /// Throws if a motion or a body is invalid.
  std::unique_ptr<WallMover<Dim>> mover() const {
    return std::make_unique<detail::MovingWallsInFlow<Dim>>(faces, bodies);
  }
  /// What identifies them: of a motion, where it begins and where it is at some times up to a
  /// second, if it is defined then. Throws if one is invalid.
  void add_to(PointChecksum& sum) const {
    for (const MovingFaces<Dim>& group : faces) {
      group.motion.check();
      for (const double t : {0.0, 0.01, 0.1, 1.0}) {
        Pose<Dim> pose;
        try {
          pose = group.motion.pose_at(t);
        } catch (...) {
          if (t == 0) throw;
          continue;
        }
        for (const Face<Dim>& face : group.faces) {
          for (const Vec<Dim>& corner : face.corners) sum.add(pose.x_of(corner));
        }
      }
    }
    for (const FloatingBody<Dim>& body : bodies) {
      for (const Face<Dim>& face : body.faces) {
        for (const Vec<Dim>& corner : face.corners) sum.add(corner);
      }
      sum.add(Vec<2>(body.density, body.mass_properties ? body.mass_properties->mass : 0));
      if (body.mass_properties) {
        sum.add(body.mass_properties->centre);
        if constexpr (Dim == 2) {
          sum.add_number(body.mass_properties->inertia);
        } else {
          for (const double number : body.mass_properties->inertia.reshaped())
            sum.add_number(number);
        }
      }
      sum.add(body.velocity);
      for (int k = 0; k < angular_size<Dim>; ++k) sum.add_number(component(body.spin, k));
      for (const bool is_held : body.is_held) sum.add(std::uint64_t(is_held));
      sum.add(std::uint64_t(body.keeps_orientation));
      if (body.friction > 0) sum.add_number(body.friction);
      if (body.radius > 0) sum.add_number(-body.radius);  // not as a friction
      sum.add(std::uint64_t(body.load ? 1 : 0));
    }
  }
};

}  // namespace silt::mps
