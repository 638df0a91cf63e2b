// SPDX-License-Identifier: MIT
// Quantities of Boost.Units in place of the numbers of a simulation of grains. A quantity of
// another dimension does not compile; millimetres and degrees are converted.
#pragma once

#include <silt/dem.hpp>

#include <boost/units/quantity.hpp>
#include <boost/units/systems/angle/degrees.hpp>
#include <boost/units/systems/si.hpp>
#include <boost/units/systems/si/prefixes.hpp>

#include <type_traits>

namespace units {

namespace si = boost::units::si;
using boost::units::quantity;

using Length = quantity<si::length>;
using Time = quantity<si::time>;
using Density = quantity<si::mass_density>;
using Acceleration = quantity<si::acceleration>;
using Stiffness = quantity<si::surface_tension>;  // N/m
using Angle = quantity<si::plane_angle>;

/// The numbers that Silt takes are those in SI units.
template <class Unit>
double number(const quantity<Unit>& value) {
  static_assert(std::is_same_v<typename Unit::system_type, si::system>,
                "give a quantity in SI units");
  return value.value();
}

struct Grain {
  Length radius;
  Density density;

  operator silt::dem::Grain() const {
    return {.radius = number(radius), .density = number(density)};
  }
};

struct CundallStrack {
  Stiffness normal_stiffness;
  Stiffness tangential_stiffness;
  double restitution = 1;
  Angle friction_angle;

  operator silt::dem::CundallStrack() const {
    return {.normal_stiffness = number(normal_stiffness),
            .tangential_stiffness = number(tangential_stiffness),
            .restitution = restitution,
            .friction_angle = number(friction_angle)};
  }
};

struct Run {
  Time until;
  Time output_every;

  operator silt::Run() const {
    return {.until = number(until), .output_every = number(output_every)};
  }
};

}  // namespace units
