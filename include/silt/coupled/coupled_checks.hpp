// SPDX-License-Identifier: MIT
// Whether a simulation of grains and one of a fluid fit each other.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/forces.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/drag.hpp>
#include <silt/coupled/fluid_forces.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <cmath>
#include <cstdint>
#include <tuple>
#include <type_traits>

namespace silt::coupled::detail {

template <class I>
inline constexpr bool is_fluid_forces = false;
template <class Drag>
inline constexpr bool is_fluid_forces<FluidForces<Drag>> = true;

/// The FluidForces of the interaction of grains, its last part.
template <class... Parts>
auto& fluid_forces_of(Forces<Parts...>& forces) {
  constexpr Index last = sizeof...(Parts) - 1;
  static_assert(is_fluid_forces<std::tuple_element_t<last, std::tuple<Parts...>>>,
                "silt::coupled::Coupled: the last part of the Forces on the grains must be a "
                "coupled::FluidForces, since drag depends on the other forces");
  return forces.template part<last>();
}

/// Throws unless all have the same time [s], to round-off.
template <class GrainSimulation, class FluidSimulation>
void require_common_times(const GrainSimulation& grains, const FluidSimulation& fluid,
                          double time) {
  const double tolerance = 1e-9 * std::abs(time);
  if (std::abs(grains.time() - time) <= tolerance && std::abs(fluid.time() - time) <= tolerance) {
    return;
  }
  fail({"Coupled: the grains are at ", grains.time(), " s and the fluid is at ", fluid.time(),
        " s; let both begin at the same time"});
}

/// Throws if a grain is larger than the spacing [m], or its centre on a wall of the flow.
template <class G, class Walls>
void require_small_grains_off_walls(const G& grains, const Walls& walls, double spacing) {
  constexpr int Dim = G::dimension;
  const auto R = grains[radius];
  const auto x = grains[position];
  for (Index k = 0; k < grains.size(); ++k) {
    if (2 * double(R[k]) > spacing * (1 + 1e-9)) {
      fail({"Coupled: a grain has a diameter of ", 2 * double(R[k]),
            " m, more than the spacing of the fluid, ", spacing,
            " m; increase the spacing, or make it a floating body, which the flow resolves"},
           {.particle = k, .id = grains.id(k)});
    }
    if constexpr (requires { walls.faces(); }) {
      const Vec<Dim> centre = x[k].template cast<double>();
      const double near = 1e-3 * double(R[k]);
      walls.faces().for_each_near(centre, near, [&](std::uint32_t element) {
        if (!((nearest_of(walls.faces()[element].face, centre) - centre).norm() < near)) return;
        fail({"Coupled: a grain is on a wall of the flow, at ", to_text(centre),
              " m; move it to the side of the fluid"},
             {.particle = k, .id = grains.id(k)});
      });
    }
  }
}

/// Throws unless the grains and the fluid have the same time, gravity and periodic sides, grains
/// are smaller than the spacing and off walls, and there is viscosity if there is drag.
template <class GrainSimulation, class FluidSimulation>
void require_common_setup(GrainSimulation& grains, const FluidSimulation& fluid) {
  using G = std::remove_cvref_t<decltype(grains.particles())>;
  constexpr int Dim = G::dimension;
  const auto& settings = fluid.interaction().settings();
  require_common_times(grains, fluid, fluid.time());
  const auto &box = grains.particles().box(), &other = fluid.particles().box();
  for (int k = 0; k < Dim; ++k) {
    const bool is_periodic = box.periodic[std::size_t(k)];
    const bool fits =
        is_periodic == other.periodic[std::size_t(k)] &&
        (!is_periodic || (box.lower[k] == other.lower[k] && box.upper[k] == other.upper[k]));
    if (fits) continue;
    fail({"Coupled: along axis ", k,
          ", the boxes of grains and fluid are not periodic alike; give both "
          "the same one"});
  }
  Vec<Dim> gravity = Vec<Dim>::Zero();
  grains.interaction().for_each_part([&](const auto& part) {
    if constexpr (requires { part.acceleration(); }) {
      gravity += Vec<Dim>(part.acceleration().template cast<double>());
    }
  });
  if (!((gravity - settings.gravity).norm() <= 1e-9 * settings.gravity.norm())) {
    fail({"Coupled: gravity is ", to_text(gravity), " m/s² on the grains and ",
          to_text(settings.gravity), " m/s² in the fluid; give both the same"});
  }
  require_small_grains_off_walls(std::as_const(grains).particles(), fluid.interaction().walls(),
                                 settings.spacing);
  const auto& drag = fluid_forces_of(grains.interaction()).drag();
  if constexpr (requires { drag.is_none(); }) {
    if (drag.is_none()) return;
  }
  const double mu = settings.density * settings.viscosity;
  for (const double fluid_fraction : {0.5, 0.9}) {
    const double tested = drag.coefficient({.diameter = settings.spacing,
                                            .fluid_fraction = fluid_fraction,
                                            .speed = 1,
                                            .density = settings.density,
                                            .viscosity = mu});
    if (tested > 0 && is_finite(tested)) continue;
    fail({"Coupled: a drag of β = ", tested,
          " kg/s at 1 m/s in a fluid with FlowSettings: viscosity = ", settings.viscosity,
          " m²/s; give the fluid a viscosity, or the grains NoDrag"});
  }
}

}  // namespace silt::coupled::detail
