// SPDX-License-Identifier: MIT
// Random grain radii: equal, uniform, lognormal, or from a sieve analysis. A distribution is a
// struct with
//   radius(random)   → [m], drawn from a Random
//   largest()        → [m], upper bound of the radii
//   check()          throws if the distribution is invalid
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/random.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// Has
///
///   radius(random)   → [m], drawn from a Random
///   largest()        → [m], upper bound of the radii
///   check()          throws if the distribution is invalid
/// Models: EqualSizes, UniformSizes, LognormalSizes, SieveSizes.
template <class S>
concept SizeDistribution = requires(const S sizes, Random random) {
  { sizes.radius(random) } -> std::convertible_to<double>;
  { sizes.largest() } -> std::convertible_to<double>;
  sizes.check();
};

namespace detail {
inline void check_sizes(const std::string& name, const Range& radii) {
  // The powers of radii in volumes and masses must be finite.
  constexpr Range allowed{1e-100, 1e100};
  require_positive(name + ": min_radius", radii.lower);
  require_between(name + ": min_radius", radii.lower, allowed);
  require_between(name + ": max_radius", radii.upper, allowed);
  if (radii.lower > radii.upper) {
    fail({name, ": min_radius = ", radii.lower, " m is above max_radius = ", radii.upper,
          " m; swap them"});
  }
}
}  // namespace detail

/// One radius for all grains.
struct EqualSizes {
  double value = 0;  ///< R [m], above 0

  void check() const { require_positive("EqualSizes: value", value); }
  double radius(Random&) const { return value; }
  double largest() const { return value; }
};

/// Radii distributed uniformly (by number) between two limits.
struct UniformSizes {
  double min_radius = 0;  ///< [m], above 0
  double max_radius = 0;  ///< [m]

  void check() const { detail::check_sizes("UniformSizes", {min_radius, max_radius}); }
  double radius(Random& random) const { return random.uniform({min_radius, max_radius}); }
  double largest() const { return max_radius; }
};

/// Lognormal distribution of the radii, truncated at both ends.
struct LognormalSizes {
  double median = 0;      ///< of the radii before truncation [m]
  double deviation = 0;   ///< standard deviation σ of ln R [-]
  double min_radius = 0;  ///< [m], above 0
  double max_radius = 0;  ///< [m]

  /// Also throws if less than a hundredth of the distribution remains after truncation.
  void check() const {
    detail::check_sizes("LognormalSizes", {min_radius, max_radius});
    require_positive("LognormalSizes: median", median);
    require_positive("LognormalSizes: deviation", deviation);
    const double left = share_below(max_radius) - share_below(min_radius);
    if (!(left >= 0.01)) {  // also for NaN
      fail({"LognormalSizes: only ", left, " of all grains of median = ", median,
            " m and deviation = ", deviation, " have radii from min_radius = ", min_radius,
            " to max_radius = ", max_radius,
            " m; widen these limits, or choose a median between them"});
    }
  }
  double radius(Random& random) const {
    while (true) {
      const double R = median * std::exp(deviation * random.normal());
      if (min_radius <= R && R <= max_radius) return R;
    }
  }
  double largest() const { return max_radius; }

  /// Fraction of the grains with a radius below R, before truncation [-].
  double share_below(double R) const {
    return std::erfc(-std::log(R / median) / (deviation * std::sqrt(2.0))) / 2;
  }
};

/// Result of a sieve analysis: mass fractions between pairs of openings.
class SieveSizes {
 public:
  /// Grains with radii distributed uniformly (by number) between two limits.
  struct Fraction {
    double min_radius = 0;  ///< [m], above 0
    double max_radius = 0;  ///< [m]
    double mass = 0;        ///< mass of the fraction [any unit, the same for all]; not below 0
  };

  struct Settings {
    int power = 3;  ///< power of the radius in a grain's mass: 3 for spheres, 2 for discs
  };

  /// Throws if a fraction is invalid, if all masses are 0, or if the power is neither 2 nor 3.
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
    require_positive("SieveSizes: number of grains for these masses", grains);
    for (double& share : up_to_) share /= grains;
  }

  void check() const {
    double mass = 0;
    for (const Fraction& each : fractions_) {
      detail::check_sizes("SieveSizes", {each.min_radius, each.max_radius});
      require_not_negative("SieveSizes: mass", each.mass);
      require_between("SieveSizes: mass", each.mass, {0, 1e100});
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
  // Mean of R^power for radii uniform from a to b: Σ a^k b^(power−k) / (power + 1).
  double mean_volume(const Fraction& fraction) const {
    double sum = 0;
    for (int k = 0; k <= power_; ++k) {
      sum += std::pow(fraction.min_radius, k) * std::pow(fraction.max_radius, power_ - k);
    }
    return sum / (power_ + 1);
  }

  std::vector<Fraction> fractions_;
  int power_;
  std::vector<double> up_to_;  // cumulative number fraction of the grains
};

/// Grains of one material with a distribution of sizes.
template <SizeDistribution Sizes>
struct Blend {
  Sizes sizes;
  double density = 0;            ///< ρ of the grains' material [kg/m³], above 0
  Shape shape = Shape::natural;  ///< see Grain
  Index material = 0;            ///< in dem::Materials, below 2³²

  /// Throws if sizes or density are out of range.
  void check() const {
    sizes.check();
    require_positive("Blend: density", density);
  }
  /// Throws if the distribution returns a radius that cannot be.
  Grain draw(Random& random) const {
    const double R = sizes.radius(random);
    if (!is_finite(R) || !(R > 0)) {
      fail({"Blend: radius(random) of the distribution of sizes returned ", R,
            " m; correct it to return positive and finite radii"});
    }
    return {.radius = R, .density = density, .shape = shape, .material = material};
  }
  /// The largest radius [m].
  double largest() const { return sizes.largest(); }
};

/// What Inflow and scatter() put among grains: a Blend, or clumps, see ClumpBlend. It has check(),
/// largest(), the largest radius [m], and draw(random), a grain or clump with its `radius` [m].
template <class B>
concept DrawsGrains = requires(const B blend, Random& random) {
  blend.check();
  { blend.largest() } -> std::convertible_to<double>;
  { blend.draw(random).radius } -> std::convertible_to<double>;
};

namespace detail {
template <class Sizes>
struct BlendFor {
  using type = Sizes;
};
template <SizeDistribution Sizes>
struct BlendFor<Sizes> {
  using type = Blend<Sizes>;
};
}  // namespace detail

}  // namespace silt::dem
