// SPDX-License-Identifier: MIT
// Simulations from the objects of the package.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/lattice.hpp>
#include <silt/core/types.hpp>

#include "any_simulation.hpp"
#include "any_wall.hpp"
#include "arrays.hpp"
#include "flow_setup.hpp"
#include "interpreter_lock.hpp"
#include "moving_walls.hpp"
#include "objects.hpp"
#include "openings.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace silt::python {

namespace py = pybind11;

inline dem::Side side(const py::handle& object) {
  return object.attr("grains").cast<std::string>() == "inside" ? dem::Side::inside
                                                               : dem::Side::outside;
}

template <int Dim>
Box<Dim> box_of(const py::handle& object) {
  Box<Dim> box;
  if (object.is_none()) return box;
  box.lower = vector<Dim>(object, "lower");
  box.upper = vector<Dim>(object, "upper");
  const Vec<Dim> periodic = vector<Dim>(object, "periodic");
  for (int k = 0; k < Dim; ++k) box.periodic[Index(k)] = periodic[k] != 0;
  if (object.attr("on_escape").cast<std::string>() == "remove") box.on_escape = OnEscape::remove;
  return box;
}

template <int Dim>
AnyWall<Dim> wall_of(const py::handle& object, Index place) {
  const std::string type = type_of(object);
  if (type == "Plane") {
    return {dem::Plane<Dim>{.point = vector<Dim>(object, "point"),
                            .normal = vector<Dim>(object, "normal")}};
  }
  if (type == "BoxWall") {
    const Box<Dim> box{.lower = vector<Dim>(object, "lower"),
                       .upper = vector<Dim>(object, "upper")};
    return {dem::BoxWall<Dim>{.box = box, .grains = side(object)}};
  }
  if constexpr (Dim == 2) {
    if (type == "Circle") {
      return {dem::Circle<>{.centre = vector<2>(object, "centre"),
                            .radius = number(object, "radius"),
                            .grains = side(object)}};
    }
    if (type == "Segment") {
      return {dem::Segment<>{.from = vector<2>(object, "start"), .to = vector<2>(object, "end")}};
    }
    if (type == "Polyline") {
      dem::Polyline<> line{.points = {}, .closed = object.attr("closed").cast<bool>()};
      const Rows points = rows_of(object.attr("points").cast<Doubles>());
      for (Index i = 0; i < points.size(); ++i) line.points.push_back(points.vector<2>(i));
      return {line};
    }
  } else {
    if (type == "Cylinder") {
      return {dem::Cylinder<>{.from = vector<3>(object, "start"),
                              .to = vector<3>(object, "end"),
                              .radius = number(object, "radius"),
                              .grains = side(object),
                              .ends = object.attr("ends").cast<bool>()}};
    }
    if (type == "MeshWall") {
      std::vector<Triangle<>> triangles;
      const Rows corners = rows_of(object.attr("corners").cast<Doubles>());
      for (Index i = 0; i + 2 < corners.size(); i += 3) {
        triangles.push_back(
            {{corners.vector<3>(i), corners.vector<3>(i + 1), corners.vector<3>(i + 2)}});
      }
      return {dem::MeshWall<>(triangles)};
    }
  }
  fail("grain_simulation: wall " + std::to_string(place) + " is a " + type +
       ", which is no wall in " + std::to_string(Dim) + "D; give a Plane, a BoxWall or " +
       (Dim == 2 ? "a Circle, Segment or Polyline" : "a Cylinder or MeshWall"));
}

inline ContactLaw law_of(const py::handle& law) {
  const std::string type = type_of(law);
  if (type == "CundallStrack") {
    return dem::CundallStrack{.normal_stiffness = number(law, "normal_stiffness"),
                              .tangential_stiffness = number(law, "tangential_stiffness"),
                              .restitution = number(law, "restitution"),
                              .friction_angle = number(law, "friction_angle")};
  }
  if (type == "LinearSpringDashpot") {
    return LinearLaw(
        dem::LinearSpringDashpot{.normal_stiffness = number(law, "normal_stiffness"),
                                 .restitution = number(law, "restitution")},
        dem::LinearFriction{.tangential_stiffness = number(law, "tangential_stiffness"),
                            .friction_angle = number(law, "friction_angle")});
  }
  if (type == "HertzMindlin") {
    const dem::Elastic elastic{.young_modulus = number(law, "young_modulus"),
                               .poisson_ratio = number(law, "poisson_ratio")};
    return HertzMindlin(
        dem::Hertz{.elastic = elastic, .restitution = number(law, "restitution")},
        dem::Mindlin{.elastic = elastic, .friction_angle = number(law, "friction_angle")});
  }
  fail("grain_simulation: law is a " + type +
       "; give a CundallStrack, a LinearSpringDashpot or a HertzMindlin");
}

