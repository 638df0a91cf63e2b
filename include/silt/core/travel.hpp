// SPDX-License-Identifier: MIT
// How far particles have gone since somebody looked, without looking at each.
#pragma once

#include <atomic>
#include <concepts>
#include <cstdint>

namespace silt {

/// A number that no other object of the process has; a copy gets one of its own.
class Journey {
 public:
  Journey() : number_(++last()) {}
  Journey(const Journey&) : Journey() {}
  Journey& operator=(const Journey&) {
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

/// Of one journey: while `distance` [m] has grown by less than d, no particle has moved by d.
struct Travel {
  std::uint64_t journey = 0;
  double distance = 0;

  /// At most so far since `then`; nothing is known of another journey.
  bool is_within(double d, const Travel& then) const noexcept {
    return journey == then.journey && distance - then.distance <= d;
  }
};

/// Knows how far particles have gone: search.travel(), as long as particles.revision() stays.
template <class S>
concept KnowsTravel = requires(const S s) {
  { s.travel() } -> std::same_as<Travel>;
};

}  // namespace silt
