// SPDX-License-Identifier: MIT
// Tunes the skin of a neighbour list. A list with a thick skin is rebuilt rarely, but every loop
// over it tests more pairs beyond the radius. With e entries per particle without skin, s the ratio
// of skin to radius, and a maximum displacement of u radii per step, the cost of a step per
// particle is
//
//   (1 + s)^Dim e  +  (fixed + per_entry (1 + s)^Dim e) 2u/s
//
// in units of one entry read: the loop, and the share of a rebuild. These are counts, not times, so
// that the same input gives the same bits.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>

namespace silt {

/// The ratio of skin to radius, which it may tune.
class Skin {
 public:
  /// Tuned automatically.
  Skin() = default;
  /// Fixed ratio of skin to radius [-].
  explicit Skin(double fraction) : fraction_(fraction), tunes_(false) {}

  /// Ratio of skin to radius [-].
  double fraction() const noexcept { return fraction_; }

  /// Writes or reads the ratio for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("fraction", fraction_);
  }

  /// Statistics of a list when a particle has moved by half its skin.
  struct Usage {
    int dimension;
    double entries;  ///< per particle, including those within the skin [-]
    Index updates;   ///< since it was built, at least 1
  };
  /// Tunes the ratio for the next list, unless it is fixed.
  void update(const Usage& usage) {
    if (!tunes_) return;
    const double speed = fraction_ / 2 / double(usage.updates);
    const double entries = usage.entries / std::pow(1 + fraction_, usage.dimension);
    const auto cost = [&](double skin) {
      const double read = entries * std::pow(1 + skin, usage.dimension);
      return read + (fixed + per_entry * read) * 2 * speed / skin;
    };
    double best = min_fraction;
    for (double skin = min_fraction; skin <= max_fraction; skin *= 1.1) {
      if (cost(skin) < cost(best)) best = skin;
    }
    // Geometric mean of the old and the optimal value, as the next list may differ.
    fraction_ = std::sqrt(fraction_ * best);
  }

 private:
  // Measured costs of a rebuild: sorting a particle, and finding an entry.
  static constexpr double fixed = 20;
  static constexpr double per_entry = 0.6;
  static constexpr double min_fraction = 0.02;
  static constexpr double max_fraction = 0.5;

  double fraction_ = 0.2;
  bool tunes_ = true;
};

}  // namespace silt
