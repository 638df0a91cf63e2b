// SPDX-License-Identifier: MIT
// One particle of a flow with its neighbours, as policies see it from the time at which the
// neighbours are found.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/neighbour.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>
#include <silt/mps/wall/walls.hpp>

#include <utility>

namespace silt::mps {

/// Refers to the particles and to FlowOperators: valid during the call that it is given to. Values
/// of ghosts must be up to date.
template <class Operators, FluidParticles P>
class NeighbourView {
 public:
  static constexpr int dimension = P::dimension;
  using Real = typename P::Real;
  using Vec = silt::Vec<dimension, Real>;
  /// Whether walls add images to the neighbours.
  static constexpr bool has_images = AddsImages<typename Operators::Walls>;
  /// What kinds() returns.
  using Kinds = decltype(std::declval<const P&>().with_ghosts(mps::kind));
  /// What velocities() returns.
  using Velocities = decltype(std::declval<const P&>().with_ghosts(silt::velocity));

  /// The view of particle i.
  NeighbourView(const P& particles, const Operators& operators, Index i)
      : particles_(particles), operators_(operators), index_(i) {}

  /// All particles of the flow.
  const P& particles() const { return particles_; }
  Index index() const { return index_; }
  Kind kind() const { return particles_[mps::kind][index_]; }
  /// Whether all particles have the volume l0^Dim, see BulkVolumes.
  static constexpr bool have_equal_volumes = Operators::BulkVolumes::are_one;
  /// See BulkVolumes::of_pair(), with neighbour j.
  Real of_pair(Index j) const { return operators_.bulk_volumes().of_pair(index_, j); }
  /// Of the particle, over l0^Dim: 1/ε with a scheme InMixture, otherwise 1 [-].
  Real bulk_volume() const { return operators_.bulk_volumes()[index_]; }
  /// What the particle adds to the weights of its neighbours within the stencil of the Laplacian,
  /// see OwnDensity [-]; 0 if all have equal volumes.
  Real own_density_in_laplacian() const {
    return operators_.bulk_volumes().own_density_in_laplacian(index_);
  }
  /// Velocity of the particle [m/s].
  Vec velocity() const { return particles_[silt::velocity][index_]; }
  Real spacing() const { return stencil().spacing; }  ///< l0 [m]

  /// Of density, gradient and divergence.
  const auto& stencil() const { return operators_.stencil(); }
  /// The stencil of the Laplacian.
  const auto& laplacian_stencil() const { return operators_.laplacian_stencil(); }
  /// The neighbours of all particles within stencil().
  const auto& neighbourhood() const { return operators_.neighbourhood(); }

  /// Kinds, and velocities [m/s], of all particles and ghosts.
  Kinds kinds() const { return particles_.with_ghosts(mps::kind); }
  Velocities velocities() const { return particles_.with_ghosts(silt::velocity); }
  /// The owned particle of which a neighbour, with this index, is a ghost or image, or itself.
  Index owner(Index j) const { return particles_.owner(j); }
  Index owner(const auto& neighbour) const { return particles_.owner(neighbour.index); }

  /// f(neighbour) for every neighbour within the stencil, a Neighbour, and for every image that the
  /// walls add.
  template <class F>
  [[gnu::always_inline]] inline void for_each(F&& f) const {
    operators_.for_each(index_, f);
  }
  /// The same within the stencil of the Laplacian.
  template <class F>
  [[gnu::always_inline]] inline void for_each_in_laplacian(F&& f) const {
    operators_.for_each_in_laplacian(index_, f);
  }
  /// Those of for_each(): f(pack) for the particles, a NeighbourPack, and g(image) for the images.
  template <class F, class G>
  [[gnu::always_inline]] inline void for_each_four(F&& f, G&& g) const {
    NeighbourPack<dimension, Real>::for_each(operators_.neighbourhood(), index_, f);
    operators_.for_each_image(index_, g);
  }
  /// The same within the stencil of the Laplacian.
  template <class F, class G>
  [[gnu::always_inline]] inline void for_each_four_in_laplacian(F&& f, G&& g) const {
    NeighbourPack<dimension, Real>::for_each(operators_.laplacian_neighbourhood(), index_, f);
    operators_.for_each_image_in_laplacian(index_, g);
  }
  /// f(normal, height) for every plane of a wall of faces of which a point is straight below the
  /// particle, within the effective radius: its unit normal towards the particle, whose distance
  /// from it is the height [m]. Or f(normal, height, velocity), with that of the wall [m/s].
  template <class F>
  void for_each_wall(F&& f) const {
    static_assert(requires { operators_.walls().for_each_wall(index_, f); },
                  "mps: these walls have no faces with a distance; use ImageWalls");
    operators_.walls().for_each_wall(index_, f);
  }
  /// Whether is(neighbour) is true for any of those of for_each(); r_ij and w/r² of particles are
  /// not set.
  template <class F>
  bool any(F&& is) const {
    return operators_.any(index_, is);
  }

  /// The velocities u of the neighbours, as input of an operator.
  template <class U>
  auto values_of(const U& u) const {
    return operators_.velocities_around(index_, u);
  }
  /// ⟨∇·u⟩_i of the velocities u, as the walls define it [1/s].
  template <class U>
  Real divergence(const U& u) const {
    return operators_.walls().divergence(*this, u);
  }

 private:
  const P& particles_;
  const Operators& operators_;
  Index index_;
};

}  // namespace silt::mps
