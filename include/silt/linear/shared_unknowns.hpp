// SPDX-License-Identifier: MIT
// The unknowns of a linear system that several processes share: every process has the rows of its own
// unknowns; the columns of others come after its own.
#pragma once

#include <silt/core/types.hpp>

#include <span>
#include <vector>

namespace silt {

class SharedUnknowns {
 public:
  virtual ~SharedUnknowns() = default;

  // To be called by all processes in the same order. They throw in all if one has failed.

  /// Sets the elements of x, one for each column, that are of others.
  virtual void refresh(std::vector<double>& x) const = 0;
  /// Replaces each value by the sum of those of all processes.
  virtual void sum(std::span<double> values) const = 0;
  /// By the largest.
  virtual void largest(std::span<double> values) const = 0;
  /// What the processes are, for solvers that use another library: of particles that
  /// mpi::distribute() has made, the mpi::World.
  virtual const void* processes() const = 0;
};

}  // namespace silt
