// SPDX-License-Identifier: MIT
// Grains that rest on one another, and that drag brings there.
#include "bench.hpp"
#include "items.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test {
namespace {

constexpr double g = 9.81;
constexpr double k = 1e6;

void column(ReferenceTable& table) {
  const int n = 10;
  dem::Grains<2> grains;
  for (int i = 0; i < n; ++i) {
    dem::add_grain(grains, {0, (2 * i + 1) * pebble.radius}, pebble);
  }
  const double weight = grains[mass][0] * g;
  Bench<2> bench(grains, {.law = {.normal_stiffness = k, .restitution = 0.5},
                          .gravity = {0, -g},
                          .alpha = 40,
                          .walls = {dem::Plane<2>{}}});
  bench.run(1.5);
  double floor = 0, worst = 0;
  Index contacts = 0;
  bench.for_each_contact([&](Index i, Index j, const auto& contact, const Vec<2>& force) {
    const double carried = j == no_index ? n : n - 1.0 - double(std::min(i, j));
    const double overlap = contact.overlap * k / weight / carried;
    if (std::abs(overlap - 1) >= std::abs(worst - 1) || contacts == 0) worst = overlap;
    if (j == no_index) floor = force[1];
    ++contacts;
  });
  const std::string name = "11 column of 10 discs";
  table.add({name, "contacts", n, double(contacts), 0});
  table.add({name, "overlap i, worst of all [i m g/k]", 1, worst, 0.002});
  table.add({name, "force on the floor [m g]", n, floor / weight, 0.002});
}

// One on two, without friction. Each of the lower is held by a plane that stands for floor and side
// together: it is turned as 1.5 m g upwards and ½ m g tan 30° inwards are.
void pyramid(ReferenceTable& table) {
  const double R = pebble.radius;
  dem::Grains<2> grains;
  dem::add_grain(grains, {-R, R}, pebble);
  dem::add_grain(grains, {R, R}, pebble);
  dem::add_grain(grains, {0, R + std::sqrt(3.0) * R}, pebble);
  const double weight = grains[mass][0] * g;
  const double up = 1.5;
  const double in = 0.5 * std::tan(std::numbers::pi / 6);
  const Vec<2> n = Vec<2>(in, up).normalized();
  const Vec<2> left(-R, R);
  const Vec<2> right(R, R);
  const Vec<2> mirrored(-n[0], n[1]);
  Bench<2> bench(grains, {.law = {.normal_stiffness = 1e7, .restitution = 0.5},
                          .gravity = {0, -g},
                          .alpha = 100,
                          .walls = {{.point = left - R * n, .normal = n},
                                    {.point = right - R * mirrored, .normal = mirrored}}});
  bench.run(0.6);
  double upper = 0, floor = 0, side = 0;
  bench.for_each_contact([&](Index i, Index j, const auto&, const Vec<2>& force) {
    if (j == no_index && i == 0) {
      floor = force[1];
      side = force[0];
    }
    if (j != no_index && std::max(i, j) == 2) upper = std::max(upper, force.norm());
  });
  const std::string name = "12 one disc on two that are held";
  table.add({name, "upper contacts [m g]", 1 / (2 * std::cos(std::numbers::pi / 6)),
             upper / weight, 0.005});
  table.add({name, "below a lower disc, upwards [m g]", up, floor / weight, 0.005});
  table.add({name, "and inwards [m g]", in, side / weight, 0.005});
}

void drag(ReferenceTable& table) {
  const double alpha = 0.5;
  const std::string name = "10 global damping, α = 0.5/s";
  const double dt = 1e-3;
  Bench<2> free(one_grain<2>({0, 0}, {1, 0}), {.law = {.normal_stiffness = k}, .alpha = alpha});
  free.step(dt);
  const double before = free.grains()[velocity][0][0];
  free.step(dt);
  table.add({name, "velocity after over before a step of 1 ms, (32) [-]",
             (1 - alpha * dt / 2) / (1 + alpha * dt / 2),
             free.grains()[velocity][0][0] / before, 1e-14});
  free.run(2, dt);
  table.add({name, "velocity of a free disc after 2 s [v0]", std::exp(-alpha * 2),
             free.at_whole_step()[velocity][0][0], 1e-6});
  Bench<2> falling(one_grain<2>({0, 0}, {0, 0}),
                   {.law = {.normal_stiffness = k}, .gravity = {0, -g}, .alpha = alpha});
  falling.run(40, 1e-2);
  table.add({name, "terminal speed of a fall [m/s]", g / alpha,
             -falling.at_whole_step()[velocity][0][1], 1e-6});
}

}  // namespace

void grains_at_rest(ReferenceTable& table) {
  drag(table);
  column(table);
  pyramid(table);
}

}  // namespace silt::test
