// SPDX-License-Identifier: MIT
// Grains: the particles of DEM.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace silt::dem {

inline constexpr struct material_t : field_of<std::uint32_t>, constant_field {
} material{};  ///< of a grain: an index in dem::Materials [-]

template <int Dim>
class Clumps;  // dem/clump/clumps.hpp

inline constexpr struct clump_t : field_of<Id>, constant_field {
} clump{};  ///< of a sphere of a clump, 1 + the id of its first sphere; 0 of a grain of none [-]
// `mass` is the sphere's share of it, see dem/clump/clumps.hpp.
inline constexpr struct clump_mass_t : scalar_field, constant_field {
} clump_mass{};  ///< of the clump, resists contacts [kg]; of a grain that belongs to none, its own

namespace detail {
// The contacts read position, radius, velocity, mass and spin of single grains: they are stored
// side by side, in groups of four numbers. `Mass` is the one that resists contacts.
template <int Dim, class Real, Field Mass, Field... Further>
struct GrainsOf {
  using type = Particles<Dim, Real, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t,
                         radius_t, material_t, Further...,
                         Bundle<position_t, radius_t, velocity_t, Mass>, Bundle<spin_t, inertia_t>>;
};
// In 3D the time integral of the spin is not an orientation. If it is needed, add angle_t.
template <class Real, Field Mass, Field... Further>
struct GrainsOf<2, Real, Mass, Further...> {
  using type = Particles<2, Real, velocity_t, spin_t, angle_t, force_t, torque_t, mass_t, inertia_t,
                         radius_t, material_t, Further...,
                         Bundle<position_t, radius_t, Mass, velocity_t, spin_t, inertia_t>>;
};
}  // namespace detail

/// Discs (2D), which also have an angle, or spheres (3D), with any further user-defined fields. All
/// have a position [m], velocity [m/s], spin [rad/s], force [N], torque [N m], mass [kg], moment of
/// inertia [kg m²], radius [m] and material.
template <int Dim, class Real = double, Field... Further>
using Grains = typename detail::GrainsOf<Dim, Real, mass_t, Further...>::type;

/// Grains of which some, or all, are spheres of clumps, see dem/clump/clumps.hpp.
template <int Dim, class Real = double, Field... Further>
using ClumpGrains =
    typename detail::GrainsOf<Dim, Real, clump_mass_t, clump_t, clump_mass_t, Further...>::type;

}  // namespace silt::dem

namespace silt {
// See core/concepts.hpp.
template <class P>
  requires HasFields<P, dem::clump_t>
inline constexpr bool move_in_bodies<P> = true;
}  // namespace silt

