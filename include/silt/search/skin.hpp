// SPDX-License-Identifier: MIT
// How thick the skin of a neighbour list should be. A thick one is rebuilt seldom, but every walk
// along it meets more strangers. With e entries per particle at no skin, s the skin over the
// radius, and particles that move at most u radii a step, a step costs per particle
//
//   (1 + s)^Dim e  +  (fixed + per_entry (1 + s)^Dim e) 2u/s
//
// in units of what it takes to look at one entry: the walk, and its share of a rebuild. All of it
// is counted, nothing is timed, so that the same input gives the same bits.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>

namespace silt {

class Skin {
 public:
  /// Tunes itself.
  Skin() = default;
  /// Stays as it is: skin over radius [-].
  explicit Skin(double fraction) : fraction_(fraction), tunes_(false) {}

  double fraction() const noexcept { return fraction_; }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("fraction", fraction_);
  }

  /// What a list has gone through when somebody has moved half its skin.
  struct Life {
    int dimension;
    double entries;  ///< per particle, the skin's included
    Index updates;   ///< since it was built, at least 1
  };
  void learn(const Life& life) {
    if (!tunes_) return;
    const double speed = fraction_ / 2 / double(life.updates);
    const double entries = life.entries / std::pow(1 + fraction_, life.dimension);
    const auto cost = [&](double skin) {
      const double met = entries * std::pow(1 + skin, life.dimension);
      return met + (fixed + per_entry * met) * 2 * speed / skin;
    };
    double best = thinnest;
    for (double skin = thinnest; skin <= thickest; skin *= 1.1) {
      if (cost(skin) < cost(best)) best = skin;
    }
    // Half of the way there: the next life may differ.
    fraction_ = std::sqrt(fraction_ * best);
  }

 private:
  // Of a rebuild, measured: sorting the particles, and finding an entry.
  static constexpr double fixed = 20;
  static constexpr double per_entry = 0.6;
  static constexpr double thinnest = 0.02;
  static constexpr double thickest = 0.5;

  double fraction_ = 0.2;
  bool tunes_ = true;
};

}  // namespace silt
