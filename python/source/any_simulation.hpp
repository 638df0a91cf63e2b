// SPDX-License-Identifier: MIT
// What the Python module sees of a simulation: the same interface for every dimension, contact law
// and kind of particles, so that only the functions that make simulations are templates, each
// compiled in a file of its own.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/run.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_walls.hpp>
#include <silt/measure/front.hpp>

#include "any_wall.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace silt::python {

/// A field of the particles of a simulation.
struct FieldInfo {
  std::string name;
  std::string number;  ///< type of its numbers, named as in VTK: Float64, UInt32, …
  int components = 0;  ///< of a vector; 0: one number per particle
};

/// Where the values of a field lie: value i begins i × `stride` bytes after `first`.
struct ColumnMemory {
  FieldInfo field;
  std::byte* first = nullptr;
  Index size = 0;
  std::ptrdiff_t stride = 0;  ///< [bytes]
};

/// A copy of the values of a field, one after the other.
struct ColumnCopy {
  FieldInfo field;
  Index size = 0;
  std::vector<std::byte> bytes;
};

/// Force [N] and torque about the origin [N m], which has one component in 2D.
struct Load {
  std::vector<double> force;
  std::vector<double> torque;
};
template <int Dim, class ForceAndTorque>
Load load_of(const ForceAndTorque& load) {
  Load result{{load.force.begin(), load.force.end()}, {}};
  if constexpr (Dim == 2) {
    result.torque = {load.torque};
  } else {
    result.torque.assign(load.torque.begin(), load.torque.end());
  }
  return result;
}

/// What has passed an opening of a flow so far.
struct PassedOpening {
  std::uint64_t added = 0, removed = 0;  ///< particles
  double volume = 0;                     ///< of those added less those removed [m³], in 2D [m²]
};

/// What a run calls, without the lock of the interpreter.
class Hooks {
 public:
  virtual ~Hooks() = default;
  virtual void make_output() = 0;
  virtual bool stop_requested() = 0;
};

/// What makes steps: a simulation, or two in one.
class AnyAdvancing {
 public:
  virtual ~AnyAdvancing() = default;

  virtual int dimension() const = 0;
  virtual double time() const = 0;
  virtual std::uint64_t steps() const = 0;
  virtual double last_time_step() const = 0;

  virtual double time_step() = 0;
  virtual void step() = 0;
  virtual void step(double dt) = 0;
  /// False if the hooks ended it.
  virtual bool run(const Run& run, Hooks& hooks) = 0;

  virtual void write_frame(VtkSeries& frames) const = 0;
  virtual void write_checkpoint(const std::filesystem::path& path) const = 0;
  /// Throws if the file is of another set-up, unless that is accepted.
  virtual void read_checkpoint(const CheckpointToRead& from) = 0;

 protected:
  AnyAdvancing() = default;
  AnyAdvancing(const AnyAdvancing&) = default;
  AnyAdvancing& operator=(const AnyAdvancing&) = default;
};

class AnySimulation : public AnyAdvancing {
 public:
  static constexpr std::string_view class_name = "Simulation";  ///< in Python

  virtual Index size() const = 0;
  virtual std::uint64_t particles_lost() const = 0;
  virtual std::span<const Id> ids() const = 0;

  virtual std::vector<FieldInfo> fields() const = 0;
  /// By access that is not const if it is written to, which caches of the simulation notice. Throws
  /// if there is no such field.
  virtual ColumnMemory column(std::string_view name, bool is_written) = 0;
  /// All fields and the ids, at time(), in the order of the ids.
  virtual std::vector<ColumnCopy> snapshot() const = 0;

  virtual void remove(const std::vector<Id>& ids) = 0;

  /// Energies by name [J], in 2D per metre of thickness.
  virtual std::vector<std::pair<std::string, double>> energies() const = 0;

  // Of grains; others throw.
  virtual void set_wall_present(Index wall, bool present) {
    no_grains("set_wall_present", wall, present);
  }
  virtual bool is_wall_present(Index wall) const { return no_grains("is_wall_present", wall); }