namespace silt::dem {

namespace detail {
/// The mass that resists the contacts of a grain.
template <class P>
constexpr auto mass_in_contacts() {
  if constexpr (HasFields<P, clump_mass_t>) {
    return clump_mass;
  } else {
    return mass;
  }
}
/// Whether the grains i and j, the halo included, belong to the same clump: they have no contact.
template <class P>
bool are_of_one_clump([[maybe_unused]] const P& grains, [[maybe_unused]] Index i,
                      [[maybe_unused]] Index j) {
  if constexpr (HasFields<P, clump_t>) {
    const auto clumps = grains.with_halo(clump);
    return clumps[i] != 0 && clumps[i] == clumps[j];
  } else {
    return false;
  }
}
}  // namespace detail

/// Shape that determines mass m [kg] and moment of inertia I [kg m²] of a grain.
enum class Shape {
  natural,  ///< a disc of unit thickness in 2D, a sphere in 3D
  sphere,   ///< a sphere, also in 2D: a layer of spheres whose centres stay in a plane
};

/// A new grain, for add_grain and make_grains.
struct Grain {
  double radius = 0;             ///< R [m], above 0
  double density = 0;            ///< ρ of the grain's material [kg/m³], above 0
  Shape shape = Shape::natural;  ///< disc: I = ½ m R²; sphere: I = ⅖ m R²
  Index material = 0;            ///< in dem::Materials, below 2³²
};

/// Volume of a sphere [m³]; in 2D, area of a disc [m²]. `radius` [m] is not checked.
template <int Dim>
double volume_of(double radius) {
  return Dim == 2 ? std::numbers::pi * radius * radius
                  : std::numbers::pi * radius * radius * radius * 4 / 3;
}

/// Whether this may be the radius of a grain [m]: the squares of the distances between such grains
/// in contact neither overflow nor underflow.
template <class Real>
bool is_radius(Real R) {
  return R > 0 && is_positive_normal(R * R) && is_finite(64 * R * R);
}

/// Whether the products that contacts compute neither underflow nor overflow in [m] and [kg]: those
/// of two radii, of two masses, and of a mass, a radius and the distance of two centres, which is
/// at least the round-off of a radius and at most two of them.
template <class Real>
bool has_products(Real R, Real m) {
  using Limits = std::numeric_limits<Real>;
  constexpr Real least = Limits::min();
  constexpr Real most = Limits::max() / 16;
  return R * R > least && m * m > least && m * (R * R) * Limits::epsilon() > least &&
         R * R * (R * R) < most && m * m < most;
}

namespace detail {
/// Mass [kg] and moment of inertia [kg m²] of a grain.
struct Inertia {
  double mass;
  double moment;
};
/// Throws if add_grain would refuse the grain.
template <class P>
Inertia inertia_of(const Grain& grain) {
  using Real = typename P::Real;
  require_positive("Grain: radius", grain.radius);
  require_positive("Grain: density", grain.density);
  const bool disc = P::dimension == 2 && grain.shape == Shape::natural;
  const double r = grain.radius;
  const double m = grain.density * (disc ? volume_of<2>(r) : volume_of<3>(r));
  const double I = disc ? m * r * r / 2 : m * r * r * 2 / 5;
  // In the precision of the grains, to reject values that underflow or overflow in it.
  if (!is_radius(Real(r)) || !is_positive_normal(Real(m)) || !is_positive_normal(Real(I)) ||
      !has_products(Real(r), Real(m))) {
    fail({"Grain: radius = ", r, " m and density = ", grain.density, " kg/m³ give the mass ", m,
          " kg and the moment of inertia ", I,
          " kg m²; change them so that these, and products of radius and mass, are normal numbers "
          "in the precision of the grains"});
  }
  if (grain.material > std::numeric_limits<std::uint32_t>::max()) {
    fail({"Grain: material = ", grain.material,
          " is not below 2^32; give an index in dem::Materials"});
  }
  return {m, I};
}
}  // namespace detail

/// Adds a grain at rest at x [m]; returns its index in memory. Throws, and adds nothing, if x is
/// not finite, if radius or density is not positive and finite, if the square of the radius,
/// mass or moment of inertia underflows or overflows in the precision of the grains, or if the
/// material is 2³² or more. The first step with dem::Contacts throws if the material does not
/// exist.
template <class P>
  requires HasFields<P, mass_t, inertia_t, radius_t, material_t>
Index add_grain(P& grains, const typename P::Vec& x, const Grain& grain) {
  using Real = typename P::Real;
  const auto [m, I] = detail::inertia_of<P>(grain);
  const Index i = grains.add(x, Initial{radius, Real(grain.radius)}, Initial{mass, Real(m)},
                             Initial{inertia, Real(I)},
                             Initial{material, static_cast<std::uint32_t>(grain.material)});
  if constexpr (HasFields<P, clump_mass_t>) grains[clump_mass][i] = Real(m);
  return i;
}

/// Equal grains at rest at these points [m], in an unbounded box (set_box() gives them another);
/// with further fields: make_grains<temperature_t>(…). Throws as add_grain does.
template <Field... Further, class Real, int Dim>
Grains<Dim, Real, Further...> make_grains(const std::vector<Eigen::Matrix<Real, Dim, 1>>& points,
                                          const Grain& grain) {
  Grains<Dim, Real, Further...> grains;
  grains.reserve(points.size());
  for (const auto& x : points) add_grain(grains, x, grain);
  return grains;
}

}  // namespace silt::dem
