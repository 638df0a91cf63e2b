// SPDX-License-Identifier: MIT
// Flows of equal spheres for the DEM benchmarks:
//   bed     settled on a floor under gravity, between periodic sides
//   chute   the same, flowing down 26 degrees
//   gas     in motion, with a solid fraction of 0.3, periodic along all axes
//   discs   a bed in two dimensions
//
// Diameter, mass and gravity are 1. These, stiffness, damping, friction and time step are those of
// the chute in LAMMPS's own benchmarks.
#pragma once

#include "hooke_history.hpp"

#include <silt/dem.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

namespace bench {

using silt::Index;
using Vec3 = silt::Vec<3>;

inline constexpr double time_step = 1e-4;  // 50 steps per contact
inline constexpr double mass_density = 6 / std::numbers::pi;
inline constexpr HookeHistory hooke_history{
    .kn = 2e5, .kt = 2e5 * 2 / 7, .gamma_n = 50, .gamma_t = 25, .xmu = 0.5};

/// Silt's own law with the same springs, restitution and friction.
inline silt::dem::CundallStrack cundall_strack() {
  return {.normal_stiffness = hooke_history.kn,
          .tangential_stiffness = hooke_history.kt,
          .restitution = 0.88,
          .friction_angle = std::atan(hooke_history.xmu)};
}

enum class Scene { bed, gas, chute, discs };

inline std::string name_of(Scene scene) {
  constexpr std::array names{"bed", "gas", "chute", "discs"};
  return names[static_cast<std::size_t>(scene)];
}

inline Vec3 gravity_of(Scene scene) {
  const double slope = scene == Scene::chute ? 26 * std::numbers::pi / 180 : 0;
  if (scene == Scene::gas) return Vec3::Zero();
  return {std::sin(slope), 0, -std::cos(slope)};
}

/// Number of periodic axes, which are the first ones.
constexpr int periodic_axes(Scene scene) {
  return scene == Scene::gas ? 3 : scene == Scene::discs ? 1 : 2;
}

/// Discs move in the x–z plane.
struct Body {
  Vec3 x = Vec3::Zero(), v = Vec3::Zero(), w = Vec3::Zero();
  double diameter = 1;
};

struct State {
  std::vector<Body> bodies;
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
};

template <int Dim>
silt::Vec<Dim> components_of(const Vec3& a) {
  if constexpr (Dim == 2) return {a[0], a[2]};
  else return a;
}

/// The bodies as grains, between periodic sides along the first axes.
template <int Dim>
silt::dem::Grains<Dim> grains_of(const State& state, int periodic) {
  silt::Box<Dim> box;
  for (int k = 0; k < periodic; ++k) {
    box.lower[k] = state.lower[k];
    box.upper[k] = state.upper[k];
    box.periodic[static_cast<std::size_t>(k)] = true;
  }
  silt::dem::Grains<Dim> grains(box);
  grains.reserve(state.bodies.size());
  for (const auto& [x, v, w, diameter] : state.bodies) {
    const Index i = silt::dem::add_grain(
        grains, components_of<Dim>(x),
        {.radius = diameter / 2, .density = mass_density, .shape = silt::dem::Shape::sphere});
    grains[silt::velocity][i] = components_of<Dim>(v);
    if constexpr (Dim == 2) grains[silt::spin][i] = -w[1];
    else grains[silt::spin][i] = w;
  }
  return grains;
}

template <class Grains>
std::vector<Body> bodies_of(const Grains& grains) {
  std::vector<Body> bodies(grains.size());
  for (Index i = 0; i < grains.size(); ++i) {
    const auto x = grains.box().wrap(grains[silt::position][i]);
    const auto v = grains[silt::velocity][i];
    const auto w = grains[silt::spin][i];
    if constexpr (Grains::dimension == 2) {
      bodies[grains.id(i)] = {.x = {x[0], 0, x[1]}, .v = {v[0], 0, v[1]}, .w = {0, -w, 0}};
    } else {
      bodies[grains.id(i)] = {.x = x, .v = v, .w = w};
    }
    bodies[grains.id(i)].diameter = 2 * grains[silt::radius][i];
  }
  return bodies;
}

template <class Law>
constexpr silt::dem::ContactSettings settings_for() {
  using enum silt::dem::LeverArm;
  return {.lever_arm = std::is_same_v<Law, HookeHistory> ? radius : contact_point};
}

/// A simulation of a scene with a floor, or of the gas.
template <int Dim = 3, class Law, class Damping = silt::NoDamping>
auto on_floor(const State& state, Scene scene, Law law, Damping damping = {}) {
  using namespace silt;
  return Simulation{grains_of<Dim>(state, periodic_axes(scene)), NeighbourList<Dim>{},
                    Forces{Gravity<Dim>{components_of<Dim>(gravity_of(scene))},
                           dem::Contacts{law, dem::Plane<Dim>{}}.with(settings_for<Law>())},
                    Leapfrog{damping}};
}
template <class Law>
auto in_space(const State& state, Law law) {
  using namespace silt;
  return Simulation{grains_of<3>(state, periodic_axes(Scene::gas)), NeighbourList<3>{},
                    dem::Contacts{law}.with(settings_for<Law>()), Leapfrog{}};
}

/// The contact interaction of either kind of simulation.
template <class Interaction>
const auto& contacts_of(const Interaction& interaction) {
  if constexpr (requires { interaction.template part<1>(); }) {
    return interaction.template part<1>();
  } else {
    return interaction;
  }
}

}  // namespace bench
