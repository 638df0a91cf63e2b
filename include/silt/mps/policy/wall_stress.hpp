// SPDX-License-Identifier: MIT
// The viscous stress of walls on the fluid.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/policy/any_particle_view.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <type_traits>

namespace silt::mps {

/// Δt ν∇²u over the neighbours with the velocities that they have. Fluid mirrored in walls slips along
/// them; wall particles at rest resist as a fluid at rest would.
struct FreeSlip {
  void check() const {}

  template <class View>
  typename View::Vec velocity_change(const View& at, double nu) const {
    using Real = typename View::Real;
    return (Real(at.time_step()) * Real(nu)) * at.laplacian(at.velocities());
  }
};

/// Δt ν∇²u, in which fluid mirrored in walls has the opposite velocity, so that it sticks to the wall: for
/// boundary layers of several spacings. Needs walls that mirror the fluid.
struct NoSlip {
  void check() const {}

  template <class View>
  [[gnu::flatten]] typename View::Vec velocity_change(const View& at, double nu) const {
    using Vec = typename View::Vec;
    const auto u = at.velocities();
    const Vec sum = mps::laplacian(at.laplacian_stencil(), at.velocity(), [&](auto&& f) {
      at.for_each_in_laplacian([&](const auto& j) {
        if constexpr (std::remove_cvref_t<decltype(j)>::is_image) {
          f(j.sticking(u), j.r_ij, j.weight, j.weight_over_square);
        } else {
          f(Vec(j.velocity(u)), j.r_ij, j.weight, j.weight_over_square);
        }
      });
    });
    using Real = typename View::Real;
    return (Real(at.time_step()) * Real(nu)) * sum;
  }
};

/// Fluid slips, but each wall of faces has the shear stress τ = ρ u*² of a turbulent boundary layer, for
/// spacings that do not resolve it: from the velocity u along the wall at the distance h of a particle,
///
///   u/u* = h u*/ν                 in the viscous sublayer, h u*/ν < 11.6
///   u/u* = ln(h u*/ν)/0.41 + 5    above it, on a smooth wall, or
///   u/u* = ln(h/k)/0.41 + 8.5     on one of sand roughness k, where this gives more
///
/// It acts on the row of particles at the wall, −τ/(ρ l0), less on those beyond a distance of l0/2 and
/// not beyond 3/2 l0; it stops them at most. Not from the papers; the law of the wall as in
/// [Schlichting1979].
struct WallLaw {
  double roughness = 0;  ///< k [m], at least 0: smooth

  void check() const { require_not_negative("WallLaw: roughness", roughness); }

  template <class View>
  typename View::Vec velocity_change(const View& at, double nu) const {
    using Real = typename View::Real;
    using Vec = typename View::Vec;
    Vec sum = FreeSlip{}.velocity_change(at, nu);
    const double l0 = double(at.spacing());
    at.for_each_wall([&](const Vec& normal, Real height, const Vec& of_wall) {
      const double share = std::clamp(1.5 - double(height) / l0, 0.0, 1.0);
      const Vec relative = at.velocity() - of_wall;
      const Vec u = relative - relative.dot(normal) * normal;
      const double speed = double(u.norm());
      if (!(share > 0) || !(speed > 0)) return;
      const double stress = squared(friction_velocity(speed, double(height), nu));  // over ρ
      const double change = std::min(at.time_step() * share * stress / l0, speed);
      sum -= Real(change / speed) * u;
    });
    return sum;
  }
  /// u* [m/s] where the velocity along the wall is u [m/s] at a distance h [m], for a viscosity ν
  /// above 0 [m²/s].
  double friction_velocity(double u, double h, double nu) const {
    const double laminar = std::sqrt(nu * u / h);
    if (h * laminar / nu < edge) return rough(u, h, laminar);
    // Newton's method for u/u* − ln(h u*/ν)/κ − B = 0, which falls with u* and is convex.
    double found = laminar;
    for (int k = 0; k < 20; ++k) {
      const double value = u / found - std::log(h * found / nu) / kappa - smooth;
      const double slope = -u / squared(found) - 1 / (kappa * found);
      found -= value / slope;
    }
    return rough(u, h, found);
  }

 private:
  static constexpr double kappa = 0.41, smooth = 5, sand = 8.5, edge = 11.6;

  double rough(double u, double h, double of_smooth) const {
    if (!(roughness > 0)) return of_smooth;
    const double ratio = std::log(std::max(h / roughness, 1.0)) / kappa + sand;
    return std::max(of_smooth, u / ratio);
  }
};

/// The part of a velocity change by viscosity and walls [m/s] that is by the walls: all but that of
/// the viscosity among particles, whose sum over them is zero.
template <class View>
[[gnu::flatten]] typename View::Vec part_of_walls(const View& at, double nu,
                                                  const typename View::Vec& change) {
  using Vec = typename View::Vec;
  using Real = typename View::Real;
  const auto u = at.velocities();
  const Vec among_particles = mps::laplacian(at.laplacian_stencil(), at.velocity(), [&](auto&& f) {
    at.for_each_in_laplacian([&](const auto& j) {
      if constexpr (!std::remove_cvref_t<decltype(j)>::is_image) {
        f(Vec(j.velocity(u)), j.r_ij, j.weight, j.weight_over_square);
      }
    });
  });
  return change - (Real(at.time_step()) * Real(nu)) * among_particles;
}

/// s.velocity_change(at, ν) is that of a fluid particle in a step by the viscosity ν > 0 [m²/s] and the
/// walls [m/s], from its ParticleView, before any velocity is changed.
template <class S>
concept WallStress = requires(const S stress, const detail::AnyParticleView<2>& in_2d,
                              const detail::AnyParticleView<3>& in_3d, double nu) {
  { stress.velocity_change(in_2d, nu) } -> std::convertible_to<Vec<2>>;
  { stress.velocity_change(in_3d, nu) } -> std::convertible_to<Vec<3>>;
  stress.check();
};

}  // namespace silt::mps
