// SPDX-License-Identifier: MIT
// Images of particles in walls, and those that a particle sees.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/mirrors.hpp>
#include <silt/mps/fluid.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace silt::mps {

/// The image of a particle in walls, as the sums over neighbours see it.
template <int Dim, class RealType>
struct ImageOfParticle {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;
  static constexpr bool is_image = true;

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

  Kind kind(const auto&) const { return Kind::dummy; }
  Vec mirrored(const auto& u) const { return multiply<Dim, Real>(rotation, Vec(u[index])); }
  /// That of a flow that sticks to the walls.
  Vec sticking(const auto& u) const { return is_reflection ? Vec(-u[index]) : Vec(u[index]); }
  bool continues_flow() const { return gradient != nullptr; }
  /// Mirrored, without the jump that the flow towards the wall then has there.
  Vec velocity(const auto& u) const {
    if (!continues_flow()) return mirrored(u);
    const Vec at_wall = half_way(u);
    return mirrored(u) + at_wall - multiply<Dim, Real>(rotation, at_wall);
  }
  Real rise_along(const auto& u) const { return half_way(u).dot(shift); }
  Real rise(const Vec& of_pressure) const { return of_pressure.dot(shift); }

 private:
  Vec half_way(const auto& u) const {
    return u[index] + multiply<Dim, Real>(*gradient, Vec(shift / 2));
  }
};

/// The images that a particle sees, mirror by mirror, with their weights in one stencil. Positions are
/// computed from those of the particles: sums over stored ones would wait for memory.
template <int Dim, class RealType>
class ImageRow {
 public:
  using Real = RealType;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;

  struct Place {
    std::uint32_t index;  // of the particle
    float share;          // that is seen
    Real weight;          // 0 beyond the effective radius
    Real weight_over_square;
  };
  struct MirrorOfRow {
    Mirror<Dim> mirror;
    Matrix rotation;
    bool is_reflection;
    std::uint32_t end;  // of its places
  };

  void clear() {
    mirrors_.clear();
    places_.clear();
  }
  /// Adds an image in the next mirror, at a distance whose square is r2.
  template <class T>
  void add(Index j, double share, Real r2, const T& stencil) {
    const Real w = r2 < squared(stencil.re) ? Real(share) * stencil.weight(std::sqrt(r2)) : 0;
    places_.push_back({static_cast<std::uint32_t>(j), static_cast<float>(share), w, w / r2});
  }
  /// Ends the images in a mirror.
  void end(const Mirror<Dim>& mirror) {
    mirrors_.push_back({mirror, mirror.rotation.template cast<Real>(), mirror.rotation.determinant() < 0,
                        static_cast<std::uint32_t>(places_.size())});
  }

  const std::vector<MirrorOfRow>& mirrors() const { return mirrors_; }
  const std::vector<Place>& places() const { return places_; }

 private:
  std::vector<MirrorOfRow> mirrors_;
  std::vector<Place> places_;
};

}  // namespace silt::mps
