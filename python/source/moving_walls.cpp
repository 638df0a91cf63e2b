// SPDX-License-Identifier: MIT
#include "moving_walls.hpp"

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/geometry/any_rigid_motion.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/orientation.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/geometry/rigid_motion.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "body_state.hpp"
#include "objects.hpp"
#include "python_function.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {
namespace {

template <int Dim>
py::array array_of(const std::vector<Face<Dim>>& faces) {
  py::array_t<double> array({py::ssize_t(faces.size()), py::ssize_t(Dim), py::ssize_t(Dim)});
  double* to = array.mutable_data();
  for (const Face<Dim>& face : faces) {
    for (const Vec<Dim>& corner : face.corners) to = std::copy(corner.begin(), corner.end(), to);
  }
  return array;
}

// An angular vector is a number in 2D, for Python one of one component.
template <int Dim>
AngularVec<Dim> to_angular(const std::string& name, const std::vector<double>& numbers) {
  if (numbers.size() != Index(angular_size<Dim>)) {
    fail(name + " has " + std::to_string(numbers.size()) + " components; in " +
         std::to_string(Dim) + "D give " + (Dim == 2 ? "a number" : "3"));
  }
  AngularVec<Dim> angular = zero_of<AngularVec<Dim>>();
  for (int k = 0; k < angular_size<Dim>; ++k) component(angular, k) = numbers[Index(k)];
  return angular;
}
template <int Dim>
AngularVec<Dim> angular(const py::handle& object, const char* name) {
  return to_angular<Dim>(type_of(object) + ": " + name,
                         object.attr(name).cast<std::vector<double>>());
}

// The default if the attribute is None.
template <int Dim>
Vec<Dim> vector_or_zero(const py::handle& object, const char* name) {
  if (object.attr(name).is_none()) return Vec<Dim>::Zero();
  return vector<Dim>(object, name);
}
template <int Dim>
AngularVec<Dim> angular_or_zero(const py::handle& object, const char* name) {
  if (object.attr(name).is_none()) return zero_of<AngularVec<Dim>>();
  return angular<Dim>(object, name);
}

// A vector and an angular vector, one after the other, that a function of Python returned.
template <int Dim>
struct VectorAndAngular {
  Vec<Dim> vector;
  AngularVec<Dim> angular;

