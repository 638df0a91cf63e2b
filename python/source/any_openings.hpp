// SPDX-License-Identifier: MIT
// Openings of a flow, whose kinds are known to openings.cpp alone.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>

#include "any_simulation.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace silt::mps {

template <int Dim>
struct MovingFaces;

}  // namespace silt::mps

namespace silt::python {

/// What openings ask of a flow.
template <int Dim>
struct FlowBeforeStep {
  double time = 0;                      ///< [s]
  double spacing = 0;                   ///< [m]
  double density = 0;                   ///< [kg/m³]
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s²]
};

/// The openings of one flow, of any kind.
template <int Dim>
class AnyOpenings {
 public:
  virtual ~AnyOpenings() = default;

  virtual Index size() const = 0;
  /// Walls of the flow.
  virtual std::vector<mps::MovingFaces<Dim>> pistons() const = 0;
  /// FlowSettings::surface_pressure; empty if no opening has a pressure.
  virtual std::function<double(const Vec<Dim>&, double)> surface_pressure() const = 0;
  /// Adds and removes particles. Throws as they do.
  virtual void before_step(mps::Fluid<Dim>& fluid, const FlowBeforeStep<Dim>& flow) = 0;
  virtual void before_step(mps::FluidInMixture<Dim>& fluid, const FlowBeforeStep<Dim>& flow) = 0;
  virtual PassedOpening passed(Index opening) const = 0;
  /// Their state, for a checkpoint.
  virtual std::vector<double> numbers() const = 0;
  /// As many as numbers() has.
  virtual void set_numbers(const std::vector<double>& numbers) = 0;
};

/// The state of openings in a checkpoint.
struct OpeningsInFile {
  std::vector<double> numbers;

  template <class Archive>
  void transfer(Archive& archive) {
    const Index size = numbers.size();
    archive("openings", numbers);
    if (numbers.size() == size) return;
    fail(
        "Simulation.read_checkpoint: the file was written with other openings, or none; set up the "
        "same ones");
  }
};

}  // namespace silt::python
