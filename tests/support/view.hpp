// SPDX-License-Identifier: MIT
// A view of a particle with given numbers, as input of sources and shifting models.
#pragma once

#include <silt/core/types.hpp>

#include <array>

namespace silt::test {

struct ViewOf {
  struct Numbers {
    double density = 1000;    // [kg/m³]
    double time_step = 1e-3;  // [s]
    double compression = 0;
    double divergence = 0;    // [1/s]
    double density_rate = 0;  // [1/s]
    bool near_boundary = false;
    Vec<2> concentration_gradient = {0, 0};
    double max_relative_speed = 0;  // [m/s]
    double spacing = 1;             // [m]
  };
  using Real = double;
  using Vec = silt::Vec<2>;

  Numbers numbers;

  Index index() const { return 0; }
  double density() const { return numbers.density; }
  double time_step() const { return numbers.time_step; }
  double compression() const { return numbers.compression; }
  double divergence() const { return numbers.divergence; }
  double density_rate() const { return numbers.density_rate; }
  bool near_boundary() const { return numbers.near_boundary; }
  Vec concentration_gradient() const { return numbers.concentration_gradient; }
  double max_relative_speed() const { return numbers.max_relative_speed; }
  double bulk_volume() const { return 1; }
  double spacing() const { return numbers.spacing; }
};

/// A step of a single particle.
struct StepOf {
  std::array<int, 1> particles = {};
  ViewOf::Numbers numbers;

  ViewOf at(Index) const { return {numbers}; }
};

}  // namespace silt::test
