// SPDX-License-Identifier: MIT
// What the operators of a flow are evaluated with: the stencils of its scheme, and at the present
// positions the neighbours within them and the walls.
#pragma once

#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/laplacian.hpp>
#include <silt/mps/operator/neighbour.hpp>
#include <silt/mps/operator/neighbourhood.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/policy/free_surface.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/view/bulk_volumes.hpp>
#include <silt/mps/wall/walls.hpp>

#include <algorithm>
#include <type_traits>
#include <utility>

namespace silt::mps {

/// The neighbours and images of FlowOperators in the form of a search: an image stands for the
/// particle that it mirrors. Images of i are left out, as their pressure above that of i is known.
template <class Operators>
struct PressureNeighbours {
  const Operators& operators;
};
template <class Operators, class T, class F>
[[gnu::always_inline]] inline void for_each_weighted(
    const PressureNeighbours<Operators>& neighbours, Index i, const T&, F&& f) {
  neighbours.operators.for_each_in_laplacian(i, [&](const auto& j) {
    if (j.is_image && j.index == i) return;
    f(j.index, j.r_ij, j.weight, j.weight_over_square);
  });
}
template <class Operators, class T, class F>
bool any_weighted(const PressureNeighbours<Operators>& neighbours, Index i, const T& stencil,
                  F&& f) {
  const auto& operators = neighbours.operators;
  if (any_weighted(operators.laplacian_neighbourhood(), i, stencil, f)) return true;
  bool any = false;
  operators.for_each_image_in_laplacian(i, [&](const auto& image) {
    any |= image.index != i && f(image.index, image.weight);
  });
  return any;
}

/// The stencils of a Scheme, and the neighbours and walls of the particles at present.
template <class Scheme, int Dim, class RealType>
class FlowOperators {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Settings = FlowSettings<Dim, Scheme>;
  /// The kernel of the scheme.
  using Kernel = KernelOf<Scheme>;
  /// Weights of the Laplacian, from the same kernel.
  using LaplacianKernel =
      decltype(std::declval<LaplacianOf<Scheme>>().template weights<Dim>(std::declval<Kernel>()));
  using Stencil = mps::Stencil<Dim, Real, Kernel>;
  /// The stencil of the Laplacian, with its own effective radius.
  using LaplacianStencil = mps::Stencil<Dim, Real, LaplacianKernel>;
  using BulkVolumes = mps::BulkVolumes<Scheme, Dim, Real>;
  /// The walls of the scheme in this flow.
  using Walls = typename WallsOf<Scheme>::template InFlow<Dim, Real>;

  /// The settings must be valid.
  explicit FlowOperators(const Settings& settings)
      : stencil_({.spacing = settings.spacing, .radius = settings.radius}, settings.kernel),
        laplacian_stencil_({.spacing = settings.spacing, .radius = settings.laplacian_radius},
                           settings.laplacian.template weights<Dim>(settings.kernel)),
        bulk_volumes_(settings.radius, stencil_, settings.laplacian_radius, laplacian_stencil_),
        walls_(settings.walls) {}

  /// Of density, gradient and divergence.
  const Stencil& stencil() const noexcept { return stencil_; }
  const LaplacianStencil& laplacian_stencil() const noexcept { return laplacian_stencil_; }
  const Walls& walls() const noexcept { return walls_; }
  /// The larger of the two effective radii [m].
  Real reach() const { return std::max(stencil_.re, laplacian_stencil_.re); }

  /// Places walls that move where they are at the beginning of a step, at a time [s], of this
  /// length [s].
  void begin_step([[maybe_unused]] double time, [[maybe_unused]] double time_step) {
    if constexpr (MovesWalls<Walls>) {
      walls_.begin_step(time, time_step, double(stencil_.spacing));
    }
  }

