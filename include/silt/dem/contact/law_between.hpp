// SPDX-License-Identifier: MIT
// The law between the two sides of a contact, and the walls at its time.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/materials.hpp>

#include <cstdint>

namespace silt::dem::detail {

/// The law of a contact of a list.
template <class List, class Law, class Walls>
const Law& law_between(const List& list, const Materials<Law>& materials, const Walls& walls,
                       Index c) {
  const ContactList& contacts = list.contacts;
  const auto& of_grains = list.constants.materials;
  const Index second = contacts.second(c);
  return materials.between(
      of_grains[contacts.first(c)],
      contacts.is_of_wall(c) ? walls.material(walls.number_of(second)) : of_grains[second]);
}

/// The walls of a WallSet at the time N of a step.
template <class P, class Walls>
auto walls_at(const Walls& walls, const StepTime& step) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = step.time, .velocities = step.time});
}
/// The same with the velocities of N − ½, as used by the law.
template <class P, class Walls>
auto walls_in_law(const Walls& walls, const StepTime& step) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = step.time, .velocities = step.of_velocities()});
}

}  // namespace silt::dem::detail
