// SPDX-License-Identifier: MIT
// Sliding, rolling and oblique impacts against rigid-body mechanics.
#include "bench.hpp"
#include "items.hpp"

#include <cmath>

namespace silt::test {
namespace {

constexpr double g = 9.81;
constexpr double R = 0.01;

struct Floor {
  double mu;
  double theta;  // inclination, realised by the direction of gravity
  double stiffness = 1e5;
};

// A grain in equilibrium on the floor.
template <int Dim>
Bench<Dim> on_floor(const Body& body, const Floor& floor, double u0) {
  const auto [mu, theta, k] = floor;
  auto grains =
      one_grain<Dim>(Vec<Dim>(R * Vec<Dim>::Unit(Dim - 1)), Vec<Dim>(u0 * Vec<Dim>::Unit(0)),
                     {.radius = R, .density = 2500, .shape = body.shape});
  grains[position][0][Dim - 1] -= grains[mass][0] * g * std::cos(theta) / k;
  Vec<Dim> down = Vec<Dim>::Zero();
  down[0] = g * std::sin(theta);
  down[Dim - 1] = -g * std::cos(theta);
  return {grains,
          {.law = {.normal_stiffness = k,
                   .tangential_stiffness = 0.8 * k,
                   .restitution = 0.5,
                   .friction_angle = std::atan(mu)},
           .gravity = down,
           .walls = {{.normal = Vec<Dim>::Unit(Dim - 1)}}}};
}

template <int Dim>
double speed(const Bench<Dim>& bench) {
  return bench.grains()[velocity][0][0];
}
template <int Dim>
double rim_speed(const Bench<Dim>& bench) {
  return forward_spin(bench.grains()[spin][0]) * R;
}

template <int Dim>
void slides_then_rolls(const Body& body, ReferenceTable& table) {
  const double c = body.c;
  for (const double mu : {0.2, 0.6, 1.0}) {
    const double u0 = 0.1;
    const std::string name = "5 sliding " + body.name + ", µ = " + to_text(mu);
    // Until the slider slides the dashpot also acts and reduces the speed by about β µ g, which is
    // small for a stiff floor.
    auto bench = on_floor<Dim>(body, {.mu = mu, .theta = 0, .stiffness = 1e8}, u0);
    const double dt = bench.time_step();
    const double t_roll = u0 / (mu * g * (1 + 1 / c));
    bench.run(t_roll / 2, dt);
    table.add({name, "speed halfway to rolling [u0]", 1 - mu * g * bench.time() / u0,
               speed(bench) / u0, 0.01, 1});
    table.add(
        {name, "ω R there [u0]", mu * g * bench.time() / c / u0, rim_speed(bench) / u0, 0.01, 1});
    while (rim_speed(bench) < speed(bench)) bench.step(dt);
    table.add({name, "rolling begins at [s]", t_roll, bench.time(), 0.01});
    // Mean over the oscillation of the tangential spring.
    bench.run(2 * t_roll, dt);
    double u = 0, w = 0;
    const int samples = 4000;
    for (int i = 0; i < samples; ++i) {
      bench.step(dt);
      u += speed(bench) / samples;
      w += rim_speed(bench) / samples;
    }
    table.add({name, "speed of rolling [u0]", 1 / (1 + c), u / u0, 0.005, 1});
    table.add({name, "ω R of rolling [u0]", 1 / (1 + c), w / u0, 0.005, 1});
  }
}

template <int Dim>
void goes_downhill(const Body& body, ReferenceTable& table) {
  const double theta = 0.5;
  const double c = body.c;
  const double min_mu = std::tan(theta) / (1 + 1 / c);  // for rolling
  for (const double share : {0.5, 1.5}) {
    const double mu = share * min_mu;
    auto bench = on_floor<Dim>(body, {.mu = mu, .theta = theta}, 0);
    bench.run(0.2);
    const bool rolls = share > 1;
    const std::string name =
        "6 " + body.name + " on an incline of 0.5 rad, " + (rolls ? "rolling" : "slipping");
    const double a = rolls ? std::sin(theta) / (1 + c) : std::sin(theta) - mu * std::cos(theta);
    table.add({name, "acceleration [g]", a, speed(bench) / bench.time() / g, 0.01, 1});
    table.add({name, "angular acceleration times R [g]", rolls ? a : mu * std::cos(theta) / c,
               rim_speed(bench) / bench.time() / g, 0.01, 1});
  }
}

struct Rebound {
  double normal;
  double tangential;
  double rim;  // ω R, forward
};

template <int Dim>
Rebound oblique(const Body& body, const dem::CundallStrack& law, double vt, double vn) {
  Vec<Dim> v = Vec<Dim>::Zero();
  v[0] = vt;
  v[Dim - 1] = -vn;
  Bench<Dim> bench(one_grain<Dim>(Vec<Dim>((R + 1e-5) * Vec<Dim>::Unit(Dim - 1)), v,
                                  {.radius = R, .density = 2500, .shape = body.shape}),
                   {.law = law, .walls = {{.normal = Vec<Dim>::Unit(Dim - 1)}}});
  bench.through_contact(bench.time_step() / 10);
  return {bench.grains()[velocity][0][Dim - 1], speed(bench), rim_speed(bench)};
}

template <int Dim>
void slides_through_the_impact(const Body& body, ReferenceTable& table) {
  const double c = body.c;
  for (const double e : {1.0, 0.7}) {
    for (const double mu : {0.1, 0.3}) {
      const double vn = 1e-3;
      const double vt = 2 * (1 + 1 / c) * mu * (1 + e) * vn;  // twice the minimum for sliding
      const Rebound out = oblique<Dim>(body,
                                       {.normal_stiffness = 1e6,
                                        .tangential_stiffness = 8e5,
                                        .restitution = e,
                                        .friction_angle = std::atan(mu)},
                                       vt, vn);
      const double loss = mu * (1 + e);
      const std::string name = "7 " + body.name + " sliding through an impact, e = " + to_text(e) +
                               ", µ = " + to_text(mu);
      table.add({name, "normal velocity after the impact [v_n]", e, out.normal / vn, 0.005, 1});
      table.add({name, "tangential velocity lost [v_n]", loss, (vt - out.tangential) / vn, 0.01});
      table.add({name, "ω R gained [v_n]", loss / c, out.rim / vn, 0.01});
    }
  }
}

// The surface oscillates on the tangential spring with ω² = k_s (1 + 1/c)/m. With this k_s the
// contact lasts a quarter of this period: at its end the surface is at rest, as if it had stuck.
template <int Dim>
void sticks(const Body& body, ReferenceTable& table) {
  const double c = body.c;
  const double k = 1e6;
  const Rebound out = oblique<Dim>(
      body,
      {.normal_stiffness = k, .tangential_stiffness = k / 4 / (1 + 1 / c), .friction_angle = 1.5},
      1e-3, 1e-2);
  const std::string name = "8 " + body.name + " whose surface stops in the impact";
  table.add({name, "tangential velocity after the impact [v_t]", 1 / (1 + c), out.tangential / 1e-3,
             0.01, 1});
  table.add({name, "ω R behind it [v_t]", 1 / (1 + c), out.rim / 1e-3, 0.01, 1});
}

}  // namespace

void friction(ReferenceTable& table) {
  slides_then_rolls<2>(disc, table);
  slides_then_rolls<3>(sphere, table);
  goes_downhill<2>(disc, table);
  goes_downhill<2>(sphere_in_the_plane, table);
  goes_downhill<3>(sphere, table);
  slides_through_the_impact<2>(disc, table);
  slides_through_the_impact<3>(sphere, table);
  sticks<2>(disc, table);
  sticks<2>(sphere_in_the_plane, table);
  sticks<3>(sphere, table);
}

}  // namespace silt::test