  /// The longest step of walls that move, from a time [s] on; infinite if there are none. They move
  /// by at most `distance` [m].
  double longest_step([[maybe_unused]] double time, [[maybe_unused]] double distance) const {
    if constexpr (MovesWalls<Walls>) return walls_.longest_step(time, distance);
    return std::numeric_limits<double>::infinity();
  }
  /// Of the fastest wall in the step [m/s].
  double max_speed_of_walls() const {
    if constexpr (MovesWalls<Walls>) return walls_.max_speed();
    return 0;
  }
  /// Whether bodies move with other velocities in this step than so far, as the changes of the momentum of
  /// the particles show; neighbours and walls are those of these velocities then.
  template <class P, class S, class Changes>
  [[gnu::cold]] bool change_velocities([[maybe_unused]] const P& particles,
                                       [[maybe_unused]] const S& search,
                                       [[maybe_unused]] const Changes& changes,
                                       [[maybe_unused]] const Settings& settings,
                                       [[maybe_unused]] double time,
                                       [[maybe_unused]] double time_step) {
    if constexpr (MovesWalls<Walls>) {
      if (!walls_.change_velocities(particles, changes, settings, time, time_step)) return false;
      find(particles, search);
      return true;
    }
    return false;
  }
  /// Ends the step of bodies with its load.
  template <class P, class Changes>
  void end_step([[maybe_unused]] const P& particles, [[maybe_unused]] const Changes& changes,
                [[maybe_unused]] const Settings& settings, [[maybe_unused]] double time,
                [[maybe_unused]] double time_step) {
    if constexpr (MovesWalls<Walls>) {
      walls_.end_step(particles, changes, settings, time, time_step);
    }
  }
  void save() {
    if constexpr (MovesWalls<Walls>) walls_.save();
  }
  void restore() noexcept {
    if constexpr (MovesWalls<Walls>) walls_.restore();
  }
  template <class Archive>
  void transfer([[maybe_unused]] Archive& archive) {
    if constexpr (MovesWalls<Walls>) archive.within("walls", [&] { walls_.transfer(archive); });
  }

  /// Finds the neighbours from the search, and the walls.
  template <FluidParticles P, class S>
  void find(const P& particles, const S& search) {
    bulk_volumes_.find(particles);
    if constexpr (HidesNeighbours<Walls>) {
      walls_.locate(particles, search, *this);
      find(particles, search, walls_);
    } else {
      find(particles, search, AllVisible{});
    }
    walls_.find(particles, *this);
  }
  /// Finds them again if a particle was added, removed, sorted or moved since then. Throws if one
  /// went through a wall that hides neighbours.
  template <FluidParticles P, class S>
  void find_if_moved(const P& particles, const S& search) {
    if (!silt::detail::any_of_all(particles, !neighbourhood_.is_current(particles))) return;
    check_moves(particles);
    find(particles, search);
  }
  /// Throws if a particle went through a wall that hides neighbours since they were found.
  template <FluidParticles P>
  void check_moves([[maybe_unused]] const P& particles) const {
    if constexpr (HidesNeighbours<Walls>) walls_.check_moves(particles);
  }
  /// Continues the flow of the velocities beyond walls of which images do so, see ContinuesFlow.
  /// Velocities of ghosts must be up to date.
  template <FluidParticles P>
  void continue_flow([[maybe_unused]] const P& particles) {
    if constexpr (ContinuesFlow<Walls> && !counts_flow_to_walls<Scheme>) {
      walls_.continue_flow(particles, *this);
    }
  }

  const Neighbourhood<Dim, Real>& neighbourhood() const noexcept { return neighbourhood_; }
  /// The neighbours within laplacian_stencil().
  const Neighbourhood<Dim, Real>& laplacian_neighbourhood() const noexcept {
    return shares_neighbourhood() ? neighbourhood_ : laplacian_neighbourhood_;
  }

  /// f(neighbour) for every neighbour of i within stencil(), and for every image in a wall.
  template <class F>
  [[gnu::always_inline]] inline void for_each(Index i, F&& f) const {
    for_each_in(neighbourhood_, stencil_, i, f);
  }
  /// The same within laplacian_stencil().
  template <class F>
  [[gnu::always_inline]] inline void for_each_in_laplacian(Index i, F&& f) const {
    for_each_in(laplacian_neighbourhood(), laplacian_stencil_, i, f);
  }
  /// Whether is(neighbour) is true for any of those of for_each(); r_ij and w/r² of particles are
  /// not set.
  template <class F>
  bool any(Index i, F&& is) const {
    const Vec unset = Vec::Zero();
    if (any_weighted(neighbourhood_, i, stencil_, [&](Index j, Real w) {
          return is(Neighbour<Dim, Real>{j, unset, w, 0});
        })) {
      return true;
    }
    bool found = false;
    for_each_image(i, [&](const auto& image) { found |= is(image); });
    return found;
  }
  /// f(image) for the images alone; there are none with most models of walls.
  template <class F>
  [[gnu::always_inline]] inline void for_each_image(Index i, F&& f) const {
    for_each_image_in(stencil_, i, f);
  }
  /// The same within laplacian_stencil().
  template <class F>
  [[gnu::always_inline]] inline void for_each_image_in_laplacian(Index i, F&& f) const {
    for_each_image_in(laplacian_stencil_, i, f);
  }
  /// The neighbours within laplacian_stencil() as the pressure equation takes them.
  decltype(auto) pressure_neighbours() const {
    if constexpr (AddsImages<Walls>) {
      return PressureNeighbours<FlowOperators>{*this};
    } else {
      return laplacian_neighbourhood();
    }
  }

