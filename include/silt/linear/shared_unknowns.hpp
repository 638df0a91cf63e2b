// SPDX-License-Identifier: MIT
// The unknowns of a linear system that several processes share: every process has the rows of its own
// unknowns; the columns of others come after its own.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace silt {

/// To be called by all processes in the same order. Reductions throw in all if one has failed.
struct SharedUnknowns {
  /// Sets the elements of x, one for each column, that are of others. To be called after a reduction,
  /// so that no process fails before it.
  std::function<void(std::vector<double>& x)> refresh;
  /// Reductions: replace each value by the sum, or the largest, of those of all processes.
  std::function<void(std::span<double> values)> sum, largest;
  /// What the processes are, for solvers that use another library: of particles that
  /// mpi::distribute() has made, the mpi::World.
  const void* processes = nullptr;
};

}  // namespace silt