  VectorAndAngular(const std::string& name, const std::vector<double>& numbers) {
    const Index size = std::min(numbers.size(), Index(Dim));
    const auto end = numbers.begin() + std::ptrdiff_t(size);
    vector = to_vector<Dim>(name, {numbers.begin(), end});
    angular = to_angular<Dim>(name, {end, numbers.end()});
  }
};

template <int Dim>
Pose<Dim> pose_about(const Vec<Dim>& about, const AngularVec<Dim>& turn, const Vec<Dim>& shift) {
  Pose<Dim> pose{.rotation = Orientation<Dim>{}.turned(turn).matrix()};
  pose.shift = about - multiply<Dim, double>(pose.rotation, about) + shift;
  return pose;
}

template <int Dim>
TabulatedMotion<Dim> table_of(const py::handle& object) {
  TabulatedMotion<Dim> table{.times = numbers_of(object.attr("times").cast<Doubles>()),
                             .about = vector_or_zero<Dim>(object, "about")};
  if (const py::object shifts = object.attr("shifts"); !shifts.is_none()) {
    const Rows rows = rows_of(shifts.cast<Doubles>());
    for (Index k = 0; k < rows.size(); ++k) {
      const double* first = rows.numbers.data() + k * rows.columns;
      table.shifts.push_back(
          to_vector<Dim>("TabulatedMotion: shifts", {first, first + rows.columns}));
    }
  }
  if (const py::object turns = object.attr("turns"); !turns.is_none()) {
    const Rows rows = rows_of(turns.cast<Doubles>());
    for (Index k = 0; k < rows.size(); ++k) {
      const double* first = rows.numbers.data() + k * rows.columns;
      table.turns.push_back(
          to_angular<Dim>("TabulatedMotion: turns", {first, first + rows.columns}));
    }
  }
  return table;
}

template <int Dim>
AnyRigidMotion<Dim> motion_of(const py::handle& object) {
  const std::string type = type_of(object);
  if (type == "Translation") {
    return Translation<Dim>{.velocity = vector<Dim>(object, "velocity")};
  }
  if (type == "Rotation") {
    return Rotation<Dim>{.about = vector_or_zero<Dim>(object, "about"),
                         .spin = angular<Dim>(object, "spin")};
  }
  if (type == "Vibration") {
    return Vibration<Dim>{.amplitude = vector<Dim>(object, "amplitude"),
                          .frequency = number(object, "frequency"),
                          .phase = number(object, "phase")};
  }
  if (type == "TabulatedMotion") return table_of<Dim>(object);
  const PythonFunction function(object.attr("_numbers"));
  return MotionFunction<Dim>{[function, about = vector_or_zero<Dim>(object, "about")](double t) {
    const VectorAndAngular<Dim> now("MotionFunction: what the function returned", function({t}));
    return pose_about<Dim>(about, now.angular, now.vector);
  }};
}

template <int Dim>
std::vector<double> numbers_of_state(const BodyState<Dim>& state) {
  std::vector<double> all(state.position.begin(), state.position.end());
  Orientation<Dim> orientation = state.orientation;
  orientation.for_each_number([&](double value) { all.push_back(value); });
  all.insert(all.end(), state.velocity.begin(), state.velocity.end());
  AngularVec<Dim> spin_now = state.spin;
  for (int k = 0; k < angular_size<Dim>; ++k) all.push_back(component(spin_now, k));
  for (int row = 0; row < Dim; ++row) {
    for (int column = 0; column < Dim; ++column) all.push_back(state.pose.rotation(row, column));
  }
  all.insert(all.end(), state.pose.shift.begin(), state.pose.shift.end());
  return all;
}

template <int Dim>
MassProperties<Dim> mass_properties_from(const py::handle& object) {
  MassProperties<Dim> body{.mass = number(object, "mass"), .centre = vector<Dim>(object, "centre")};
  const auto inertia = numbers_of(object.attr("inertia").cast<Doubles>());
  constexpr Index size = Dim == 2 ? 1 : 9;
  if (inertia.size() != size) {
    fail("MassProperties: inertia has " + std::to_string(inertia.size()) +
         " numbers; give a number in 2D, and an array of shape (3, 3) in 3D");
  }
  if constexpr (Dim == 2) {
    body.inertia = inertia[0];
  } else {
    body.inertia = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(inertia.data());
  }
  return body;
}

template <int Dim>
mps::FloatingBody<Dim> body_from(const py::handle& object) {
  mps::FloatingBody<Dim> body;
  body.faces = faces_from<Dim>("FloatingBody: faces", object.attr("faces").cast<Doubles>());
  if (const py::object mass = object.attr("mass_properties"); !mass.is_none()) {
    body.mass_properties = mass_properties_from<Dim>(mass);
  } else {
    body.density = number(object, "density");
  }
  body.velocity = vector_or_zero<Dim>(object, "velocity");
  body.spin = angular_or_zero<Dim>(object, "spin");
  if (!object.attr("held").is_none()) {
    const Vec<Dim> held = vector<Dim>(object, "held");
    for (int k = 0; k < Dim; ++k) body.is_held[Index(k)] = held[k] != 0;
  }
  body.keeps_orientation = object.attr("keeps_orientation").cast<bool>();
  body.radius = number(object, "radius");
  body.friction = number(object, "friction");
  if (object.attr("load").is_none()) return body;
  const PythonFunction function(object.attr("_load_numbers"));
  body.load = [function](const BodyState<Dim>& state, double time) {
    std::vector<double> arguments = numbers_of_state(state);
    arguments.push_back(time);
    const VectorAndAngular<Dim> load("FloatingBody: what load returned", function(arguments));
    return BodyLoad<Dim>{.force = load.vector, .torque = load.angular};
  };
  return body;
}

}  // namespace

