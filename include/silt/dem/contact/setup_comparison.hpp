// SPDX-License-Identifier: MIT
// A checkpoint of other laws or walls is recognised, whatever their types, by forces in a test
// contact and by the points of the walls nearest to some grains. A local change of a wall of many
// elements may be far from these; such walls have a checksum(), see Wall.
#pragma once

#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/of_constants.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace silt::dem::detail {

template <class Vector>
void append_components(std::vector<double>& numbers, const Vector& vector) {
  for (int k = 0; k < int(vector.size()); ++k) numbers.push_back(double(vector[k]));
}
/// Forces [N] and couples [N m] on i in a contact that is loaded while it sticks, slides and rolls,
/// and is then unloaded until it nearly ends.
template <int Dim, class Real, class Law>
std::vector<double> forces_in_test_contact(const Law& law) {
  struct State {
    double overlap;   // [m]
    double approach;  // [m/s]
    double slip;      // in the first tangential direction [m/s]
    double spin;      // about every axis [1/s]
  };
  constexpr State states[] = {{1e-5, 0.1, 1e-3, 0.1},
                              {1e-4, 0.1, 1e-3, 0.1},
                              {2e-4, 0.1, 100, 1},
                              {1e-4, -0.1, -1, -1000},
                              {1e-7, -0.1, 0, 0}};
  Contact<Dim, Real> contact;
  contact.normal = Vec<Dim, Real>::Unit(Dim - 1);
  contact.effective_mass = Real(1e-2);
  contact.effective_radius = Real(1e-2);
  contact.time_step = Real(1e-5);
  typename LawHistory<Law, Dim, Real>::type history{};
  std::vector<double> numbers;
  for (const State& state : states) {
    contact.overlap = Real(state.overlap);
    contact.relative_velocity =
        Real(state.slip) * Vec<Dim, Real>::Unit(0) - Real(state.approach) * contact.normal;
    for (int k = 0; k < angular_size<Dim>; ++k) {
      component(contact.relative_spin, k) = Real(state.spin);
    }
    const auto load = [&] {
      if constexpr (LawWithHistory<Law, Dim, Real>) {
        return evaluate_law(law, contact, history);
      } else {
        return evaluate_law(law, contact);
      }
    }();
    append_components(numbers, Vec<Dim, Real>(force_of<Dim, Real>(load, contact.normal)));
    auto couple = couple_of<Dim, Real>(load);
    for (int k = 0; k < angular_size<Dim>; ++k) numbers.push_back(double(component(couple, k)));
  }
  if constexpr (LastsBeyondTouch<Law, Dim, Real>) {
    numbers.push_back(double(law.max_gap(contact.effective_radius)));
  }
  return numbers;
}

/// For a wall, given by its number, of a set at one time: its velocity [m/s], its distance [m] and
/// its normal at up to eight grains, or, without grains, at some points near the origin. `walls` is
/// a WallsAtTime.
template <class P, class Walls>
std::vector<double> nearest_points_of_wall(const P& grains, const Walls& walls, Index number) {
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  constexpr Index most_points = 8;
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  std::vector<Vec> points;
  const Index count = std::min(grains.size(), most_points);
  for (Index k = 0; k < count; ++k) points.push_back(grains[position][k * grains.size() / count]);
  if (grains.empty()) {
    for (int k = 0; k < P::dimension; ++k) points.push_back(Vec::Unit(k));
  }
  const Real scale = grains.empty() ? Real(1) : radius_range(grains).largest;
  std::vector<double> numbers;
  for (const Vec& at : points) {
    // Whether a wall is further away than a few hundred radii makes no difference for some time.
    for (Real distance = 2 * scale; distance < 1000 * scale; distance *= 4) {
      NearestPoint<P::dimension, Real> nearest{Vec::Zero(), infinity};
      Index nearest_element = no_index;
      walls.for_each_element_near(at, distance, [&](Index element) {
        if (walls.number_of(element) != number) return;
        const auto point = walls.nearest(element, at);
        if (!(point.distance < nearest.distance)) return;
        nearest = point;
        nearest_element = element;
      });
      if (nearest_element == no_index) continue;
      numbers.push_back(double(nearest.distance));
      append_components(numbers, nearest.normal);
      const Vec surface = at - nearest.distance * nearest.normal;
      append_components(numbers, Vec(walls.velocity(nearest_element).at(surface)));
      break;
    }
  }
  return numbers;
}

/// What a checkpoint has in common with the program that reads it.
struct CommonSetup {
  bool laws_and_walls = true;
  bool wall_elements = true;  ///< the same numbers of elements
};

/// Writes what characterises laws and walls at this time [s] to a checkpoint, or throws if it is
/// not what the checkpoint has, unless that is accepted. `walls` is a WallSet.
template <class Archive, class P, class Law, class Walls>
CommonSetup compare_setup(Archive& archive, const P& grains, const Materials<Law>& materials,
                          const Walls& walls, double time) {
  constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  constexpr double tolerance = std::max(1e-9, 64 * double(std::numeric_limits<Real>::epsilon()));
  std::vector<SetupPart> laws{{"number of materials", {double(materials.count())}}};
  for (std::uint32_t a = 0; a < materials.count(); ++a) {
    for (std::uint32_t b = 0; b < materials.count(); ++b) {
      laws.push_back({"law between materials " + std::to_string(a) + " and " + std::to_string(b),
                      forces_in_test_contact<Dim, Real>(materials.between(a, b)), tolerance});
    }
  }
  Walls all = walls;
  all.set_all_present();
  const auto all_now = all.template at<Dim, Real>({.positions = time, .velocities = time});
  std::vector<SetupPart> elements{{"number of walls", {double(walls.size())}}};
  std::vector<SetupPart> parts;
  for (Index w = 0; w < walls.size(); ++w) {
    const std::string wall = "wall " + std::to_string(w);
    elements.push_back({wall, {double(walls.elements_of(w))}});
    parts.push_back({wall, nearest_points_of_wall(grains, all_now, w), tolerance});
    // Numbers that the tolerance tells apart.
    const std::uint64_t sum = walls.checksum(w);
    parts.push_back({wall, {double(sum & 0xffffff), double(sum >> 24 & 0xffffff)}});
    parts.push_back({"material of " + wall, {double(walls.material(w))}});
  }
  CommonSetup common;
  common.laws_and_walls = archive.setup("laws", laws);
  common.wall_elements = archive.setup("elements", elements);
  common.laws_and_walls &= common.wall_elements;
  common.laws_and_walls &= archive.setup("walls", parts);
  return common;
}

}  // namespace silt::dem::detail
