// SPDX-License-Identifier: MIT
// Walls as shapes, in which the fluid is mirrored.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/point_checksum.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/neighbourhood.hpp>
#include <silt/mps/wall/divergence_with_images.hpp>
#include <silt/mps/wall/extrapolated_flow.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>
#include <silt/mps/wall/image_row.hpp>
#include <silt/mps/wall/image_search.hpp>
#include <silt/mps/wall/image_wall_checks.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace silt::mps {

/// Walls at rest without wall particles, along which fluid slips: segments in 2D, triangles in 3D.
/// What a particle sees through a face is the fluid before it, mirrored, so that density,
/// divergence, Laplacian and gradient are those of a fluid that continues beyond the wall. Its flow
/// towards the wall is continued linearly, and stopped by the pressure. Images of images, as in
/// corners and between close walls, are included; faces hide the particles behind them. Faces have
/// two sides, and fluid may be on both.
///
/// All particles must be fluid. In a periodic box, a wall has to extend beyond the sides by the
/// effective radius. The kernel needs a slope: see SmoothKernel. Between acute faces, a particle
/// sees at most 256 images of another one.
struct ImageWalls {
  static constexpr bool all_have_pressure = true;  ///< see AllHavePressure

  std::vector<Face<2>> segments = {};   ///< in 2D, see polyline() in silt/geometry/shapes.hpp
  std::vector<Face<3>> triangles = {};  ///< in 3D, see faces_of()
  /// Whether fluid may begin where nothing holds it against gravity. Otherwise the first step
  /// throws if there are no faces, or if no face is below a body of fluid at rest.
  bool let_fluid_fall = false;

  /// Those of the dimension.
  template <int Dim>
  std::vector<Face<Dim>>& faces() {
    if constexpr (Dim == 2) return segments;
    if constexpr (Dim == 3) return triangles;
  }
  template <int Dim>
  const std::vector<Face<Dim>>& faces() const {
    if constexpr (Dim == 2) return segments;
    if constexpr (Dim == 3) return triangles;
  }

  /// Of all corners, for checkpoints.
  std::uint64_t checksum() const {
    PointChecksum all;
    const auto add = [&](const auto& faces) {
      all.add(faces.size());
      for (const auto& face : faces) {
        for (const auto& corner : face.corners) all.add(corner);
      }
    };
    add(segments);
    add(triangles);
    return all.sum();
  }

  template <int Dim, class RealType>
  class InFlow;
};

template <int Dim, class RealType>
class ImageWalls::InFlow {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Throws if there are faces of the other dimension, or if a face has a corner that is not
  /// finite, or no length or area.
  explicit InFlow(const ImageWalls& walls)
      : near_(faces_of_flow(walls)), lets_fluid_fall_(walls.let_fluid_fall) {}

  const Faces<Dim>& faces() const noexcept { return near_.faces(); }

  /// Finds the faces near each particle, and the images that it sees. Throws if a particle is not
  /// fluid or on a face, or if a wall ends at a periodic side.
  template <FluidParticles P, class S, class Operators>
  void locate(const P& particles, const S& search, const Operators& operators) {
    detail::require_fluid_only(particles);
    spacing_ = double(operators.stencil().spacing);
    const double reach = double(operators.reach());
    if (particles.box().any_periodic()) {
      detail::require_walls_beyond_sides(near_.faces(), particles.box(), reach);
    }
    const auto x = particles.with_ghosts(position);
    revision_ = 0;  // until all are located
    near_.find(x, particles.size(), reach);
    detail::require_distance_from_faces(particles, near_, spacing_);
    images_.clear(particles.size());
    const auto& stencil = operators.stencil();
    for_each_of_images([&](Index i) {
      if (!near_.sees_all(i)) find_images(search, stencil, i);
    });
    sizes_ = {double(stencil.re), double(stencil.n0), double(stencil.lambda)};
    owners_.resize(x.size());
    // Apart from each other: one loop would gather the owners of ghosts in vain, which is slow.
    const Index owned = particles.size();
    for_each(owned, [&](Index j) { owners_[j] = std::uint32_t(j); });
    for_each(x.size() - owned,
             [&](Index g) { owners_[owned + g] = std::uint32_t(particles.owner(owned + g)); });
    flow_.clear(particles.local());
    revision_ = particles.owned_revision();
  }
  /// Before the first step: throws if the fluid would fall freely, unless that is allowed. Gravity
  /// is in [m/s²].
  template <FluidParticles P, class Operators>
  void check_start(const P& particles, const Operators& operators,
                   const silt::Vec<Dim>& gravity) const {
    if (lets_fluid_fall_) return;
    detail::require_held(particles, operators.neighbourhood(), near_.faces(), gravity);
  }
  /// The share [-] of particle j that particle i sees: see MirrorsAround.
  Real visible_share(Index i, Index j) const {
    return Real(near_[i].visible_share(near_.position(j)));
  }
  /// Whether this is 1 for all neighbours.
  bool sees_all(Index i) const { return near_.sees_all(i); }

  /// f(normal, height), see NeighbourView::for_each_wall().
  template <class F>
  void for_each_wall(Index i, F&& f) const {
    near_[i].for_each_plane_below([&](const silt::Vec<Dim>& normal, double height) {
      f(Vec(normal.template cast<Real>()), Real(height));
    });
  }

