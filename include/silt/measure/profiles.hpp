// SPDX-License-Identifier: MIT
// Profiles over height, averaged over time: solid fraction, mean velocity and velocity fluctuations
// (granular temperature) of horizontal slices.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/measure/block_sums.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace silt {

/// Volume of a sphere of radius R [m] below the height `height` [m] above its centre [m³].
inline double sphere_volume_below(double R, double height) {
  const double h = std::clamp(height, -R, R);
  return std::numbers::pi * (R * R * h - h * h * h / 3 + R * R * R * 2 / 3);
}
/// Area of a disc of radius R [m] below the height `height` [m] above its centre [m²].
inline double disc_area_below(double R, double height) {
  const double h = std::clamp(height, -R, R);
  return h * std::sqrt(R * R - h * h) + R * R * (std::asin(h / R) + std::numbers::pi / 2);
}

/// Slices of equal thickness between two heights, along the last axis.
struct Slices {
  double lower = 0;          ///< [m]
  double upper = 0;          ///< greater than lower [m]
  Index count = 0;           ///< from 1 to 1e6
  double cross_section = 0;  ///< horizontal area of the bed [m²]; in 2D its width [m]

  void check() const {
    require_finite("Slices: lower", lower);
    require_finite("Slices: upper", upper);
    require_positive("Slices: upper - lower", upper - lower);
    require_between("Slices: count", double(count), {1, 1e6});
    require_positive("Slices: cross_section", cross_section);
    const double volume = cross_section * thickness();
    if (!is_positive_normal(volume)) {
      fail({"Slices: lower = ", lower, " m, upper = ", upper,
            " m and cross_section = ", cross_section, " m² give slices of ", volume,
            " m³, which is beyond the range of normal numbers; change them"});
    }
  }
  /// Thickness of a slice [m].
  double thickness() const { return (upper - lower) / double(count); }
};

/// Averages in one slice.
template <int Dim>
struct ProfileRow {
  double height = 0;        ///< of the middle of the slice [m]
  Estimate solid_fraction;  ///< fraction of the volume (2D: area) inside grains [-]
  std::array<Estimate, Dim> velocity;  ///< mean flow ⟨v_k⟩ [m/s]
  /// ⟨v_k'²⟩, where v' = v − ⟨v⟩ and ⟨v⟩ is the mean flow over all samples [m²/s²].
  std::array<Estimate, Dim> component;
  Estimate temperature;  ///< ⟨v'²⟩/Dim [m²/s²]
};

/// An observer that takes a sample whenever it is called. A grain is weighted in a slice with the
/// exact volume that it has there; averages are weighted by mass. In 2D grains are discs. In slices
/// that were always empty, velocities and temperatures are NaN.
template <int Dim>
class Profiles {
 public:
  /// Throws if a member of `slices` is out of range.
  explicit Profiles(const Slices& slices)
      : slices_((slices.check(), slices)),
        sample_(slices.count * numbers),
        sums_(slices.count * numbers) {}

  template <class Sim>
    requires requires(const Sim sim) { sim.snapshot(); }
  void operator()(const Sim& simulation) {
    add(simulation.snapshot());
  }

  /// Adds a sample. Positions and velocities must belong to the same time.
  template <class P>
    requires HasFields<P, velocity_t, mass_t, radius_t>
  void add(const P& grains) {
    static_assert(P::dimension == Dim, "silt::Profiles: the grains have another dimension");
    std::fill(sample_.begin(), sample_.end(), 0.0);
    const auto& box = grains.box();
    const bool periodic = box.periodic[up];
    for (Index i = 0; i < grains.size(); ++i) {
      const double height = double(grains[position][i][up]);
      add_grain(grains, i, height);
      if (!periodic) continue;
      const double side = double(box.upper[up] - box.lower[up]);
      add_grain(grains, i, height - side);
      add_grain(grains, i, height + side);
    }
    silt::detail::replace_by_sums(grains, sample_);
    sums_.add(sample_);
  }

