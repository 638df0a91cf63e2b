// SPDX-License-Identifier: MIT
// A step either succeeds or leaves everything as it was.
#pragma once

#include <silt/core/types.hpp>

#include <optional>
#include <utility>

namespace silt::detail {

/// A step of a simulation of particles P: unless it is committed, the simulation is rolled back to
/// what it was at save() when this object is destroyed.
template <class Simulation, class P>
class StepTransaction {
 public:
  explicit StepTransaction(Simulation& simulation) : simulation_(simulation) {}
  StepTransaction(const StepTransaction&) = delete;
  StepTransaction& operator=(const StepTransaction&) = delete;
  ~StepTransaction() {
    if (!is_committed_) roll_back();
  }

  void save() {
    simulation_.save();
    is_saved_ = true;
  }
  /// Removes particles, of which save() keeps nothing, and returns their number.
  template <class Removed>
  Index remove_if(Removed&& removed) {
    before_removal_ = simulation_.particles_;
    return simulation_.particles_.remove_if(removed);
  }
  void commit() noexcept { is_committed_ = true; }

 private:
  [[gnu::cold]] void roll_back() noexcept {
    if (before_removal_) simulation_.particles_ = std::move(*before_removal_);
    if (is_saved_) simulation_.restore();
  }

  Simulation& simulation_;
  std::optional<P> before_removal_;
  bool is_saved_ = false;
  bool is_committed_ = false;
};

}  // namespace silt::detail
