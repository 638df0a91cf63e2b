// SPDX-License-Identifier: MIT
// An upper bound for the displacement of all particles since an earlier time, without a loop over
// the particles.
#pragma once

#include <atomic>
#include <concepts>
#include <cstdint>

namespace silt {

/// A number that is unique in the process; a copy gets a new one.
class Epoch {
 public:
  Epoch() : number_(++last()) {}
  Epoch(const Epoch&) : Epoch() {}
  Epoch& operator=(const Epoch&) {
    number_ = ++last();
    return *this;
  }
  std::uint64_t number() const noexcept { return number_; }

 private:
  static std::atomic<std::uint64_t>& last() noexcept {
    static std::atomic<std::uint64_t> number = 0;
    return number;
  }
  std::uint64_t number_;
};

/// Sum of the maximum displacements of all steps since the last reset, which began the epoch: while
/// `distance` [m] has increased by less than d, no particle has moved by d.
struct Travel {
  std::uint64_t epoch = 0;
  double distance = 0;

  /// Whether no particle has moved farther than d [m] since `then`; false if `then` belongs to
  /// another epoch.
  bool is_within(double d, const Travel& then) const noexcept {
    return epoch == then.epoch && distance - then.distance <= d;
  }
};

/// The search has travel(), which is valid while particles.revision() is unchanged.
template <class S>
concept HasTravel = requires(const S s) {
  { s.travel() } -> std::same_as<Travel>;
};

}  // namespace silt
