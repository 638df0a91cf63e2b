// SPDX-License-Identifier: MIT
// Still water between walls of faces of any shape.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/mps/filling/cells_of_pool.hpp>
#include <silt/mps/filling/packing.hpp>
#include <silt/mps/filling/pool.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/recommended.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include <cstddef>
#include <vector>

namespace silt::mps {

/// What fill() has done.
struct Filling {
  Index particles = 0;  ///< added
  double volume = 0;    ///< of the room that they fill [m³], in 2D per metre of depth [m²]
  /// Largest deviation from what Recommended needs for rest: of n from n0, over n0, and of the
  /// depth of the particles on the surface, over l0 [-]; 0 on a lattice.
  double deviation = 0;
};

/// Adds fluid at rest: all of the room between the walls, where they are at the time 0, that is
/// connected with a point, up to a level; the water around a floating body, too. Where the room
/// consists of cells of a lattice, the particles are its points, in the order of make_tank().
/// Elsewhere they are moved until the recommended scheme leaves them at rest. As many as the volume
/// has cells, to the nearest number. What begins with several levels is filled by several calls.
/// Faces that hold the water only in the beginning, such as a gate, are among the walls here, not
/// in the flow. Throws if the pool is invalid, if the walls do not hold the water, if a part of the
/// room is too narrow for the spacing, if the particles find no places where they rest, or if there
/// are particles in it already.
template <FluidParticles P>
Filling fill(P& particles, const ImageWalls& walls, const Pool<P::dimension>& pool) {
  constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  static_assert(
      !silt::detail::Processes<P>::are_several,
      "mps: fill() cannot divide the water among processes; fill a Fluid, and share it then");
  if (particles.box().any_periodic()) {
    fail(
        "fill: the box is periodic, but a pool ends at walls; give a box that is not periodic, or "
        "use lattice()");
  }
  Faces<Dim> faces("fill", walls.template faces<Dim>(), walls.template moving<Dim>().groups());
  if (const auto mover = walls.template moving<Dim>().mover()) mover->place(faces);
  const detail::PoolRoom<Dim> room(faces, pool);
  const Index before = particles.size();
  for (Index i = 0; i < before; ++i) {
    const Vec<Dim> x = particles[position][i].template cast<double>();
    if (!room.is_wet(x)) continue;
    fail({"fill: there is a particle already at ", to_text(x),
          " m, in the room around inside = ", to_text(pool.inside), " m; fill each room once"});
  }
  const detail::CellsOfPool<Dim> cells = detail::cells_of(room);
  Filling filling{.particles = cells.points.size(), .volume = room.volume()};
  std::vector<Vec<Dim, Real>> points;
  if (cells.is_lattice) {
    for (const auto& cell : cells.cells) {
      Vec<Dim, Real> x;
      for (int k = 0; k < Dim; ++k) {
        x[k] = Real(cells.origin[k]) + (Real(cell[k]) + Real(0.5)) * Real(pool.spacing);
      }
      points.push_back(x);
    }
  } else {
    room.require_resolved();
    FlowSettings<Dim, Recommended> settings{.spacing = pool.spacing};
    settings.walls = walls;
    detail::Packing<Dim> packing(settings, room.level(), cells.points);
    packing.pack();
    filling.deviation = packing.deviation();
    // With more, water is thrown about: √(g H)/2 was seen at 5.5e-2.
    constexpr double most = 0.02;
    if (!(filling.deviation <= most)) {
      fail({"fill: the particles around ", to_text(packing.place_of_deviation()),
            " m find no places where they rest: their number or depth deviates by ",
            filling.deviation, ", more than ", most,
            "; decrease the spacing, or make the walls there of larger faces"});
    }
    for (const Vec<Dim>& x : packing.positions()) points.push_back(x.template cast<Real>());
  }
  for (const auto& x : points) {
    if (particles.box().contains(x)) continue;
    fail({"fill: the water reaches ", to_text(x),
          " m, beyond the box of the particles; enlarge the box, or lower "
          "the level"});
  }
  for (const auto& x : points) add_particle(particles, x, Kind::fluid);
  return filling;
}

}  // namespace silt::mps
