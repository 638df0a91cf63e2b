// SPDX-License-Identifier: MIT
// The load of a flow on walls without particles.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/measure/wall_gauge.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

/// Force of a fluid on some of its walls in the last step: of its pressure, by gauges about a spacing
/// apart, and of the particles that collided with the walls instead of being stopped by the pressure.
/// Near the change of the fluid's momentum if collisions are few, as with mps::Recommended.
/// The faces are not continued beyond the sides of a periodic box, where they should end therefore.
template <int Dim>
struct WallLoad {
  /// With normals into the fluid, as those of make_tank() and of faces_of(box) for fluid in the box;
  /// otherwise see reversed(). Fluid on the other side does not count.
  std::vector<Face<Dim>> faces = {};

  /// In 3D [N], in 2D per depth [N/m]; `pressure` is its field. Throws if a face has no size.
  template <class Sim, Field F>
  Vec<Dim> read(const Sim& simulation, F pressure) const {
    static_assert(requires { simulation.interaction().wall_collisions(); },
                  "silt::WallLoad: read(simulation, field) needs a simulation of a flow whose walls "
                  "are faces, such as those of mps::Recommended");
    static_assert(std::remove_cvref_t<decltype(simulation.particles())>::dimension == Dim,
                  "silt::WallLoad: the flow has another dimension");
    for (std::size_t k = 0; k < faces.size(); ++k) {
      require_size("WallLoad: face " + std::to_string(k), faces[k]);
    }
    const double l0 = simulation.interaction().settings().spacing;
    Vec<Dim> load = of_collisions(simulation, l0);
    for (const Face<Dim>& face : faces) {
      load += of_pressure(simulation.particles(), face, pressure, l0);
    }
    return load;
  }

 private:
  template <class P, Field F>
  static Vec<Dim> of_pressure(const P& particles, const Face<Dim>& face, F pressure, double l0) {
    const Vec<Dim> normal = normal_of(face);
    // Those that a gauge at the face can see.
    const double reach = 2.01 * l0;
    Vec<Dim> lower = face.corners[0], upper = lower;
    for (const Vec<Dim>& corner : face.corners) {
      lower = lower.cwiseMin(corner);
      upper = upper.cwiseMax(corner);
    }
    Particles<Dim, double, F> near;
    const auto x = particles[position];
    for (Index i = 0; i < particles.size(); ++i) {
      const Vec<Dim> at = x[i].template cast<double>();
      if ((at.array() < lower.array() - reach || at.array() > upper.array() + reach).any()) continue;
      if ((at - nearest_of(face, at)).squaredNorm() > squared(reach)) continue;
      const Index k = near.add(at);
      near[pressure][k] = double(particles[pressure][i]);
    }
    Vec<Dim> load = Vec<Dim>::Zero();
    for_each_part(face, l0, [&](const Vec<Dim>& centre, double area) {
      load -= area * WallGauge<Dim>{centre, normal, l0}.read(near, pressure) * normal;
    });
    return load;
  }

  // f(centre, length or area) for equal parts of the face about a spacing wide.
  template <class F>
  static void for_each_part(const Face<Dim>& face, double l0, F&& f) {
    const auto& corners = face.corners;
    double longest = 0;
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      longest = std::max(longest, (corners[(k + 1) % Dim] - corners[k]).norm());
    }
    const int n = static_cast<int>(std::clamp(std::ceil(longest / l0 - 0.01), 1.0, 1e4));
    if constexpr (Dim == 2) {
      const Vec<2> along = (corners[1] - corners[0]) / n;
      for (int k = 0; k < n; ++k) f(Vec<2>(corners[0] + (k + 0.5) * along), along.norm());
    } else {
      const Vec<3> a = (corners[1] - corners[0]) / n, b = (corners[2] - corners[0]) / n;
      const double area = cross(a, b).norm() / 2;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
          const Vec<3> corner = corners[0] + i * a + j * b;
          f(Vec<3>(corner + (a + b) / 3), area);
          if (i + j + 1 < n) f(Vec<3>(corner + 2 * (a + b) / 3), area);
        }
      }
    }
  }

  template <class Sim>
  Vec<Dim> of_collisions(const Sim& simulation, double l0) const {
    const auto& flow = simulation.interaction();
    const double m = flow.settings().density * std::pow(l0, Dim);
    Vec<Dim> load = Vec<Dim>::Zero();
    std::vector<Vec<Dim>> normals;  // of the walls that the particle before them collided with
    for (const auto& collision : flow.wall_collisions()) {
      normals.clear();
      for (const Face<Dim>& face : faces) {
        if (!is_before(face, collision.position, l0)) continue;
        const Vec<Dim> normal = normal_of(face);
        // Once for two triangles, of which the particle is before the common edge.
        const bool is_counted = std::ranges::any_of(
            normals, [&](const Vec<Dim>& other) { return other.dot(normal) > 0.999; });
        if (is_counted) continue;
        normals.push_back(normal);
        const double along = collision.velocity_change.dot(normal);
        load -= m / simulation.last_time_step() * along * normal;
      }
    }
    return load;
  }
  // Whether a particle that may have collided with the face is at x.
  static bool is_before(const Face<Dim>& face, const Vec<Dim>& x, double l0) {
    const Vec<Dim> from = x - nearest_of(face, x);
    const double height = from.dot(normal_of(face));
    return height > 0 && height < l0 && from.norm() < height * (1 + 1e-6);
  }
};

}  // namespace silt
