// SPDX-License-Identifier: MIT
// The volumes of particles by which sums over neighbours weight them.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/mixture.hpp>
#include <silt/mps/operator/own_density.hpp>
#include <silt/mps/scheme/scheme.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace silt::mps {

/// Of each particle and ghost, over l0^Dim [-]: 1, or 1/ε with a scheme InMixture.
template <class Scheme, int Dim, class RealType>
class BulkVolumes {
 public:
  using Real = RealType;
  static constexpr int dimension = Dim;
  static constexpr bool are_one = !is_in_mixture<Scheme>;  ///< all of them

  /// With a stencil of this radius, and another one for the Laplacian [-].
  template <class T, class L>
  BulkVolumes([[maybe_unused]] double radius, [[maybe_unused]] const T& stencil,
              [[maybe_unused]] double laplacian_radius, [[maybe_unused]] const L& laplacian) {
    if constexpr (!are_one) {
      own_ = OwnDensity<Dim, Real>(radius, stencil.kernel);
      own_in_laplacian_ = OwnDensity<Dim, Real>(laplacian_radius, laplacian.kernel);
    }
  }

  /// Finds them. Throws if a fluid_fraction is not in (0, 1], or too small for the radii; those of
  /// ghosts must be up to date.
  template <FluidParticles P>
  void find([[maybe_unused]] const P& particles) {
    if constexpr (!are_one) {
      static_assert(
          ParticlesInMixture<P>,
          "mps: a scheme InMixture needs particles with a fluid_fraction, such as those of "
          "mps::FluidInMixture");
      static_assert(silt::detail::are_of_one_process<P>,
                    "mps: a fluid InMixture cannot be shared by processes");
      const auto fraction = particles.with_ghosts(fluid_fraction);
      const Index wrong = first_where(
          particles.size(), [&](Index i) { return !(fraction[i] > 0 && fraction[i] <= 1); });
      if (wrong != no_index) {
        fail({"mps::Flow: fluid_fraction = ", fraction[wrong],
              " of a particle is not above 0 and at most 1; set it before the first step"},
             {.particle = wrong, .id = particles.id(wrong)});
      }
      const auto of_second_phase = particles.with_ghosts(mps::response);
      volumes_.resize(fraction.size());
      responses_.resize(fraction.size());
      for_each(fraction.size(), [&](Index j) {
        volumes_[j] = 1 / fraction[j];
        responses_[j] = of_second_phase[j];
      });
      const double largest = std::min(own_.largest_volume(), own_in_laplacian_.largest_volume());
      const Index sparse =
          first_where(particles.size(), [&](Index i) { return volumes_[i] > Real(largest); });
      if (sparse != no_index) {
        fail(
            {"mps::Flow: a fluid_fraction of ", fraction[sparse], " leaves particles ",
             std::pow(double(volumes_[sparse]), 1.0 / Dim),
             " spacings apart, too far for FlowSettings: radius and laplacian_radius; give both at "
             "least ",
             OwnDensity<Dim, Real>::radius_for(double(volumes_[sparse]))},
            {.particle = sparse, .id = particles.id(sparse)});
      }
    }
  }

  /// Of a particle or ghost.
  Real operator[]([[maybe_unused]] Index j) const {
    if constexpr (are_one) {
      return 1;
    } else {
      return volumes_[j];
    }
  }
  /// (R_i + R_j)/2 of the pressure equation of two particles [-], see PressureEquation.
  Real response([[maybe_unused]] Index i, [[maybe_unused]] Index j) const {
    if constexpr (are_one) {
      return 0;
    } else {
      return (responses_[i] + responses_[j]) / 2;
    }
  }
  /// 2 V_i/(V_i + V_j) [-]: a weight that has the volume of j, times this, is that of both.
  Real of_pair([[maybe_unused]] Index i, [[maybe_unused]] Index j) const {
    if constexpr (are_one) {
      return 1;
    } else {
      return 2 * volumes_[i] / (volumes_[i] + volumes_[j]);
    }
  }
  /// c(1/ε_i), see OwnDensity [-].
  Real own_density([[maybe_unused]] Index i) const {
    if constexpr (are_one) return 0;
    return own_(volumes_[i]);
  }
  /// The same in the stencil of the Laplacian [-].
  Real own_density_in_laplacian([[maybe_unused]] Index i) const {
    if constexpr (are_one) return 0;
    return own_in_laplacian_(volumes_[i]);
  }

 private:
  struct None {
    Real operator()(Real) const { return 0; }
  };
  using Own = std::conditional_t<are_one, None, OwnDensity<Dim, Real>>;

  Buffer<Real> volumes_;    // empty if they are one
  Buffer<Real> responses_;  // the same
  [[no_unique_address]] Own own_;
  [[no_unique_address]] Own own_in_laplacian_;
};

/// What a particle sees of its neighbours, weighted by their volumes; see Neighbourhood::find().
template <class Visible, class Volumes>
struct VisibleVolumes {
  const Visible& visible;
  const Volumes& volumes;

  /// Whether visible_share() is 1 for all neighbours.
  bool sees_all(Index i) const {
    if constexpr (Volumes::are_one) {
      return visible.sees_all(i);
    } else {
      return false;
    }
  }
  /// Of neighbour j of i, times its volume [-].
  auto visible_share(Index i, Index j) const {
    const auto share = visible.sees_all(i) ? 1 : visible.visible_share(i, j);
    return share * volumes[j];
  }
};

}  // namespace silt::mps
