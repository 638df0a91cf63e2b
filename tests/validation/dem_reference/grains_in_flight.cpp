// SPDX-License-Identifier: MIT
// Conservation in contacts, and completeness of the neighbour search.
#include "bench.hpp"
#include "items.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace silt::test {
namespace {

double size_of(double spin) { return std::abs(spin); }
double size_of(const Vec<3>& spin) { return spin.norm(); }

template <int Dim>
void two_bodies(ReferenceTable& table) {
  Vec<Dim> v = Vec<Dim>::Zero();
  v[0] = -1;
  v[1] = 0.7;
  auto grains = two_grains<Dim>(1e-4, v);
  if constexpr (Dim == 2) {
    grains[spin][0] = 80;
  } else {
    grains[spin][0] = {80, -20, 30};
  }
  const Vec<Dim> p = momentum(grains);
  const Vec<Dim> origin = Vec<Dim>::Zero();
  const auto L = angular_momentum(grains, origin);
  Bench<Dim> bench(grains, {.law = {.normal_stiffness = 1e6,
                                    .tangential_stiffness = 5e5,
                                    .restitution = 0.6,
                                    .friction_angle = 0.5}});
  bench.through_contact(bench.time_step());
  using AngularVec = typename dem::Grains<Dim>::AngularVec;
  const AngularVec gained = angular_momentum(bench.grains(), origin) - L;
  const std::string name =
      "9 oblique impact of two " + (Dim == 2 ? disc : sphere).name + "s with spin";
  table.add({name, "change of momentum [-]", 0, (momentum(bench.grains()) - p).norm() / p.norm(),
             1e-13, 1});
  table.add({name, "change of orbital and spin angular momentum [-]", 0,
             size_of(gained) / size_of(L), 1e-13, 1});
}

template <int Dim, class Search>
double missed(bool periodic) {
  const double r = 0.1;
  auto box = cube<Dim, double>(-0.5, 0.5);
  box.periodic.fill(periodic);
  auto points = random_points(300, box, 7);
  // Some are exactly on faces of cells.
  for (Index i = 0; i < points.size(); i += 3) {
    points[i][0] = std::min(0.4, std::floor(points[i][0] / r) * r);
  }
  auto particles = particles_at(points, box);
  Search search;
  search.set_radius(r);
  search.update(particles);
  const auto right = once_each(brute_force_pairs(particles, r));
  const auto found = once_each(neighbour_pairs(particles, search));
  std::vector<NeighbourPair<Dim, double>> differ;
  std::set_symmetric_difference(right.begin(), right.end(), found.begin(), found.end(),
                                std::back_inserter(differ));
  return right.size() < 100 ? 1e9 : double(differ.size());
}

void no_contacts(ReferenceTable& table) {
  auto box = cube<2, double>(0, 1);
  box.periodic.fill(true);
  dem::Grains<2> grains;
  grains.set_box(box);
  for (int i = 0; i < 10; ++i) {
    dem::add_grain(grains, {0.5, 0.05 + 0.1 * i}, pebble);
    grains[velocity][Index(i)] = {0.3 * i - 1, 0};
    grains[spin][Index(i)] = 2 * i;
  }
  const double before = kinetic_energy(grains);
  Bench<2> bench(grains, {.law = {.normal_stiffness = 1e6}});
  bench.run(5, 1e-3);
  table.add({"15 periodic box without contacts", "kinetic energy after 5 s [initial]", 1,
             kinetic_energy(bench.grains()) / before, 1e-15});
}

}  // namespace

void grains_in_flight(ReferenceTable& table) {
  two_bodies<2>(table);
  two_bodies<3>(table);
  for (const bool periodic : {false, true}) {
    const std::string name = std::string("13 points at random, also on cell faces and below 0") +
                             (periodic ? ", periodic sides" : "");
    table.add({name, "pairs of UniformGrid in 2D that differ from a brute-force search", 0,
               missed<2, UniformGrid<2>>(periodic), 0, 1});
    table.add({name, "pairs of UniformGrid in 3D that differ", 0,
               missed<3, UniformGrid<3>>(periodic), 0, 1});
    table.add({name, "pairs of NeighbourList in 3D that differ", 0,
               missed<3, NeighbourList<3>>(periodic), 0, 1});
  }
  no_contacts(table);
}

}  // namespace silt::test