  /// See BulkVolumes.
  const BulkVolumes& bulk_volumes() const noexcept { return bulk_volumes_; }
  /// n_i [-]      (5)
  Real density(Index i) const {
    Real n = neighbourhood_.density(i);
    for_each_image(i, [&](const auto& image) { n += image.weight; });
    if constexpr (!BulkVolumes::are_one) n += bulk_volumes_.own_density(i);
    return n;
  }
  /// n_i/n0 and N_i/N0, where n_i is density(i). With a scheme InMixture, of the neighbours alone,
  /// weighted by their volumes: n_i has the share of the particle itself, which, at a small ε,
  /// would hide that neighbours are missing.
  LocalDensity local_density(Index i, Real n) const {
    if constexpr (BulkVolumes::are_one) {
      Index number = neighbourhood_[i].size();
      for_each_image(i, [&](const auto&) { ++number; });
      return {.density = double(n / stencil_.n0),
              .neighbours = double(number) / double(stencil_.neighbours)};
    } else {
      Real number = 0;
      for_each(i, [&](const auto& j) { number += bulk_volumes_[j.index]; });
      const Real own = bulk_volumes_.own_density(i), own_volume = bulk_volumes_[i] - 1;
      return {.density = double((n - own) / (stencil_.n0 - own)),
              .neighbours = double(number) / double(Real(stencil_.neighbours) - own_volume)};
    }
  }
  /// The velocities u of the neighbours within stencil(), as input of an operator.
  template <class U>
  auto velocities_around(Index i, const U& u) const {
    return [this, i, &u](auto&& f) {
      this->for_each(i, [&](const auto& j) {
        f(j.velocity(u), j.r_ij, j.weight, j.weight_over_square);
      });
    };
  }
  /// ⟨∇²u⟩_i of velocities [1/(m s)]      (6), which keeps momentum
  template <class U>
  [[gnu::flatten]] Vec laplacian(Index i, const U& u) const {
    return mps::laplacian(laplacian_stencil_, Vec(u[i]), [&](auto&& f) {
      for_each_in_laplacian(i, [&](const auto& j) {
        f(j.velocity(u), j.r_ij, bulk_volumes_.of_pair(i, j.index) * j.weight,
          j.weight_over_square);
      });
    });
  }

 private:
  template <class P, class S, class Visible>
  void find(const P& particles, const S& search, const Visible& visible) {
    const VisibleVolumes<Visible, BulkVolumes> seen{visible, bulk_volumes_};
    neighbourhood_.find(particles, search, stencil_, seen);
    if (!shares_neighbourhood()) {
      laplacian_neighbourhood_.find(particles, search, laplacian_stencil_, seen);
    }
  }
  template <class N, class T, class F>
  [[gnu::always_inline]] inline void for_each_in(const N& neighbourhood, const T& stencil, Index i,
                                                 F&& f) const {
    for_each_weighted(neighbourhood, i, stencil,
                      [&](Index j, const Vec& r_ij, Real w, Real w_r2) {
                        f(Neighbour<Dim, Real>{j, r_ij, w, w_r2});
                      });
    for_each_image_in(stencil, i, f);
  }
  template <class T, class F>
  [[gnu::always_inline]] inline void for_each_image_in([[maybe_unused]] const T& stencil,
                                                       [[maybe_unused]] Index i,
                         [[maybe_unused]] F&& f) const {
    if constexpr (AddsImages<Walls>) {
      static_assert(requires { walls_.for_each_image(i, stencil, f); },
                    "mps: for_each_image() of const walls cannot be called with a particle, a "
                    "stencil and a function");
      walls_.for_each_image(i, stencil, f);
    }
  }
  static constexpr bool has_same_weights =
      std::is_same_v<LaplacianOf<Scheme>, KernelLaplacian> ||
      (std::is_same_v<Kernel, LaplacianKernel> && std::is_empty_v<Kernel>);
  // The Laplacian has the weights and the radius of the other operators.
  bool shares_neighbourhood() const noexcept {
    return has_same_weights && stencil_.re == laplacian_stencil_.re;
  }

  Stencil stencil_;
  LaplacianStencil laplacian_stencil_;
  BulkVolumes bulk_volumes_;
  Neighbourhood<Dim, Real> neighbourhood_;            // within stencil_
  Neighbourhood<Dim, Real> laplacian_neighbourhood_;  // within laplacian_stencil_, if it differs
  Walls walls_;
};

}  // namespace silt::mps