  /// Writes or reads the samples for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    sums_.transfer(archive);
  }

  /// Number of samples so far.
  Index samples() const noexcept { return sums_.samples(); }
  const Slices& slices() const noexcept { return slices_; }

  /// f(fractions) with its standard error; fractions is a span of the mean solid fractions of all
  /// slices, from the lowest up.
  template <class F>
  Estimate of_solid_fractions(F&& f) const {
    std::vector<double> fractions(slices_.count);
    return sums_.estimate([&](Means means) {
      for (Index s = 0; s < slices_.count; ++s) fractions[s] = means[s * numbers + volume];
      return f(std::span<const double>(fractions));
    });
  }

  /// One row for each slice, from the lowest up. Throws if there are no samples.
  std::vector<ProfileRow<Dim>> rows() const {
    if (samples() == 0) fail("Profiles: there are 0 samples; call it with a simulation first");
    std::vector<ProfileRow<Dim>> rows(slices_.count);
    for (Index s = 0; s < slices_.count; ++s) {
      auto& row = rows[s];
      const Index first = s * numbers;
      row.height = slices_.lower + (double(s) + 0.5) * slices_.thickness();
      row.solid_fraction = sums_.mean(first + volume);
      for (int k = 0; k < Dim; ++k) {
        row.velocity[Index(k)] =
            sums_.estimate([=](Means means) { return mean_flow(means, first, k); });
        row.component[Index(k)] =
            sums_.estimate([=](Means means) { return fluctuation(means, first, k); });
      }
      row.temperature = sums_.estimate([=](Means means) {
        double sum = 0;
        for (int k = 0; k < Dim; ++k) sum += fluctuation(means, first, k);
        return sum / Dim;
      });
    }
    return rows;
  }

 private:
  using Means = std::span<const double>;
  static constexpr Index up = Dim - 1;
  // Values per slice: solid fraction, mass, momentum, twice the kinetic energy by axis.
  static constexpr Index volume = 0;
  static constexpr Index weight = 1;
  static constexpr Index flow = 2;
  static constexpr Index square = flow + Dim;
  static constexpr Index numbers = square + Dim;

  static double mean_flow(Means means, Index first, int k) {
    const double m = means[first + weight];
    if (!(m > 0)) return std::numeric_limits<double>::quiet_NaN();
    return means[first + flow + Index(k)] / m;
  }
  static double fluctuation(Means means, Index first, int k) {
    const double v = mean_flow(means, first, k);
    return means[first + square + Index(k)] / means[first + weight] - v * v;
  }

  static double below(double R, double height) {
    if constexpr (Dim == 2) {
      return disc_area_below(R, height);
    } else {
      return sphere_volume_below(R, height);
    }
  }

  template <class P>
  void add_grain(const P& grains, Index i, double height) {
    const double R = double(grains[radius][i]);
    const double thickness = slices_.thickness();
    const double bottom = (height - R - slices_.lower) / thickness;
    const double top = (height + R - slices_.lower) / thickness;
    if (!(top > 0) || !(bottom < double(slices_.count))) return;
    const auto first = static_cast<Index>(std::max(0.0, std::floor(bottom)));
    const double whole = below(R, R);
    double before = below(R, slices_.lower + double(first) * thickness - height);
    for (Index s = first; s < slices_.count && before < whole; ++s) {
      const double next = below(R, slices_.lower + double(s + 1) * thickness - height);
      double* const slice = &sample_[s * numbers];
      const double m = double(grains[mass][i]) * (next - before) / whole;
      slice[volume] += (next - before) / (slices_.cross_section * thickness);
      slice[weight] += m;
      for (int k = 0; k < Dim; ++k) {
        const double v = double(grains[velocity][i][k]);
        slice[flow + Index(k)] += m * v;
        slice[square + Index(k)] += m * v * v;
      }
      before = next;
    }
  }

  Slices slices_;
  std::vector<double> sample_;
  BlockSums sums_;
};

}  // namespace silt
