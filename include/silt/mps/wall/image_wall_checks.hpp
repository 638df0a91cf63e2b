// SPDX-License-Identifier: MIT
// Checks of particles and box for walls that mirror.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

namespace silt::mps::detail {

/// Throws if a particle is not fluid.
template <FluidParticles P>
void require_fluid_only(const P& particles) {
  const auto kinds = particles[kind];
  const Index i = first_where(particles.size(), [&](Index k) { return kinds[k] != Kind::fluid; });
  if (i == no_index) return;
  fail("ImageWalls: a particle is of a wall, but these walls are faces; remove all wall and "
       "dummy particles, or use a scheme for them, such as mps::RecommendedForWallParticles; "
       "make_tank<Scheme, Dim>() makes a tank for either",
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a particle is on a face: its image would be at the same position. Spacing in [m].
template <FluidParticles P, int Dim>
void require_distance_from_faces(const P& particles, const FacesNearParticles<Dim>& near,
                                 double spacing) {
  constexpr double closest = 1e-3;  // spacings
  const Index i = first_where(particles.size(), [&](Index k) {
    return near.has_faces(k) && near[k].distance() < closest * spacing;
  });
  if (i == no_index) return;
  fail({"ImageWalls: a particle at ", near[i].x(), " m has a distance of ", near[i].distance(),
        " m from a wall; begin with half a spacing"},
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a particle has gone through a face since the faces near it were found.
/// name_of(group) names faces that move together.
template <FluidParticles P, int Dim, class NameOf>
void require_no_passage(const P& particles, const FacesNearParticles<Dim>& near, NameOf&& name_of) {
  const auto x = particles[position];
  const NearestImage nearest(particles.box());
  const auto end_of = [&](Index k) -> Vec<Dim> {
    const auto move = nearest(x[k] - near.position(k).template cast<typename P::Real>());
    return near.position(k) + move.template cast<double>();
  };
  const bool moves = near.faces().move();
  const Index i = first_where(particles.size(), [&](Index k) {
    if (!near.has_faces(k)) return false;
    if (moves) return near[k].face_passed(end_of(k)) < near.faces().elements().size();
    return !(near[k].visible_share(end_of(k)) > 0);
  });
  if (i == no_index) return;
  const std::string wall =
      moves ? name_of(near.faces()[near[i].face_passed(end_of(i))].group) : "a wall";
  fail({"ImageWalls: a particle went through ", wall, ", from ", near.position(i), " to ", x[i],
        " m; reduce the time step, or let particles collide with the walls"},
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a wall ends at a periodic side: fluid sees beyond it by the reach [m], where the wall has
/// no copies.
template <int Dim, class Real>
void require_walls_beyond_sides(const Faces<Dim>& faces, const Box<Dim, Real>& box, double reach) {
  for (const auto& element : faces.elements()) {
    for (int k = 0; k < Dim; ++k) {
      if (!element.is_rim[std::size_t(k)]) continue;
      for (int axis = 0; axis < Dim; ++axis) {
        if (!box.periodic[std::size_t(axis)]) continue;
        const double x = element.face.corners[std::size_t(k)][axis];
        const double lower = double(box.lower[axis]), upper = double(box.upper[axis]);
        const double beyond = std::max(lower - x, x - upper);
        if (beyond < -1e-9 * (upper - lower) || beyond >= reach) continue;
        fail({"ImageWalls: a wall ends at ", element.face.corners[std::size_t(k)],
              " m, at a periodic side of the box; let it extend beyond by at least ", reach, " m"});
      }
    }
  }
}

/// Throws if a body is at a periodic side: fluid sees beyond it by the reach [m], where the body has no
/// copies. In a periodic direction, a body is inside of the box, or extends beyond both sides.
template <int Dim, class Real>
void require_bodies_off_sides(const Faces<Dim>& faces, const WallMover<Dim>& mover,
                              const Box<Dim, Real>& box, double reach) {
  const auto bodies = static_cast<std::uint32_t>(mover.number_of_bodies());
  for (std::uint32_t group = faces.groups() - bodies + 1; group <= faces.groups(); ++group) {
    const auto bounds = faces.bounds_of_group(group);
    for (int axis = 0; axis < Dim; ++axis) {
      if (!box.periodic[std::size_t(axis)]) continue;
      const double below = bounds.lower[axis] - double(box.lower[axis]);
      const double above = double(box.upper[axis]) - bounds.upper[axis];
      if (std::min(below, above) >= reach || std::max(below, above) <= -reach) continue;
      fail({"ImageWalls: ", mover.name_of(group), " extends from ", bounds.lower[axis], " to ",
            bounds.upper[axis], " m along axis ", axis, ", closer to a periodic side of the box than ",
            reach, " m, the radius of the fluid, and has no copies beyond it; keep it off the sides, "
            "with is_held for example, or give it faces beyond both"});
    }
  }
}

/// Throws if fluid is in a solid body before the first step.
template <FluidParticles P, int Dim>
[[gnu::cold]] void require_no_fluid_in_bodies(const P& particles, const WallMover<Dim>& mover) {
  const auto x = particles[position];
  const PointInBody found = mover.find_in_solids(
      particles.size(), [&](Index i) -> Vec<Dim> { return x[i].template cast<double>(); });
  if (found.point == particles.size()) return;
  fail({"ImageWalls: fluid at ", typename P::Vec(x[found.point]), " m is inside of ",
        mover.name_of(found.group),
        ", which is solid; call remove_inside(particles, faces, spacing) with its faces before the "
        "simulation, or give it mass_properties instead of a density, if it is a hull with a cargo"},
       {.particle = found.point, .id = particles.id(found.point)});
}

/// Whether a face is beyond x [m] in a direction, a unit vector; also if the line from x only
/// passes it closely.
template <int Dim>
class FacesAlong {
 public:
  using Vec = silt::Vec<Dim>;

  FacesAlong(const Faces<Dim>& faces, const Vec& direction) : faces_(faces), direction_(direction) {
    for (const auto& element : faces.elements()) {
      for (const Vec& corner : element.face.corners) {
        farthest_ = std::max(farthest_, direction.dot(corner));
      }
    }
  }

  bool is_any_beyond(const Vec& x) const {
    const double length = farthest_ - direction_.dot(x);
    if (!(length > 0)) return false;
    const Vec end = x + length * direction_;
    const double round_off = 1e-9 * length;
    bool found = false;
    typename Faces<Dim>::Bounds bounds{x, x};
    bounds.enclose({end, end});
    faces_.for_each_near(bounds, round_off, [&](std::uint32_t k) {
      const auto& element = faces_[k];
      const double along = element.normal.dot(direction_);
      const bool is_beyond = std::abs(along) > 1e-12 && element.height(x) / along < 0;
      found =
          found || (is_beyond && passage_of(element.face, x, end, round_off) != Passage::beside);
    });
    return found;
  }

 private:
  const Faces<Dim>& faces_;
  Vec direction_;
  double farthest_ =
      -std::numeric_limits<double>::infinity();  // of all corners, in the direction [m]
};

/// Throws if there are no faces, or if a body of fluid at rest has none below it along gravity
/// [m/s²]: it would fall freely, out of the box or for ever. Particles that see each other are of
/// one body.
template <FluidParticles P, class N, int Dim>
[[gnu::cold]] void require_held(const P& particles, const N& neighbourhood, const Faces<Dim>& faces,
                                const Vec<Dim>& gravity) {
  bool has_end = false, is_endless = false;
  for (int axis = 0; axis < Dim; ++axis) {
    if (gravity[axis] == 0) continue;
    (particles.box().periodic[std::size_t(axis)] ? is_endless : has_end) = true;
  }
  if (!has_end || particles.size() == 0) return;
  if (faces.elements().empty()) {
    fail({"ImageWalls: there are no faces, and nothing else holds the fluid against gravity = ",
          gravity + Vec<Dim>(Vec<Dim>::Zero()),  // no −0
          " m/s²; give FlowSettings::walls, such as those of make_tank<Scheme, Dim>(), or set "
          "ImageWalls::let_fluid_fall"});
  }
  if (is_endless) return;
  const FacesAlong<Dim> below(faces, gravity.normalized());
  const auto u = particles[velocity];
  Buffer<bool> is_known(particles.size(), false);
  Buffer<Index> body;
  for (Index first = 0; first < particles.size(); ++first) {
    if (is_known[first]) continue;
    is_known[first] = true;
    body.assign(1, first);
    bool is_held = false;
    for (Index k = 0; k < body.size(); ++k) {
      const Index i = body[k];
      is_held = is_held || !(u[i].squaredNorm() == 0) ||
                below.is_any_beyond(neighbourhood.position_of(i).template cast<double>());
      const auto row = neighbourhood[i];
      for (Index n = 0; n < row.size(); ++n) {
        const Index j = particles.owner(row.index[n]);
        if (j >= particles.size()) {
          is_held = true;  // perhaps: it is one of another process
        } else if (!is_known[j]) {
          is_known[j] = true;
          body.push_back(j);
        }
      }
    }
    if (is_held) continue;
    fail({"ImageWalls: the fluid at ", typename P::Vec(particles[position][first]),
          " m is at rest and has no wall below it; move it to the other side of the wall beside "
          "it, or set ImageWalls::let_fluid_fall"},
         {.particle = first, .id = particles.id(first)});
  }
}

}  // namespace silt::mps::detail