template <int Dim>
mps::AnyMovingWalls<Dim> moving_walls_of(const py::list& moving, const AnyOpenings<Dim>* openings,
                                         const py::list& bodies) {
  mps::MovingWalls<Dim> walls;
  for (const auto object : moving) {
    mps::MovingFaces<Dim> group;
    group.faces = faces_from<Dim>("MovingFaces: faces", object.attr("faces").cast<Doubles>());
    group.motion = motion_of<Dim>(object.attr("motion"));
    walls.faces.push_back(std::move(group));
  }
  if (openings != nullptr) {
    for (mps::MovingFaces<Dim>& piston : openings->pistons()) {
      walls.faces.push_back(std::move(piston));
    }
  }
  for (const auto object : bodies) walls.bodies.push_back(body_from<Dim>(object));
  if (walls.faces.empty() && walls.bodies.empty()) return {};
  return walls;
}

template <int Dim>
std::vector<double> state_of_body(const std::vector<mps::BodyInFlow<Dim>>& bodies, Index body) {
  return numbers_of_state(bodies[body].state());
}

template <int Dim>
Vec<Dim> centre_of_body(const std::vector<mps::BodyInFlow<Dim>>& bodies, Index body) {
  return bodies[body].mass_properties().centre;
}

template <int Dim>
py::array without_inside(const Doubles& positions, const Doubles& faces, double spacing) {
  const Rows rows = rows_of(positions);
  mps::Fluid<Dim> fluid;
  for (Index i = 0; i < rows.size(); ++i) {
    mps::add_particle(fluid, rows.vector<Dim>(i), mps::Kind::fluid);
  }
  mps::remove_inside(fluid, faces_from<Dim>("remove_inside: faces", faces), spacing);
  std::vector<Id> kept(fluid.ids().begin(), fluid.ids().end());
  std::sort(kept.begin(), kept.end());
  py::array_t<double> array({py::ssize_t(kept.size()), py::ssize_t(Dim)});
  double* to = array.mutable_data();
  for (const Id id : kept) {
    const Vec<Dim> x = rows.vector<Dim>(Index(id));
    to = std::copy(x.begin(), x.end(), to);
  }
  return array;
}

template <int Dim>
py::array faces_of_box(const std::vector<double>& lower, const std::vector<double>& upper,
                       bool open_top) {
  const Box<Dim> box{.lower = to_vector<Dim>("faces_of_box: lower", lower),
                     .upper = to_vector<Dim>("faces_of_box: upper", upper)};
  return array_of<Dim>(faces_of(box, open_top ? Sides<Dim>::open() : Sides<Dim>::all()));
}

template <int Dim>
py::array faces_of_ball(const std::vector<double>& centre, double radius, double edge) {
  if constexpr (Dim == 2) {
    return array_of<2>(faces_of_disc(to_vector<2>("faces_of_disc: centre", centre), radius, edge));
  } else {
    return array_of<3>(
        faces_of_sphere(to_vector<3>("faces_of_sphere: centre", centre), radius, edge));
  }
}

template mps::AnyMovingWalls<2> moving_walls_of(const py::list&, const AnyOpenings<2>*,
                                                const py::list&);
template mps::AnyMovingWalls<3> moving_walls_of(const py::list&, const AnyOpenings<3>*,
                                                const py::list&);
template std::vector<double> state_of_body(const std::vector<mps::BodyInFlow<2>>&, Index);
template std::vector<double> state_of_body(const std::vector<mps::BodyInFlow<3>>&, Index);
template Vec<2> centre_of_body(const std::vector<mps::BodyInFlow<2>>&, Index);
template Vec<3> centre_of_body(const std::vector<mps::BodyInFlow<3>>&, Index);
template py::array without_inside<2>(const Doubles&, const Doubles&, double);
template py::array without_inside<3>(const Doubles&, const Doubles&, double);
template py::array faces_of_box<2>(const std::vector<double>&, const std::vector<double>&, bool);
template py::array faces_of_box<3>(const std::vector<double>&, const std::vector<double>&, bool);
template py::array faces_of_ball<2>(const std::vector<double>&, double, double);
template py::array faces_of_ball<3>(const std::vector<double>&, double, double);

}  // namespace silt::python
