// SPDX-License-Identifier: MIT
// A flow with a known solution: initial state, recorded quantities, and comparison with the
// solution. Used by the program fluid_cases and by the tests.
#pragma once

#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include "../findings.hpp"
#include "../history.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace fluid_cases {

using namespace silt;

using support::Finding;
using support::History;
using support::stated;

/// A flow in 2D with a known solution.
struct FluidCase {
  std::string name;
  mps::Fluid<2> start = {};
  std::vector<Face<2>> walls = {};  ///< for schemes with walls of faces
  /// Position [m] and kind, for the other schemes.
  std::vector<std::pair<Vec<2>, mps::Kind>> wall_particles = {};
  double spacing = 0;       ///< l0 [m]
  double viscosity = 0;     ///< ν [m²/s]
  double speed_scale = 0;   ///< [m/s]
  Vec<2> gravity = Vec<2>::Zero();                ///< [m/s²]
  std::function<Vec<2>(const Vec<2>&, double)> body_force = {};  ///< at x [m], t [s]: [m/s²]
  bool clip_negative_pressure = true;
  bool has_surface = true;  ///< whether there is a free surface
  double until = 0;         ///< [s]
  double note_every = 0;    ///< time between rows of the history [s]; 0: every step
  std::vector<std::string> names = {};  ///< of the history's columns
  /// A row of the history.
  std::function<std::vector<double>(const mps::Fluid<2>&, double time)> note = {};
  std::function<std::vector<Finding>(const History&)> findings = {};
};

inline constexpr double density = 1000;  ///< ρ in every case [kg/m³]

/// Numerical parameters, which do not depend on the case.
struct Numerics {
  double radius = 3.1;  ///< effective radius of number density, gradient, divergence [spacings]
  double laplacian_radius = 3.1;  ///< effective radius of the Laplacian [spacings]
  double courant = 0.2;           ///< [-]
};

/// The simulation of a case with a scheme.
template <class Scheme>
auto simulation_of(const FluidCase& flow, const Numerics& numerics) {
  mps::FlowSettings<2, Scheme> settings{
      .spacing = flow.spacing,
      .density = density,
      .viscosity = flow.viscosity,
      .gravity = flow.gravity,
      .radius = numerics.radius,
      .laplacian_radius = numerics.laplacian_radius,
      .courant = numerics.courant,
      .speed_scale = flow.speed_scale,
      .clip_negative_pressure = flow.clip_negative_pressure,
      .body_force = flow.body_force};
  auto start = flow.start;
  if constexpr (std::derived_from<mps::WallsOf<Scheme>, mps::ImageWalls>) {
    settings.walls.segments = flow.walls;
    settings.walls.let_fluid_fall = flow.walls.empty();
  } else {
    for (const auto& [x, kind] : flow.wall_particles) mps::add_particle(start, x, kind);
  }
  if (!flow.has_surface) settings = mps::without_free_surface(settings);
  return Simulation{std::move(start), TimedSearch{UniformGrid<2>{}},
                    mps::Flow<Scheme>{settings}, SemiImplicit<>{}};
}

/// Observer that records a row of the history at the beginning and at the first step that reaches
/// each multiple of note_every, and calls on_row(row).
class Notes {
 public:
  using OnRow = std::function<void(const std::vector<double>&)>;
  explicit Notes(const FluidCase& flow, OnRow on_row = [](const std::vector<double>&) {})
      : flow_(&flow), on_row_(std::move(on_row)), history_(flow.names) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) add(simulation);
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    if (simulation.time() * (1 + 1e-12) >= next_) add(simulation);
  }

  template <class Archive>
  void transfer(Archive& archive) {
    history_.transfer(archive);
    archive("next", next_);
  }

  const History& history() const { return history_; }

 private:
  template <class Sim>
  void add(const Sim& simulation) {
    const auto row = flow_->note(simulation.particles(), simulation.time());
    history_.add(row);
    on_row_(row);
    while (next_ <= simulation.time() && flow_->note_every > 0) next_ += flow_->note_every;
  }

  const FluidCase* flow_;
  OnRow on_row_;
  History history_;
  double next_ = 0;  // [s]
};

}  // namespace fluid_cases