// The arrays have been checked by the package.
struct GrainArguments {
  Doubles position, velocity, radius, density;
  py::object law;
  py::list walls;
  Doubles gravity;
  double damping;
  py::object box;
  double steps_per_contact;
  double max_overlap;
};

template <int Dim>
std::unique_ptr<AnySimulation> grains(const GrainArguments& given) {
  GrainSetup<Dim> setup{
      .positions = rows_of(given.position),
      .velocities = rows_of(given.velocity),
      .radii = numbers_of(given.radius),
      .densities = numbers_of(given.density),
      .law = law_of(given.law),
      .walls = {},
      .gravity = to_vector<Dim>("grain_simulation: gravity", numbers_of(given.gravity)),
      .damping = given.damping,
      .box = box_of<Dim>(given.box),
      .settings = {.steps_per_contact = given.steps_per_contact, .max_overlap = given.max_overlap}};
  for (const auto wall : given.walls) {
    setup.walls.push_back(wall_of<Dim>(wall, setup.walls.size()));
  }
  return std::visit([&](const auto& law) { return make_grain_simulation(setup, law); }, setup.law);
}

// The walls of a flow. The arrays have been checked by the package.
struct WallArguments {
  std::vector<double> tank;
  bool lid;
  Doubles faces;
  py::list moving, bodies;
};

/// A flow with these walls, which are arguments of a function of the package, and these openings.
template <int Dim>
FlowSetup<Dim> flow_between(const std::string& function, const WallArguments& given,
                            const std::shared_ptr<AnyOpenings<Dim>>& openings = nullptr) {
  FlowSetup<Dim> setup;
  setup.openings = openings;
  setup.tank = given.tank;
  setup.lid = given.lid;
  setup.walls = faces_from<Dim>(function + ": walls", given.faces);
  setup.moving = moving_walls_of<Dim>(given.moving, openings.get(), given.bodies);
  setup.moving_count = given.moving.size();
  return setup;
}

// The arrays have been checked by the package.
struct FlowArguments {
  Doubles position, velocity;
  WallArguments walls;
  bool removes_escaped;
  double spacing, density, viscosity, speed_scale;
  std::optional<Doubles> gravity;
  py::list openings;
};

template <int Dim>
std::unique_ptr<AnySimulation> flow(const FlowArguments& given) {
  FlowSetup<Dim> setup = flow_between<Dim>("flow_simulation", given.walls,
                                           openings_of<Dim>(given.openings, given.spacing));
  setup.positions = rows_of(given.position);
  setup.velocities = rows_of(given.velocity);
  setup.on_escape = given.removes_escaped ? OnEscape::remove : OnEscape::refuse;
  setup.spacing = given.spacing;
  setup.density = given.density;
  setup.viscosity = given.viscosity;
  setup.speed_scale = given.speed_scale;
  if (given.gravity) {
    setup.gravity = to_vector<Dim>("flow_simulation: gravity", numbers_of(*given.gravity));
  }
  return make_flow_simulation(setup);
}

/// Water at rest: positions, volume and deviation.
template <int Dim>
py::tuple filling_of(const WallArguments& walls, const std::vector<double>& inside, double level,
                     double spacing) {
  PoolSetup<Dim> setup{.flow = flow_between<Dim>("fill", walls),
                       .inside = to_vector<Dim>("fill: inside", inside),
                       .level = level};
  setup.flow.spacing = spacing;
  FilledPool pool;
  {
    const Unlocked unlocked;
    pool = fill_pool(setup);
  }
  py::array_t<double> array({py::ssize_t(pool.positions.size()), py::ssize_t(Dim)});
  std::copy(pool.positions.numbers.begin(), pool.positions.numbers.end(), array.mutable_data());
  return py::make_tuple(array, pool.volume, pool.deviation);
}

template <int Dim>
py::array lattice_of(const std::vector<double>& lower, const std::vector<double>& upper,
                     double spacing) {
  const auto points = lattice<Dim>({.lower = to_vector<Dim>("lattice: lower", lower),
                                    .upper = to_vector<Dim>("lattice: upper", upper)},
                                   spacing);
  py::array_t<double> array({py::ssize_t(points.size()), py::ssize_t(Dim)});
  double* to = array.mutable_data();
  for (const Vec<Dim>& x : points) to = std::copy(x.begin(), x.end(), to);
  return array;
}

}  // namespace silt::python
