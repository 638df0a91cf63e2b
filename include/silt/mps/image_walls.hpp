// SPDX-License-Identifier: MIT
// Walls as shapes, in which the fluid is mirrored.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/mirrors.hpp>
#include <silt/geometry/point_checksum.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/image_row.hpp>
#include <silt/mps/neighbour.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/velocity_gradient.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
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

  std::vector<Face<2>> segments;   ///< in 2D, see polyline() in silt/geometry/shapes.hpp
  std::vector<Face<3>> triangles;  ///< in 3D, see faces_of()

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

  /// Throws if a face has a corner that is not finite, or no length or area.
  void check() const {
    for (std::size_t k = 0; k < segments.size(); ++k) {
      require_size("ImageWalls: segment " + std::to_string(k), segments[k]);
    }
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      require_size("ImageWalls: triangle " + std::to_string(k), triangles[k]);
    }
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

  /// Throws if there are faces of the other dimension.
  explicit InFlow(const ImageWalls& walls) {
    if constexpr (Dim == 2) {
      refuse_others("triangles", walls.triangles.size(), "segments");
      faces_ = std::make_shared<const Faces<2>>("ImageWalls", walls.segments);
    } else {
      refuse_others("segments", walls.segments.size(), "triangles");
      faces_ = std::make_shared<const Faces<3>>("ImageWalls", walls.triangles);
    }
  }

  const Faces<Dim>& faces() const noexcept { return *faces_; }

  /// Finds the faces near each particle, and the images that it sees. Throws if a particle is not
  /// fluid or on a face, or if a wall ends at a periodic side.
  template <FluidParticles P, class S, class Operators>
  void locate(const P& particles, const S& search, const Operators& operators) {
    refuse_solids(particles);
    spacing_ = double(operators.stencil().spacing);
    reach_ = double(operators.reach());
    if (particles.box().any_periodic()) check_ends(particles.box());
    const auto x = particles.with_ghosts(position);
    revision_ = 0;  // until all are located
    positions_.resize(x.size());
    for_each(x.size(), [&](Index j) { positions_[j] = x[j].template cast<double>(); });
    around_.resize(particles.size());
    find_faces();
    refuse_particles_on_faces(particles);
    find_those_that_see_all();
    images_.clear(particles.size());
    const auto& stencil = operators.stencil();
    for_each_of_images([&](Index i) {
      if (!sees_all_[i]) find_images(search, stencil, i);
    });
    sizes_ = {double(stencil.re), double(stencil.n0), double(stencil.lambda)};
    owners_.resize(x.size());
    // Apart from each other: one loop would gather the owners of ghosts in vain, which is slow.
    const Index owned = particles.size();
    for_each(owned, [&](Index j) { owners_[j] = std::uint32_t(j); });
    for_each(x.size() - owned,
             [&](Index g) { owners_[owned + g] = std::uint32_t(particles.owner(owned + g)); });
    continuations_.assign(particles.size(), {});
    revision_ = particles.owned_revision();
  }
  /// The share of particle j that particle i sees: see MirrorsAround.
  Real visible_share(Index i, Index j) const {
    return Real(around_[i].visible_share(positions_[j]));
  }
  /// Whether this is 1 for all neighbours.
  bool sees_all(Index i) const { return sees_all_[i]; }

  /// f(normal, height), see NeighbourView::for_each_wall().
  template <class F>
  void for_each_wall(Index i, F&& f) const {
    around_[i].for_each_plane_below([&](const silt::Vec<Dim>& normal, double height) {
      f(Vec(normal.template cast<Real>()), Real(height));
    });
  }

  /// Finds the images of those that see all of their neighbours: the images that they see are of
  /// these, as an image is never closer than its particle.
  template <FluidParticles P, class Operators>
  void find(const P&, const Operators& operators) {
    const auto& stencil = operators.stencil();
    const auto& neighbourhood = double(stencil.re) == reach_ ? operators.neighbourhood()
                                                             : operators.laplacian_neighbourhood();
    for_each_of_images([&](Index i) {
      if (!sees_all_[i]) return;
      const auto row = neighbourhood[i];
      find_images_of({row.index, row.size()}, stencil, i);
    });
  }

  /// The flow of the velocities now, near walls, except on the free surface, beside protruding edges,
  /// around which no linear flow goes, and between walls that are oblique to each other, where half
  /// way to an image in both is not on a wall: continued there, fluid at rest would begin to
  /// circulate. And its gradient where neighbours are missing, for divergence().
  template <FluidParticles P, class Operators>
  void continue_flow(const P& particles, const Operators& operators) {
    const auto u = particles.with_ghosts(velocity);
    const auto on_surface = particles[surface];
    const auto n = particles[number_density];
    for_each(particles.size(), [&](Index i) {
      const bool continues = !around_[i].empty() && !on_surface[i] &&
                             !around_[i].has_protruding_edge() &&
                             around_[i].has_right_angles_only();
      const Real full = operators.stencil().n0;
      const bool misses_others = n[i] >= least_even * full && n[i] < least_full * full;
      if (continues || misses_others) {
        continuations_[i] = {velocity_gradient(u, i, operators), continues, misses_others};
      }
    });
  }

  /// f(image) for the images that particle i sees within a stencil.
  template <class T, class F>
  [[gnu::always_inline]] inline void for_each_image(Index i, const T& stencil, F&& f) const {
    const bool has_weights =
        sizes_ == std::array{double(stencil.re), double(stencil.n0), double(stencil.lambda)};
    const silt::Vec<Dim> x_i = positions_[i];
    images_.for_each(i, [&](const auto& in_mirror, const auto& place) {
      const silt::Vec<Dim> x_j = positions_[place.index];
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
      const Continuation& flow = continuations_[owners_[place.index]];
      f(ImageOfParticle<Dim, Real>{place.index, r_ij, w, w_r2, Real(place.share),
                                   in_mirror.rotation, shift, in_mirror.is_reflection,
                                   flow.continues ? &flow.gradient.value : nullptr});
    });
  }

  /// <∇·u>_i = −(Dn/Dt) / (−1/d Σ w' r), with the sum over the full lattice: a flow without
  /// divergence keeps n, to which fluid and images contribute alike, and so its volume. Below an
  /// even surface, missing neighbours are taken to have the velocities of the linear flow around i.
  template <class View, class U>
  [[gnu::flatten]] Real divergence(const View& at, const U& u) const {
    const auto& stencil = at.stencil();
    static_assert(requires { stencil.slope(Real()); },
                  "mps: ImageWalls need a kernel with a slope, see SmoothKernel");
    const Vec own = u[at.index()];
    Real sum = 0;
    for_each_with_slope(at, [&](const auto& j, Real slope) {
      sum += slope * Vec(j.velocity(u) - own).dot(j.r_ij);
    });
    const Continuation& flow = continuations_[at.index()];
    if (!flow.misses_others || !flow.gradient.is_known) return sum;
    // Σ w_j ∇u r·r over the missing ones: that over the full lattice, ∇·u, less that over the others.
    sum += flow.gradient.value.trace();
    for_each_with_slope(at, [&](const auto& j, Real slope) {
      sum -= slope * multiply<Dim, Real>(flow.gradient.value, j.r_ij).dot(j.r_ij);
    });
    return sum;
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
    // Spacings: half of KeepApart::image_distance = 0.7. Closer, its own image would give a particle
    // of spray so high a density that it had a pressure.
    constexpr double clearance = 0.35;
    return around_[i]
        .before_faces(move.template cast<double>(), clearance * spacing_)
        .template cast<Real>();
  }

  /// Throws if a particle has gone through a face since locate().
  template <FluidParticles P>
  void check_moves(const P& particles) const {
    if (particles.owned_revision() != revision_ || particles.size() != around_.size()) return;
    const auto x = particles[position];
    const NearestImage nearest(particles.box());
    const Index i = first_where(particles.size(), [&](Index k) {
      if (around_[k].empty()) return false;
      const Vec move = nearest(x[k] - positions_[k].template cast<Real>());
      return !(around_[k].visible_share(positions_[k] + move.template cast<double>()) > 0);
    });
    if (i == no_index) return;
    fail("ImageWalls: a particle went through a wall, from " + to_text(positions_[i]) + " to " +
             to_text(x[i]) + " m; reduce the time step, or let particles collide with the walls",
         {.particle = i, .id = particles.id(i)});
  }

 private:
  // n/n0 [-] of the second row below an even surface is 0.93. Above these, neighbours are missing by
  // the scatter of their positions only; where more are missing, in splashes, the velocities of the
  // missing ones cannot be told from those of the others, and energy would rise.
  static constexpr Real least_even = Real(0.9);
  static constexpr Real least_full = Real(0.97);

  // f(j, s) for the neighbours and images of a view, with s = −w'/(r slope_sum) times the share that
  // is seen. Roots and quotients first, for many at a time.
  template <class View, class F>
  [[gnu::always_inline]] inline void for_each_with_slope(const View& at, F&& f) const {
    const auto stencil = at.stencil();
    const Index i = at.index();
    const auto& neighbourhood = at.neighbourhood();
    const auto row = neighbourhood[i];
    const Vec x_i = neighbourhood.position_of(i);
    const auto slope_at = [&](Real r) -> Real { return -stencil.slope(r) / (r * stencil.slope_sum); };
    constexpr Index block = 64;
    std::array<Real, block> distances, slopes;
    for (Index from = 0; from < row.size(); from += block) {
      const Index size = std::min(block, row.size() - from);
      const std::uint32_t* const index = row.index + from;
      const float* const weights = row.weight + from;
      for (Index k = 0; k < size; ++k) {
        distances[k] = (neighbourhood.position_of(index[k]) - x_i).squaredNorm();
      }
      for (Index k = 0; k < size; ++k) {
        const Real r = std::sqrt(distances[k]);
        distances[k] = r;
        slopes[k] = slope_at(r);
      }
      if (!sees_all_[i]) {
        for (Index k = 0; k < size; ++k) {
          const Real weight = stencil.weight(distances[k]);
          // The share is else 0/0, and the slope is zero as well.
          slopes[k] = weight > Real(1e-6) ? Real(weights[k]) / weight * slopes[k] : 0;
        }
      }
      for (Index k = 0; k < size; ++k) {
        const Vec r_ij = neighbourhood.position_of(index[k]) - x_i;
        f(Neighbour<Dim, Real>{index[k], r_ij, Real(weights[k]), 0}, slopes[k]);
      }
    }
    for_each_image(i, stencil, [&](const auto& image) {
      f(image, image.share * slope_at(image.r_ij.norm()));
    });
  }

  struct Continuation {
    VelocityGradient<Dim, Real> gradient;
    bool continues = false;      // beyond walls
    bool misses_others = false;  // neighbours are missing
  };

  // Particles that follow each other in memory are mostly close to each other.
  void find_faces() {
    constexpr Index together = 16;
    for_each_range<together>(around_.size(), [&](Index first, Index last) {
      const Index size = last - first;
      MirrorsAround<Dim>::find_all(*faces_, {positions_.data() + first, size}, reach_,
                                   {around_.data() + first, size});
    });
  }

  // A face hides nothing if all particles near it are on one side of its plane: both ends of a line
  // through it are near.
  void find_those_that_see_all() {
    sides_.assign(faces_->elements().size(), 0);
    const auto add = [&](const silt::Vec<Dim>& x, std::uint32_t k) {
      const std::uint8_t side = (*faces_)[k].height(x) > 0 ? 1 : 2;
      const std::atomic_ref sides(sides_[k]);
      if ((sides.load(std::memory_order_relaxed) & side) == 0) {
        sides.fetch_or(side, std::memory_order_relaxed);
      }
    };
    for_each(around_.size(), [&](Index i) {
      for (const std::uint32_t k : around_[i].faces()) add(positions_[i], k);
    });
    for_each(positions_.size() - around_.size(), [&](Index k) {
      const silt::Vec<Dim>& ghost = positions_[around_.size() + k];
      faces_->for_each_near(ghost, reach_, [&](std::uint32_t face) { add(ghost, face); });
    });
    sees_all_.resize(around_.size());
    for_each(around_.size(), [&](Index i) {
      constexpr std::uint8_t both = 3;
      sees_all_[i] = std::ranges::none_of(around_[i].faces(),
                                          [&](std::uint32_t k) { return sides_[k] == both; });
    });
  }

  // f(i) for those near faces, in parallel as images_ allows.
  template <class F>
  void for_each_of_images(F&& f) {
    for_each_range<ImageRows<Dim, Real>::together>(around_.size(), [&](Index first, Index last) {
      for (Index i = first; i < last; ++i) {
        if (!around_[i].empty()) f(i);
      }
    });
  }

  // Among the particles that the search finds, those that i does not see as well: it may see their
  // images.
  template <class S, class T>
  void find_images(const S& search, const T& stencil, Index i) {
    static thread_local std::vector<std::uint32_t> candidates;  // keeps its capacity
    candidates.clear();
    search.for_each_neighbour(
        i, [](Index j, const auto&, auto) { candidates.push_back(std::uint32_t(j)); });
    find_images_of(candidates, stencil, i);
  }
  // The images of i itself and of these particles.
  template <class T>
  void find_images_of(std::span<const std::uint32_t> others, const T& stencil, Index i) {
    images_.begin_row(i);
    const silt::Vec<Dim> x_i = positions_[i];
    const double reach2 = squared(reach_);
    static thread_local std::vector<silt::Vec<Dim>> points;  // keeps its capacity
    points.assign(1, x_i);
    for (const std::uint32_t j : others) points.push_back(positions_[j]);
    around_[i].for_each_mirror(points, [&](const Mirror<Dim>& mirror, const auto& share_of) {
      // From the image of x_i, the particles are as far as their images from x_i, to round-off.
      const silt::Vec<Dim> observer = mirror.inverse()(x_i);
      const double clearly_beyond = 1.1 * reach2;
      for (std::size_t k = 0; k < points.size(); ++k) {
        if ((points[k] - observer).squaredNorm() > clearly_beyond) continue;
        const silt::Vec<Dim> r_ij = mirror(points[k]) - x_i;
        const double r2 = r_ij.squaredNorm();
        if (!(r2 < reach2)) continue;
        const double share = share_of(points[k]);
        if (share > 0) images_.add(i, k == 0 ? i : others[k - 1], share, Real(r2), stencil);
      }
      images_.end_mirror(i, mirror);
    });
  }

  static void refuse_others(const std::string& others, std::size_t number,
                            const std::string& those_of_flow) {
    if (number == 0) return;
    fail("ImageWalls: " + others + " = " + std::to_string(number) + " faces in a flow in " +
         std::to_string(Dim) + "D, whose walls are " + those_of_flow + "; remove them");
  }
  template <class P>
  static void refuse_solids(const P& particles) {
    const auto kinds = particles[kind];
    const Index i = first_where(particles.size(), [&](Index k) { return kinds[k] != Kind::fluid; });
    if (i == no_index) return;
    fail("ImageWalls: a particle is of a wall, but these walls are faces; remove all wall and "
         "dummy particles, or use a scheme for them, such as mps::RecommendedForWallParticles; "
         "make_tank<Scheme, Dim>() makes a tank for either",
         {.particle = i, .id = particles.id(i)});
  }
  // Its image would be at the same position.
  template <class P>
  void refuse_particles_on_faces(const P& particles) const {
    constexpr double closest = 1e-3;  // spacings
    const Index i = first_where(particles.size(), [&](Index k) {
      return around_[k].distance() < closest * spacing_;
    });
    if (i == no_index) return;
    fail("ImageWalls: a particle at " + to_text(positions_[i]) + " m has a distance of " +
             to_text(around_[i].distance()) + " m from a wall; begin with half a spacing",
         {.particle = i, .id = particles.id(i)});
  }
  // Fluid sees beyond a periodic side, where a wall that ends at it has no copies.
  void check_ends(const Box<Dim, Real>& box) const {
    for (const auto& element : faces_->elements()) {
      for (int k = 0; k < Dim; ++k) {
        if (!element.is_rim[std::size_t(k)]) continue;
        for (int axis = 0; axis < Dim; ++axis) {
          if (!box.periodic[std::size_t(axis)]) continue;
          const double x = element.face.corners[std::size_t(k)][axis];
          const double lower = double(box.lower[axis]), upper = double(box.upper[axis]);
          const double beyond = std::max(lower - x, x - upper);
          if (beyond < -1e-9 * (upper - lower) || beyond >= reach_) continue;
          fail("ImageWalls: a wall ends at " + to_text(element.face.corners[std::size_t(k)]) +
               " m, at a periodic side of the box; let it extend beyond by at least " +
               to_text(reach_) + " m");
        }
      }
    }
  }

  std::shared_ptr<const Faces<Dim>> faces_;  // which around_ refers to
  double reach_ = 0;                       // of the operators [m]
  double spacing_ = 0;                     // l0 [m]
  std::vector<silt::Vec<Dim>> positions_;  // with ghosts
  std::uint64_t revision_ = 0;             // of the particles at these positions
  std::vector<MirrorsAround<Dim>> around_;
  std::vector<std::uint8_t> sides_;     // of each face that have particles near it, as bits
  std::vector<std::uint8_t> sees_all_;  // of each particle: no face hides a neighbour
  ImageRows<Dim, Real> images_;
  std::array<double, 3> sizes_{};      // re, n0 and λ of the stencil of their weights
  std::vector<std::uint32_t> owners_;  // with ghosts
  std::vector<Continuation> continuations_;
};

}  // namespace silt::mps