  /// On a wall of grains, or a moving wall of a flow.
  virtual Load wall_load(Index wall) const = 0;

  // Of flows; others throw.
  virtual Index body_count() const { return no_flow("bodies"), 0; }
  /// See state_of_body().
  virtual std::vector<double> body_state(Index body) const {
    return no_flow("bodies", body), std::vector<double>{};
  }
  /// Its torque is about the centre of mass.
  virtual Load body_load(Index body) const { return no_flow("body_load", body), Load{}; }
  virtual Index opening_count() const { return no_flow("openings"), 0; }
  virtual PassedOpening passed_opening(Index opening) const {
    return no_flow("openings", opening), PassedOpening{};
  }
  virtual void write_walls(VtkWalls& frames) const { no_flow("VtkWalls", frames); }
  virtual Front front() const { return no_flow("front"), Front{}; }
  virtual double wall_pressure(const std::vector<double>& point,
                               const std::vector<double>& normal) const {
    return no_flow("wall_pressure", point, normal), 0;
  }

 private:
  template <class... Arguments>
  [[noreturn]] static bool no_grains(const std::string& name, const Arguments&...) {
    fail("Simulation." + name + ": this simulation is a flow; only grains have it");
  }
  template <class... Arguments>
  [[noreturn]] static bool no_flow(const std::string& name, const Arguments&...) {
    fail("Simulation." + name + ": this simulation is one of grains; only flows have it");
  }
};

/// Numbers of an array with `columns` numbers per row.
struct Rows {
  std::vector<double> numbers;
  Index columns = 0;

  Index size() const { return columns == 0 ? 0 : numbers.size() / columns; }
  template <int Dim>
  Vec<Dim> vector(Index row) const {
    return Eigen::Map<const Vec<Dim>>(numbers.data() + row * columns);
  }
};

/// Of Dim numbers. Throws if there are others. `name` is that of the argument.
template <int Dim>
Vec<Dim> to_vector(const std::string& name, const std::vector<double>& numbers) {
  if (numbers.size() != Dim) {
    fail(name + " has " + std::to_string(numbers.size()) + " components; in " +
         std::to_string(Dim) + "D give " + std::to_string(Dim));
  }
  return Eigen::Map<const Vec<Dim>>(numbers.data());
}

using LinearLaw = dem::Law<dem::LinearSpringDashpot, dem::LinearFriction>;
using HertzMindlin = dem::Law<dem::Hertz, dem::Mindlin>;
/// A contact law of Python.
using ContactLaw = std::variant<dem::CundallStrack, LinearLaw, HertzMindlin>;

/// A simulation of grains. Arrays have a row for each grain.
template <int Dim>
struct GrainSetup {
  Rows positions;                 ///< [m]
  Rows velocities;                ///< [m/s]
  std::vector<double> radii;      ///< [m]
  std::vector<double> densities;  ///< [kg/m³]
  ContactLaw law;
  std::vector<AnyWall<Dim>> walls;
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s²]
  double damping = 0;                   ///< global [1/s]
  Box<Dim> box;                         ///< [m]
  dem::ContactSettings settings;

  GrainSetup without_grains() const {
    GrainSetup rest = *this;
    rest.positions = rest.velocities = {};
    rest.radii = rest.densities = {};
    return rest;
  }
};

/// What a simulation was made from, but for its particles.
template <class Setup>
class MadeFrom {
 public:
  explicit MadeFrom(Setup setup) : setup_(std::move(setup)) {}
  virtual ~MadeFrom() = default;
  const Setup& setup() const { return setup_; }

 private:
  Setup setup_;
};

/// Walls of a simulation of grains: places for more take time.
inline constexpr Index max_walls = 8;

/// With this law, that of the set-up. Throws if a number is out of range.
template <int Dim, class Law>
std::unique_ptr<AnySimulation> make_grain_simulation(const GrainSetup<Dim>& setup, const Law& law);

}  // namespace silt::python
