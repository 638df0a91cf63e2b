// SPDX-License-Identifier: MIT
// Radii of grains by chance: equal, uniform, lognormal, or by a table of sieves. A distribution is
// a struct with
//   radius(random)   → [m], drawn from a Random
//   largest()        → [m]; no radius is above it
//   check()          throws if it is none
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

template <class S>
concept SizeDistribution = requires(const S sizes, Random random) {
  { sizes.radius(random) } -> std::convertible_to<double>;
  { sizes.largest() } -> std::convertible_to<double>;
  sizes.check();
};

namespace detail {
inline void check_sizes(const std::string& name, const Range& radii) {
  require_positive(name + ": smallest", radii.lower);
  require_finite(name + ": largest", radii.upper);
  if (radii.lower > radii.upper) {
    fail(name + ": smallest = " + to_text(radii.lower) + " m is above largest = " +
         to_text(radii.upper) + " m; exchange them");
  }
}
}  // namespace detail

/// All alike.
struct EqualSizes {
  double value = 0;  ///< R [m], above 0

  void check() const { require_positive("EqualSizes: value", value); }
  double radius(Random&) const { return value; }
  double largest() const { return value; }
};

/// As many of every radius between two.
struct UniformSizes {
  double min_radius = 0;  ///< [m], above 0
  double max_radius = 0;   ///< [m]

  void check() const { detail::check_sizes("UniformSizes", {min_radius, max_radius}); }
  double radius(Random& random) const { return random.uniform({min_radius, max_radius}); }
  double largest() const { return max_radius; }
};

/// Radii whose logarithm is normal, without those below the smallest and above the largest.
struct LognormalSizes {
  double median = 0;           ///< of the radii, before the ends are cut off [m]
  double deviation = 0;        ///< standard deviation σ of ln R [-]
  double min_radius = 0;  ///< [m], above 0
  double max_radius = 0;   ///< [m]

  /// Throws, too, if the ends leave less than a hundredth of the distribution.
  void check() const {
    detail::check_sizes("LognormalSizes", {min_radius, max_radius});
    require_positive("LognormalSizes: median", median);
    require_positive("LognormalSizes: deviation", deviation);
    const double left = share_below(max_radius) - share_below(min_radius);
    if (left < 0.01) {
      fail("LognormalSizes: only " + to_text(left) + " of all grains have radii from " +
           to_text(min_radius) + " to " + to_text(max_radius) +
           " m; move the ends apart, or the median between them");
    }
  }
  double radius(Random& random) const {
    while (true) {
      const double R = median * std::exp(deviation * random.normal());
      if (min_radius <= R && R <= max_radius) return R;
    }
  }
  double largest() const { return max_radius; }

  /// Share of the grains with a radius below R before the ends are cut off [-].
  double share_below(double R) const {
    return std::erfc(-std::log(R / median) / (deviation * std::sqrt(2.0))) / 2;
  }
};

/// What a pile of sieves holds back: mass fractions between two openings each.
class SieveSizes {
 public:
  /// As many grains of every radius between the two as the mass fraction takes.
  struct Fraction {
    double min_radius = 0;  ///< [m], above 0
    double max_radius = 0;   ///< [m]
    double mass = 0;             ///< share of the mass, in any unit; not below 0
  };

  struct Settings {
    int power = 3;  ///< of the radius that a grain's mass grows with: 3 for spheres, 2 for discs
  };

  /// Throws if a fraction is none, if all masses are 0, or if the power is neither 2 nor 3.
  explicit SieveSizes(std::vector<Fraction> fractions) : SieveSizes(std::move(fractions), {}) {}
  SieveSizes(std::vector<Fraction> fractions, const Settings& settings)
      : fractions_(std::move(fractions)), power_(settings.power) {
    require_between("SieveSizes: power", power_, {2, 3});
    check();
    double grains = 0;
    for (const Fraction& each : fractions_) {
      grains += each.mass / mean_volume(each);
      up_to_.push_back(grains);
    }
    for (double& share : up_to_) share /= grains;
  }

  void check() const {
    double mass = 0;
    for (const Fraction& each : fractions_) {
      detail::check_sizes("SieveSizes", {each.min_radius, each.max_radius});
      require_not_negative("SieveSizes: mass", each.mass);
      mass += each.mass;
    }
    require_positive("SieveSizes: mass of all fractions", mass);
  }
  double radius(Random& random) const {
    const double place = random.uniform();
    Index k = 0;
    while (k + 1 < up_to_.size() && place >= up_to_[k]) ++k;
    return random.uniform({fractions_[k].min_radius, fractions_[k].max_radius});
  }
  double largest() const {
    double most = 0;
    for (const Fraction& each : fractions_) {
      if (each.mass > 0) most = std::max(most, each.max_radius);
    }
    return most;
  }

 private:
  // Mean of R^power over radii that are uniform from a to b: Σ a^k b^(power−k) / (power + 1).
  double mean_volume(const Fraction& fraction) const {
    double sum = 0;
    for (int k = 0; k <= power_; ++k) {
      sum += std::pow(fraction.min_radius, k) * std::pow(fraction.max_radius, power_ - k);
    }
    return sum / (power_ + 1);
  }

  std::vector<Fraction> fractions_;
  int power_;
  std::vector<double> up_to_;  // share of the grains in this fraction and those before
};

/// Grains of one substance in many sizes.
template <SizeDistribution Sizes>
struct Blend {
  Sizes sizes;
  double density = 0;            ///< ρ of the grains themselves [kg/m³], above 0
  Shape shape = Shape::natural;  ///< see Grain
  std::uint32_t material = 0;    ///< place in dem::Materials

  /// Throws if sizes or density are out of range.
  void check() const {
    sizes.check();
    require_positive("Blend: density", density);
  }
  Grain draw(Random& random) const {
    return {.radius = sizes.radius(random), .density = density, .shape = shape,
            .material = material};
  }
};

}  // namespace silt::dem
