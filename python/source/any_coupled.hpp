// SPDX-License-Identifier: MIT
// Grains in a fluid, as the Python module sees them: two simulations in one.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/drag.hpp>
#include <silt/coupled/fluid_forces.hpp>

#include "any_simulation.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silt::python {

/// A drag law, as Python names it.
struct NamedDrag {
  std::string_view name;
  double (*coefficient)(const coupled::GrainInFluid&);
};
inline constexpr NamedDrag drag_laws[] = {
    {"stokes", &coupled::StokesDrag::coefficient},
    {"schiller_naumann", &coupled::SchillerNaumann::coefficient},
    {"wen_yu", &coupled::WenYu::coefficient},
    {"ergun", &coupled::Ergun::coefficient},
    {"gidaspow", &coupled::GidaspowDrag::coefficient},
    {"di_felice", &coupled::DiFelice::coefficient},
};

/// A drag law that Python chooses; has the bits of the law that it is.
struct AnyDrag {
  bool is_named = false;
  std::uint64_t place = 0;  ///< in drag_laws, if it is named
  double linear = 0;        ///< otherwise β [kg/s], in 2D per metre of depth; 0: none

  bool is_none() const { return !is_named && linear == 0; }
  double coefficient(const coupled::GrainInFluid& at) const {
    return is_named ? drag_laws[place].coefficient(at) : linear;
  }
};

class AnyCoupled : public AnyAdvancing {
 public:
  static constexpr std::string_view class_name = "Coupled";  ///< in Python

  /// Those of coupled::CoupledEnergy that have a name in Python [J].
  virtual std::vector<std::pair<std::string, double>> energies() const = 0;
  /// See coupled::Coupled::let_fluid_settle().
  virtual double let_fluid_settle(double tolerance, int max_steps) = 0;
};

/// Two simulations in one, and its parts.
struct Joined {
  std::unique_ptr<AnyCoupled> both;
  std::unique_ptr<AnySimulation> grains, fluid;
};

/// How simulations are joined.
struct Joint {
  AnyDrag drag;
  coupled::FluidForceCoefficients coefficients;
  bool makes_room = false;  ///< see coupled::make_room()
};

/// From simulations that have made no step, which stay as they are. Throws if they do not fit.
template <int Dim>
Joined join(AnySimulation& grains, AnySimulation& fluid, const Joint& joint);

}  // namespace silt::python
