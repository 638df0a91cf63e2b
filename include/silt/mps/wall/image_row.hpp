// SPDX-License-Identifier: MIT
// Images of particles in walls, and those that a particle sees.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/mirrors.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt::mps {

/// What walls that move add to the image of a particle.
template <int Dim, class Real>
struct MotionOfImage {
  Vec<Dim, Real> velocity;      ///< to the mirrored velocity [m/s]
  Vec<Dim, Real> sticking;      ///< to that in a flow that sticks to the walls [m/s]
  Vec<Dim, Real> acceleration;  ///< its change in the last step, over Δt [m/s²]
};

/// The image of a particle in walls, as the sums over neighbours see it.
template <int Dim, class RealType>
struct ImageOfParticle {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;
  static constexpr bool is_image = true;  ///< see AddsImages

  Index index;              ///< of the particle
  const Vec& r_ij;          ///< [m]
  Real weight;              ///< w [-]
  Real weight_over_square;  ///< w/r² [1/m²]
  Real share;               ///< of it that is seen, a factor of these [-]
  const Matrix& rotation;   ///< of vectors
  const Vec& shift;         ///< from the particle to its image [m]
  bool is_reflection;       ///< by an odd number of faces
  /// ∇u at the particle, ∂u_a/∂x_b [1/s]; null if the flow is not continued.
  const Matrix* gradient;
  const MotionOfImage<Dim, Real>* motion;  ///< null if the walls are at rest

  /// In sums over kinds it counts as a dummy.
  Kind kind(const auto&) const { return Kind::dummy; }
  /// The mirrored velocity, with which particles collide [m/s].
  Vec mirrored(const auto& u) const {
    const Vec of_walls_at_rest = multiply<Dim, Real>(rotation, Vec(u[index]));
    return motion ? Vec(of_walls_at_rest + motion->velocity) : of_walls_at_rest;
  }
  /// The velocity [m/s] in a flow that sticks to the walls.
  Vec sticking(const auto& u) const {
    const Vec of_walls_at_rest = is_reflection ? Vec(-u[index]) : Vec(u[index]);
    return motion ? Vec(of_walls_at_rest + motion->sticking) : of_walls_at_rest;
  }
  /// Whether velocity(u) is that of the flow continued beyond the wall.
  bool continues_flow() const { return gradient != nullptr; }
  /// The mirrored velocity [m/s], without the jump that the flow towards the wall then has there.
  Vec velocity(const auto& u) const {
    if (!continues_flow()) return mirrored(u);
    const Vec at_wall = half_way(u);
    // The motion of the walls would cancel.
    return multiply<Dim, Real>(rotation, Vec(u[index])) + at_wall -
           multiply<Dim, Real>(rotation, at_wall);
  }
  /// ∫u·dx in the continued flow relative to the walls, if there is one, from the particle to its
  /// image [m²/s].
  Real rise_along(const auto& u) const {
    const Vec at_wall = half_way(u);
    return motion ? Vec(at_wall - motion->velocity / 2).dot(shift) : at_wall.dot(shift);
  }
  /// Its pressure above that of the particle [Pa], where fluid of this density [kg/m³] moves with
  /// the walls, for its weight per volume [Pa/m].
  Real rise(const Vec& of_weight, Real density) const {
    if (!motion) return of_weight.dot(shift);
    return Vec(of_weight - density / 2 * motion->acceleration).dot(shift);
  }

 private:
  Vec half_way(const auto& u) const {
    return u[index] + multiply<Dim, Real>(*gradient, Vec(shift / 2));
  }
};

/// The images that each particle sees, mirror by mirror, with their weights in one stencil. Positions
/// are computed from those of the particles: sums over stored ones would wait for memory. For the same
/// reason, the rows of particles that follow each other are stored together, with each mirror once.
template <int Dim, class RealType>
class ImageRows {
 public:
  using Real = RealType;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;

  /// Rows [k together, (k + 1) together) have to be added by one thread.
  static constexpr Index together = 64;

  /// One image of a row.
  struct Place {
    std::uint32_t index;      ///< of the particle
    float share;              ///< of it that is seen [-]
    Real weight;              ///< w, 0 beyond the effective radius [-]
    Real weight_over_square;  ///< w/r² [1/m²]
  };
  /// A mirror through which particles of a row see images. `rotation` and `is_reflection` are as in
  /// ImageOfParticle.
  struct MirrorOfRow {
    Mirror<Dim> mirror;
    Matrix rotation;
    bool is_reflection;
    bool moves;            ///< whether a wall of it does
    std::uint32_t motion;  ///< its number, if it moves
  };