  /// Finds the images of those that see all of their neighbours: the images that they see are of
  /// these, as an image is never closer than its particle.
  template <FluidParticles P, class Operators>
  void find(const P&, const Operators& operators) {
    const auto& stencil = operators.stencil();
    const auto& neighbourhood = double(stencil.re) == near_.reach()
                                    ? operators.neighbourhood()
                                    : operators.laplacian_neighbourhood();
    for_each_of_images([&](Index i) {
      if (!near_.sees_all(i)) return;
      const auto row = neighbourhood[i];
      add_images(images_, near_, i, std::span<const std::uint32_t>(row.index, row.size()), stencil);
    });
  }

  /// Extrapolates the flow of the velocities now beyond walls, see ExtrapolatedFlow.
  template <FluidParticles P, class Operators>
  void continue_flow(const P& particles, const Operators& operators) {
    flow_.find(particles, operators, near_);
  }

  /// f(image) for the images that particle i sees within a stencil.
  template <class T, class F>
  [[gnu::always_inline]] inline void for_each_image(Index i, const T& stencil, F&& f) const {
    const bool has_weights =
        sizes_ == std::array{double(stencil.re), double(stencil.n0), double(stencil.lambda)};
    const silt::Vec<Dim> x_i = near_.position(i);
    images_.for_each(i, [&](const auto& in_mirror, const auto& place) {
      const silt::Vec<Dim> x_j = near_.position(place.index);
      const silt::Vec<Dim> image = in_mirror.mirror(x_j);
      const Vec r_ij = (image - x_i).template cast<Real>();
      Real w = place.weight, w_r2 = place.weight_over_square;
      if (!has_weights) {
        const Real r2 = r_ij.squaredNorm();
        w = r2 < squared(stencil.re) ? Real(place.share) * stencil.weight(std::sqrt(r2)) : 0;
        w_r2 = w / r2;
      }
      if (!(w > 0)) return;
      const Vec shift = (image - x_j).template cast<Real>();
      const auto& flow = flow_[owners_[place.index]];
      f(ImageOfParticle<Dim, Real>{place.index, r_ij, w, w_r2, Real(place.share),
                                   in_mirror.rotation, shift, in_mirror.is_reflection,
                                   flow.is_beyond_walls ? &flow.gradient.value : nullptr});
    });
  }

  /// See divergence_with_images().
  template <class View, class U>
  Real divergence(const View& at, const U& u) const {
    return divergence_with_images<Dim, Real>(at, *this, flow_[at.index()], u);
  }
  bool is_dry(const auto&) const { return false; }
  bool has_pressure(Kind, bool) const { return true; }

  /// A particle collides with images as with particles.
  template <class Pairs, class Model>
  Vec velocity_change(const Pairs& pairs, const Model& collision) const {
    Vec change = Vec::Zero();
    const auto add = [&](const auto& pair, Index) { change += collision.velocity_change(pair); };
    pairs.for_each(add);
    pairs.for_each_image(add);
    return change;
  }

  /// The move [m] of particle i, ended before it goes into a wall.
  Vec before_walls(Index i, const Vec& move) const {
    if (!near_.has_faces(i)) return move;
    // Spacings: half of KeepApart::image_distance = 0.7. Closer, its own image would give a particle
    // of spray so high a density that it had a pressure.
    constexpr double clearance = 0.35;
    return near_[i]
        .before_faces(move.template cast<double>(), clearance * spacing_)
        .template cast<Real>();
  }

  /// Throws if a particle has gone through a face since locate().
  template <FluidParticles P>
  void check_moves(const P& particles) const {
    if (particles.owned_revision() != revision_ || particles.size() != near_.size()) return;
    detail::require_no_passage(particles, near_);
  }

 private:
  // f(i) for those near faces, in parallel as images_ allows.
  template <class F>
  void for_each_of_images(F&& f) {
    for_each_range<ImageRows<Dim, Real>::together>(near_.size(), [&](Index first, Index last) {
      run_in_space<Dim>([&] {
        for (Index i = first; i < last; ++i) {
          if (near_.has_faces(i)) f(i);
        }
      });
    });
  }

  // Among the particles that the search finds, those that i does not see as well: it may see their
  // images.
  template <class S, class T>
  void find_images(const S& search, const T& stencil, Index i) {
    static thread_local Buffer<std::uint32_t> candidates;  // keeps its capacity
    candidates.clear();
    search.for_each_neighbour(
        i, [](Index j, const auto&, auto) { candidates.push_back(std::uint32_t(j)); });
    add_images(images_, near_, i, std::span<const std::uint32_t>(candidates), stencil);
  }
  static std::shared_ptr<const Faces<Dim>> faces_of_flow(const ImageWalls& walls) {
    if constexpr (Dim == 2) {
      refuse_others("triangles", walls.triangles.size(), "segments");
    } else {
      refuse_others("segments", walls.segments.size(), "triangles");
    }
    return std::make_shared<const Faces<Dim>>("ImageWalls", walls.template faces<Dim>());
  }
  static void refuse_others(const std::string& others, std::size_t number,
                            const std::string& those_of_flow) {
    if (number == 0) return;
    fail({"ImageWalls: ", others, " = ", number, " faces in a flow in ", Dim, "D, whose walls are ",
          those_of_flow, "; remove them"});
  }

  FacesNearParticles<Dim> near_;
  bool lets_fluid_fall_;
  double spacing_ = 0;          // l0 [m]
  std::uint64_t revision_ = 0;  // of the particles at the positions of near_
  ImageRows<Dim, Real> images_;
  std::array<double, 3> sizes_{};      // re, n0 and λ of the stencil of their weights
  Buffer<std::uint32_t> owners_;       // with ghosts
  ExtrapolatedFlow<Dim, Real> flow_;
};

}  // namespace silt::mps
