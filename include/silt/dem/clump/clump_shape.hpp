// SPDX-License-Identifier: MIT
// What clumps of one kind have in common: their spheres, mass and moment of inertia.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/dem/clump/shares_of_clump.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/union_of_balls.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace silt::dem {

/// A rigid body of spheres, in 2D of discs, which may overlap: where it is defined. Clumps::add()
/// puts copies of it among grains.
template <int Dim>
class ClumpShape {
 public:
  /// A homogeneous body [kg/m³] of these spheres: its mass and moment of inertia are those of their
  /// union, in which what belongs to several counts once. Throws if there are none, or if a
  /// number is not possible.
  ClumpShape(std::vector<Ball<Dim>> spheres, double density, Index clump_material = 0)
      : spheres_(std::move(spheres)),
        mass_(of_union(density)),
        volume_(mass_.mass / density),
        material_(clump_material) {
    divide();
  }

  /// A body with this mass, centre of mass and moment of inertia. Throws if a number is not
  /// possible, or if no positive masses at the centres of the spheres have that mass and centre,
  /// and a smaller moment of inertia: then add a sphere, which may lie within others.
  ClumpShape(std::vector<Ball<Dim>> spheres, const MassProperties<Dim>& given,
             Index clump_material = 0)
      : spheres_(std::move(spheres)),
        mass_(given),
        volume_(of_union(1).mass),
        material_(clump_material) {
    divide();
  }

  /// The spheres, in the coordinates in which the shape was given.
  std::span<const Ball<Dim>> spheres() const noexcept { return spheres_; }
  /// In these coordinates.
  const MassProperties<Dim>& mass_properties() const noexcept { return mass_; }
  /// Volume of the union of the spheres [m³]; in 2D its area [m²].
  double volume() const { return volume_; }
  /// In dem::Materials.
  Index material_index() const noexcept { return material_; }
  /// Radius of the smallest sphere about the centre of mass that contains the body [m].
  double bounding_radius() const {
    double most = 0;
    for (const Ball<Dim>& ball : spheres_) {
      most = std::max(most, (ball.centre - mass_.centre).norm() + ball.radius);
    }
    return most;
  }
  /// The same shape, all lengths times a factor, of the same density. Throws if it is not above 0.
  ClumpShape scaled(double factor) const {
    require_positive("dem::ClumpShape: factor", factor);
    ClumpShape shape = *this;
    const double volume = std::pow(factor, Dim);  // of the new one over that of the old one
    for (Ball<Dim>& ball : shape.spheres_) {
      ball.centre *= factor;
      ball.radius *= factor;
    }
    shape.volume_ *= volume;
    shape.mass_.mass *= volume;
    shape.mass_.centre *= factor;
    shape.mass_.inertia *= volume * factor * factor;
    for (detail::ShareOfClump& share : shape.shares_) {
      share.mass *= volume;
      share.inertia *= volume * factor * factor;
    }
    return shape;
  }

  /// The moment of inertia of the clump without that of its spheres [kg m²]; 0 in 2D.
  silt::Inertia<Dim> beyond_spheres() const {
    if constexpr (Dim == 2) {
      return 0;
    } else {
      silt::Inertia<3> rest = detail::rest_of_inertia<Dim>(mass_, shares_, spheres_);
      for (const detail::ShareOfClump& share : shares_)
        rest -= share.inertia * silt::Inertia<3>::Identity();
      return rest;
    }
  }
  /// The mass and moment of inertia of each sphere, see shares_of_clump.hpp.
  std::span<const detail::ShareOfClump> shares() const noexcept { return shares_; }

 private:
  MassProperties<Dim> of_union(double density) const {
    return mass_properties_of<Dim>("dem::ClumpShape", spheres_, density);
  }
  void divide() {
    require_valid("dem::ClumpShape", mass_);
    if (material_ > std::numeric_limits<std::uint32_t>::max()) {
      fail({"dem::ClumpShape: material = ", material_,
            " is not below 2^32; give an index in dem::Materials"});
    }
    shares_ = detail::shares_of_clump<Dim>(spheres_, mass_);
    // Of the shares exactly; otherwise by round-off of the integrals.
    Vec<Dim> centre = Vec<Dim>::Zero();
    for (std::size_t s = 0; s < shares_.size(); ++s) {
      centre += shares_[s].mass / mass_.mass * (spheres_[s].centre - mass_.centre);
    }
    mass_.centre += centre;
  }

  std::vector<Ball<Dim>> spheres_;
  MassProperties<Dim> mass_;
  double volume_ = 0;
  std::vector<detail::ShareOfClump> shares_;
  Index material_ = 0;
};

}  // namespace silt::dem