  /// What the motion of a mirror of row i, by its number, adds to the image of x. Not inlined: sums
  /// over images are compiled many times, and few images move.
  [[gnu::noinline]] void find_motion(Index i, std::uint32_t motion, const Vec<Dim>& x,
                                     MotionOfImage<Dim, Real>& found) const {
    const MotionOfMirror<Dim>& of_mirror = sets_[i / together].motions[motion];
    found.velocity = of_mirror.slip.at(x).template cast<Real>();
    found.sticking = of_mirror.stick.at(x).template cast<Real>();
    found.acceleration = of_mirror.change.at(x).template cast<Real>();
  }

  /// All rows are empty from now on.
  void clear(Index rows) {
    rows_.assign(rows, Row{});
    sets_.resize((rows + together - 1) / together);
    for (Set& set : sets_) {
      set.mirrors.clear();
      set.motions.clear();
      set.parts.clear();
      set.places.clear();
    }
  }
  /// Row i follows.
  void begin_row(Index i) {
    const Set& set = set_of(i);
    rows_[i] = {size_of(set.parts), size_of(set.parts), size_of(set.places)};
  }
  /// Adds an image in the next mirror to row i, at a distance whose square is r2 [m²].
  template <class T>
  void add(Index i, Index j, double share, Real r2, const T& stencil) {
    const Real w = r2 < squared(stencil.re) ? Real(share) * stencil.weight(std::sqrt(r2)) : 0;
    set_of(i).places.push_back(
        {static_cast<std::uint32_t>(j), static_cast<float>(share), w, w / r2});
  }
  /// Ends the images in a mirror, which moves like this; null: at rest.
  void end_mirror(Index i, const Mirror<Dim>& mirror, const MotionOfMirror<Dim>* motion) {
    Set& set = set_of(i);
    Row& row = rows_[i];
    const std::uint32_t before = row.first == row.end ? row.places : set.parts[row.end - 1].end;
    const std::uint32_t end = size_of(set.places);
    if (end == before) return;
    set.parts.push_back({number_of(set, mirror, motion), end});
    ++row.end;
  }

  /// f(mirror, place) for each image.
  template <class F>
  [[gnu::always_inline]] inline void for_each(Index i, F&& f) const {
    const Row row = rows_[i];
    if (row.first == row.end) return;
    const Set& set = sets_[i / together];
    const Place* place = set.places.data() + row.places;
    for (std::uint32_t p = row.first; p < row.end; ++p) {
      const MirrorOfRow& mirror = set.mirrors[set.parts[p].mirror];
      const Place* const end = set.places.data() + set.parts[p].end;
      for (; place < end; ++place) f(mirror, *place);
    }
  }

 private:
  struct Row {
    std::uint32_t first = 0;   // of its parts
    std::uint32_t end = 0;     // of its parts
    std::uint32_t places = 0;  // the first of its places
  };
  // What a row has in one mirror.
  struct Part {
    std::uint32_t mirror;
    std::uint32_t end;  // of its places
  };
  struct Set {
    Buffer<MirrorOfRow> mirrors;
    Buffer<MotionOfMirror<Dim>> motions;
    Buffer<Part> parts;
    Buffer<Place> places;
  };

  template <class T>
  static std::uint32_t size_of(const Buffer<T>& values) {
    return static_cast<std::uint32_t>(values.size());
  }
  Set& set_of(Index i) { return sets_[i / together]; }

  static std::uint32_t number_of(Set& set, const Mirror<Dim>& mirror,
                                 const MotionOfMirror<Dim>* motion) {
    const auto moves_alike = [&](const MirrorOfRow& known) {
      if (known.moves != (motion != nullptr)) return false;
      return motion == nullptr || set.motions[known.motion] == *motion;
    };
    // Those that were added last are the most likely.
    constexpr std::uint32_t most = 8;
    const std::uint32_t size = size_of(set.mirrors);
    for (std::uint32_t k = 0; k < std::min(most, size); ++k) {
      const MirrorOfRow& known = set.mirrors[size - 1 - k];
      if (known.mirror.translation == mirror.translation &&
          known.mirror.rotation == mirror.rotation && moves_alike(known)) {
        return size - 1 - k;
      }
    }
    set.mirrors.push_back({mirror, mirror.rotation.template cast<Real>(), mirror.is_reflection(),
                           motion != nullptr, size_of(set.motions)});
    if (motion) set.motions.push_back(*motion);
    return size;
  }

  Buffer<Row> rows_;
  Buffer<Set> sets_;
};

}  // namespace silt::mps
