// SPDX-License-Identifier: MIT
// Clumps of several shapes, in random orientations, for Inflow and scatter().
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/clump/clump_shape.hpp>
#include <silt/dem/clump/clumps.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/geometry/orientation.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::dem {

/// Clumps of these shapes, in orientations, all equally likely. Each
/// is put where its bounding sphere touches nothing.
template <int Dim>
class ClumpBlend {
 public:
  /// Throws if there are no shapes.
  explicit ClumpBlend(std::vector<ClumpShape<Dim>> shapes) : shapes_(std::move(shapes)) {
    if (shapes_.empty()) fail("dem::ClumpBlend: there are no shapes; give at least one");
  }

  /// A clump to be put somewhere.
  struct Drawn {
    Index shape = 0;  ///< number of its shape
    Orientation<Dim> orientation = {};
    double radius = 0;  ///< of the bounding sphere [m]
  };

  /// Throws nothing: shapes were checked when they were made.
  void check() const {}
  /// Radius of the largest bounding sphere [m].
  double largest() const {
    double most = 0;
    for (const ClumpShape<Dim>& shape : shapes_) most = std::max(most, shape.bounding_radius());
    return most;
  }
  /// A shape and an orientation [-].
  Drawn draw(Random& random) const {
    Drawn drawn{.shape = std::min(Index(random.uniform() * double(shapes_.size())),
                                  Index(shapes_.size() - 1))};
    drawn.radius = shapes_[drawn.shape].bounding_radius();
    if constexpr (Dim == 2) {
      drawn.orientation.angle = random.uniform({0, 2 * std::numbers::pi});
    } else {
      // A quaternion of four normal numbers has no preferred direction.
      for (double& number : drawn.orientation.quaternion) number = random.normal();
      drawn.orientation.quaternion.normalize();
    }
    return drawn;
  }
  /// Volume of the union of its spheres [m³].
  double volume(const Drawn& drawn) const { return shapes_[drawn.shape].volume(); }
  /// Adds the clump at x [m] with this velocity [m/s].
  template <class P, class V>
  void add(P& grains, Clumps<Dim>& clumps, const V& x, const Drawn& drawn, const V& v) const {
    clumps.add(
        grains, shapes_[drawn.shape],
        {.position = in_double(x), .orientation = drawn.orientation, .velocity = in_double(v)});
  }

 private:
  std::vector<ClumpShape<Dim>> shapes_;
};

}  // namespace silt::dem
