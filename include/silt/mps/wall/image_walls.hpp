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
#include <silt/mps/wall/flow_of_step.hpp>
#include <silt/mps/wall/image_row.hpp>
#include <silt/mps/wall/image_search.hpp>
#include <silt/mps/wall/image_wall_checks.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace silt::mps {

/// Walls without wall particles, at rest or moving, along which fluid slips unless the policy
/// `wall_stress` lets it stick: segments in 2D, triangles in 3D.
/// What a particle sees through a face is the fluid before it, mirrored, so that density,
/// divergence, Laplacian and gradient are those of a fluid that continues beyond the wall. Its flow
/// towards the wall is continued linearly, and stopped by the pressure. Images of images, as in
/// corners and between close walls, are included; faces hide the particles behind them. Faces have
/// two sides, and fluid may be on both.
///
/// All particles must be fluid. In a periodic box, a wall has to extend beyond the sides by the
/// effective radius. The kernel needs a slope: see SmoothKernel. Between acute faces, a particle
/// sees at most 1024 images of another one.
struct ImageWalls {
  static constexpr bool all_have_pressure = true;  ///< see AllHavePressure

  std::vector<Face<2>> segments = {};   ///< in 2D, see polyline() in silt/geometry/shapes.hpp
  std::vector<Face<3>> triangles = {};  ///< in 3D, see faces_of()
  AnyMovingWalls<2> moving_2d = {};     ///< in 2D, further walls that move: MovingWalls
  AnyMovingWalls<3> moving_3d = {};     ///< in 3D
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

  /// Those of the dimension.
  template <int Dim>
  const AnyMovingWalls<Dim>& moving() const {
    if constexpr (Dim == 2) return moving_2d;
    if constexpr (Dim == 3) return moving_3d;
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
    moving_2d.add_to(all);
    moving_3d.add_to(all);
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
      : near_(faces_of_flow(walls)),
        lets_fluid_fall_(walls.let_fluid_fall),
        motions_(walls.template moving<Dim>().mover()) {
    if (!motions_.empty()) motions_->place(near_.moving_faces());
  }

  /// Where they were at the beginning of the last step.
  const Faces<Dim>& faces() const noexcept { return near_.faces(); }
  /// f(face, group, velocity) for each face where it is now: after the last step, or before the
  /// first one. Group 0 is at rest; then follow the moving faces, and the bodies. The velocity
  /// [m/s] is the mean one in the last step, at the middle of the face.
  template <class F>
  void for_each_face(F&& f) const {
    for (const auto& element : faces().elements()) {
      Face<Dim> face = element.face;
      silt::Vec<Dim> middle = silt::Vec<Dim>::Zero();
      for (silt::Vec<Dim>& corner : face.corners) {
        middle += corner / Dim;
        if (element.group > 0) corner = faces().step_of(element.group).move.x_of(corner);
      }
      f(face, element.group, motions_.velocity_at(element.group, middle));
    }
  }

  /// Places walls that move where they are at the beginning of a step, at a time [s], of this
  /// length [s]. Spacing l0 in [m].
  void begin_step(double time, double time_step, double spacing) {
    if (!motions_.empty()) motions_->begin_step(time, time_step, spacing, near_.moving_faces());
  }

  /// The bodies, in the order of MovingWalls::bodies. Throws if there are no moving walls.
  const std::vector<BodyInFlow<Dim>>& bodies() const {
    if (motions_.empty()) {
      fail({"ImageWalls: there are no bodies; give moving_", Dim, "d = MovingWalls<", Dim,
            ">{.bodies = …}"});
    }
    return motions_->bodies();
  }
  /// See WallMover::change_velocities(): the flow's density [kg/m³], gravity and body force [m/s²], and
  /// when the step began [s].
  template <FluidParticles P, class Settings>
  [[gnu::cold]] bool change_velocities(const P& particles,
                                       const Buffer<MomentumChange<Dim>>& changes,
                                       const Settings& settings, double time, double time_step) {
    if (motions_.empty() || motions_->number_of_bodies() == 0) return false;
    bool is_changed = false;
    detail::with_flow_of_step(particles, near_, changes, settings, spacing_, {time, time_step},
                              [&](const FlowOfStep<Dim>& flow) {
                                is_changed =
                                    motions_->change_velocities(flow, near_.moving_faces());
                              });
    return is_changed;
  }
  /// See WallMover::end_step().
  template <FluidParticles P, class Settings>
  void end_step(const P& particles, const Buffer<MomentumChange<Dim>>& changes,
                const Settings& settings, double time, double time_step) {
    if (motions_.empty()) return;
    detail::with_flow_of_step(particles, near_, changes, settings, spacing_, {time, time_step},
                              [&](const FlowOfStep<Dim>& flow) { motions_->end_step(flow); });
  }
  /// See WallMover::loads(); of walls at rest none.
  template <FluidParticles P, class Settings>
  [[gnu::cold]] std::vector<BodyLoad<Dim>> loads_on_moving(
      const P& particles, const Buffer<MomentumChange<Dim>>& changes, const Settings& settings,
      double time_step) const {
    std::vector<BodyLoad<Dim>> loads;
    if (motions_.empty()) return loads;
    detail::with_flow_of_step(particles, near_, changes, settings, spacing_,
                              {.time_step = time_step},
                              [&](const FlowOfStep<Dim>& flow) { loads = motions_->loads(flow); });
    return loads;
  }
  /// Of the walls that move, from a time [s] on: see WallMover::longest_step(); the distance is in
  /// [m].
  double longest_step(double time, double distance) const {
    if (motions_.empty()) return std::numeric_limits<double>::infinity();
    return motions_->longest_step(time, distance);
  }
  /// Of the fastest wall in the step [m/s].
  double max_speed() const { return motions_.empty() ? 0 : motions_->max_speed(); }
  void save() { motions_.save(); }
  void restore() noexcept {
    motions_.restore();
    if (!motions_.empty()) motions_->place(near_.moving_faces());
  }
  /// What the next step needs of the last one, for a checkpoint.
  template <class Archive>
  void transfer(Archive& archive) {
    motions_.transfer(archive);
    if constexpr (Archive::reads) {
      if (!motions_.empty()) motions_->place(near_.moving_faces());
    }
  }
  /// The number of bodies, whose groups of faces are the last ones.
  std::size_t number_of_bodies() const {
    return motions_.empty() ? 0 : motions_->number_of_bodies();
  }

  /// Finds the faces near each particle, and the images that it sees. Throws if a particle is not
  /// fluid or on a face, or if a wall ends, or a body is, at a periodic side.
  template <FluidParticles P, class S, class Operators>
  void locate(const P& particles, const S& search, const Operators& operators) {
    detail::require_fluid_only(particles);
    spacing_ = double(operators.stencil().spacing);
    const double reach = double(operators.reach());
    if (particles.box().any_periodic()) {
      if (!motions_.empty()) {
        detail::require_bodies_off_sides(near_.faces(), *motions_, particles.box(), reach);
      }
      detail::require_walls_beyond_sides(near_.faces(), particles.box(), reach);
    }
    const auto x = particles.with_ghosts(position);
    revision_ = 0;  // until all are located
    near_.find(x, particles.size(), reach);
    if (near_.faces().move()) detail::find_dry_groups(particles, near_);
    detail::require_distance_from_faces(particles, near_, spacing_);
    images_.clear(particles.size());
    const auto& stencil = operators.stencil();
    for_each_of_images([&](Index i) {
      if (!near_.sees_all(i)) find_images(search, operators, i);
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
  /// Before the first step: throws if fluid is in a solid body, or if it would fall freely, unless that
  /// is allowed. Gravity is in [m/s²].
  template <FluidParticles P, class Operators>
  void check_start(const P& particles, const Operators& operators,
                   const silt::Vec<Dim>& gravity) const {
    if (!motions_.empty()) detail::require_no_fluid_in_bodies(particles, *motions_);
    if (lets_fluid_fall_) return;
    detail::require_held(particles, operators.neighbourhood(), near_.faces(), gravity);
  }
  /// The share [-] of particle j that particle i sees: see MirrorsAround.
  Real visible_share(Index i, Index j) const {
    return Real(near_[i].visible_share(near_.position(j)));
  }
  /// Whether this is 1 for all neighbours.
  bool sees_all(Index i) const { return near_.sees_all(i); }
  /// The faces around each particle.
  const FacesNearParticles<Dim>& near() const { return near_; }

  /// f(normal, height) or f(normal, height, velocity), see NeighbourView::for_each_wall().
  template <class F>
  void for_each_wall(Index i, F&& f) const {
    near_[i].for_each_plane_below(
        [&](const silt::Vec<Dim>& normal, double height, std::uint32_t group) {
          const Vec n = normal.template cast<Real>();
          if constexpr (std::invocable<F&, const Vec&, Real, const Vec&>) {
            const silt::Vec<Dim> foot = near_.position(i) - height * normal;
            const silt::Vec<Dim> of_wall = motions_.velocity_at(group, foot);
            f(n, Real(height), Vec(of_wall.template cast<Real>()));
          } else {
            f(n, Real(height));
          }
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
      add_images(images_, near_, i, std::span<const std::uint32_t>(row.index, row.size()), stencil,
                 motions_, operators.bulk_volumes());
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
      MotionOfImage<Dim, Real> motion;
      if (in_mirror.moves) images_.find_motion(i, in_mirror.motion, x_j, motion);
      f(ImageOfParticle<Dim, Real>{place.index, r_ij, w, w_r2, Real(place.share),
                                   in_mirror.rotation, shift, in_mirror.is_reflection,
                                   flow.is_beyond_walls ? &flow.gradient.value : nullptr,
                                   in_mirror.moves ? &motion : nullptr});
    });
  }

  /// See divergence_with_images().
  template <class View, class U>
  Real divergence(const View& at, const U& u) const {
    return divergence_with_images<Dim, Real>(at, *this, flow_[at.index()], u);
  }
  /// Whether faces are near particle i.
  bool are_near(Index i) const { return near_.has_faces(i); }
  /// Whether there are walls that move.
  bool move() const { return !motions_.empty(); }
  /// See power_of_walls().
  template <class View, class Pressures, class Rise>
  double power(const View& at, const Pressures& p, const Rise& rise) const {
    return near_.has_faces(at.index()) ? power_of_walls<Dim, Real>(at, *this, p, rise) : 0;
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

  /// The move [m] of particle i, ended before it goes into a wall, or closer than a clearance
  /// [spacings].
  Vec before_walls(Index i, const Vec& move, double clearance = least_clearance) const {
    if (!near_.has_faces(i)) return move;
    return near_[i]
        .before_faces(move.template cast<double>(), clearance * spacing_)
        .template cast<Real>();
  }

  /// Throws if a particle has gone through a face since locate().
  template <FluidParticles P>
  void check_moves(const P& particles) const {
    if (particles.owned_revision() != revision_ || particles.size() != near_.size()) return;
    detail::require_no_passage(particles, near_,
                               [&](std::uint32_t group) { return motions_->name_of(group); });
  }

 private:
  // Spacings: half of KeepApart::image_distance = 0.7. Closer, its own image would give a particle
  // of spray so high a density that it had a pressure.
  static constexpr double least_clearance = 0.35;

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
  template <class S, class Operators>
  void find_images(const S& search, const Operators& operators, Index i) {
    static thread_local Buffer<std::uint32_t> candidates;  // keeps its capacity
    candidates.clear();
    search.for_each_neighbour(
        i, [](Index j, const auto&, auto) { candidates.push_back(std::uint32_t(j)); });
    add_images(images_, near_, i, std::span<const std::uint32_t>(candidates), operators.stencil(),
               motions_, operators.bulk_volumes());
  }
  static std::shared_ptr<Faces<Dim>> faces_of_flow(const ImageWalls& walls) {
    if constexpr (Dim == 2) {
      refuse_others("triangles", walls.triangles.size(), "segments");
      refuse_others("moving_3d", walls.moving_3d.groups().size(), "moving_2d");
    } else {
      refuse_others("segments", walls.segments.size(), "triangles");
      refuse_others("moving_2d", walls.moving_2d.groups().size(), "moving_3d");
    }
    return std::make_shared<Faces<Dim>>("ImageWalls", walls.template faces<Dim>(),
                                        walls.template moving<Dim>().groups());
  }
  static void refuse_others(const std::string& others, std::size_t number,
                            const std::string& those_of_flow) {
    if (number == 0) return;
    fail({"ImageWalls: ", others, " = ", number,
          others.starts_with("moving") ? " groups" : " faces", " in a flow in ", Dim,
          "D, whose walls are ", those_of_flow, "; remove them"});
  }

  FacesNearParticles<Dim> near_;
  bool lets_fluid_fall_;
  WallMotions<Dim> motions_;
  double spacing_ = 0;          // l0 [m]
  std::uint64_t revision_ = 0;  // of the particles at the positions of near_
  ImageRows<Dim, Real> images_;
  std::array<double, 3> sizes_{};      // re, n0 and λ of the stencil of their weights
  Buffer<std::uint32_t> owners_;       // with ghosts
  ExtrapolatedFlow<Dim, Real> flow_;
};

}  // namespace silt::mps
