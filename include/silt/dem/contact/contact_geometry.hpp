// SPDX-License-Identifier: MIT
// Geometry and motion of eight contacts at once, from the rows of their grains.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_CONTACT_GEOMETRY
#define SILT_DEM_CONTACT_CONTACT_GEOMETRY

#include <silt/core/nearest_image.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/wall.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#define SILT_KERNELS <silt/dem/contact/contact_geometry.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// The grains of up to eight pairs, or at up to eight wall elements, and their distances. Into is a
/// LawLanes.
template <class Into>
class ContactGeometry {
  static constexpr int Dim = Into::dimension;
  using Real = typename Into::Real;
  using Row = typename Into::Row;
  using Grains = GrainPacks<Dim, Real>;
  using Vec = silt::Vec<Dim, Real>;
  static constexpr int N = Grains::N;
  static constexpr int packs = lanes / N;
  static constexpr int spin_words = angular_size<Dim>;
  using Pack = typename Grains::Pack;

 public:
  /// Loads the grains first[l] and second[l] into lane l; bit l of the result is set if they touch.
  [[gnu::always_inline]] unsigned find_touching(const Grains& grains,
                                                const NearestImage<Dim, Real>& image,
                                                const std::uint32_t* first,
                                                const std::uint32_t* second) {
    unsigned touching = 0;
    for (int p = 0; p < packs; ++p) {
      grains.load(first + p * N, i_[p]);
      grains.load(second + p * N, j_[p]);
      for (int k = 0; k < Dim; ++k) r_[p][k] = j_[p].x[k] - i_[p].x[k];
      if (image.any()) {
        for (int k = 0; k < Dim; ++k) image.apply(k, r_[p][k]);
      }
      r_squared_[p] = Pack{};
      for (int k = 0; k < Dim; ++k) r_squared_[p] += r_[p][k] * r_[p][k];
      const Pack R = i_[p].R + j_[p].R;
      // Without the root. Then δ ≥ 0, because √(R²) = R also with rounding.
      touching |= simd::less<Real, N>(r_squared_[p], R * R) << (p * N);
    }
    return touching;
  }

  /// The gap in lane l after find_touching() or find_touching_walls().
  struct Gap {
    Real length;            ///< [m]
    Real effective_radius;  ///< R* [m]
  };
  template <bool at_wall>
  Gap gap_of(int lane) const {
    const int p = lane / N;
    const int l = lane % N;
    const Real R_i = i_[p].R[l];
    if constexpr (at_wall) {
      return {-overlap_[p][l], R_i};
    } else {
      const Real R_j = j_[p].R[l];
      return {std::sqrt(Real(r_squared_[p][l])) - (R_i + R_j), R_i * R_j / (R_i + R_j)};
    }
  }

  /// Bit l is set if the grains in lane l overlap by more than this share of the smaller radius, or
  /// if their centres coincide to round-off, so that there is no normal.
  [[gnu::always_inline]] unsigned too_close(Real max_overlap) const {
    constexpr Real round_off = std::numeric_limits<Real>::epsilon();
    unsigned apart = 0;
    for (int p = 0; p < packs; ++p) {
      const Pack& R_i = i_[p].R;
      const Pack& R_j = j_[p].R;
      const Pack sum = R_i + R_j;
      const Pack coincident = round_off * sum;
      const Pack deepest = sum - max_overlap * (R_i < R_j ? R_i : R_j);
      const Pack least = coincident < deepest ? deepest : coincident;
      apart |= simd::less<Real, N>(least * least, r_squared_[p]) << (p * N);
    }
    return ~apart;
  }
  /// The same for grains at walls.
  [[gnu::always_inline]] unsigned too_deep_in_walls(Real max_overlap) const {
    unsigned too_deep = 0;
    for (int p = 0; p < packs; ++p) {
      too_deep |= simd::less<Real, N>(max_overlap * i_[p].R, overlap_[p]) << (p * N);
    }
    return too_deep;
  }

  /// Computes the contacts of the loaded pairs. reduction_per_overlap is the fraction of δ by which
  /// lever arms are shorter than R.
  [[gnu::always_inline]] void compute_pairs(const Grains& grains, const std::uint32_t* first,
                                            const std::uint32_t* second, Real reduction_per_overlap,
                                            Into& into) const {
    for (int p = 0; p < packs; ++p) {
      typename Grains::Motion i, j;
      grains.load(first + p * N, i);
      grains.load(second + p * N, j);
      const Pack& m_i = Grains::mass_of(i_[p], i);
      const Pack& m_j = Grains::mass_of(j_[p], j);
      const Pack m = m_i + m_j;
      const Pack R = i_[p].R + j_[p].R;
      const Pack distance = simd::square_root<Real, N>(r_squared_[p]);
      const Pack overlap = R - distance;
      // One division for 1/r, 1/m and 1/R, because divisions limit the speed of this loop.
      const Pack per_all = 1 / (distance * (m * R));
      const Pack against_r = -(m * R) * per_all;
      Pack n[Dim];
      for (int k = 0; k < Dim; ++k) n[k] = r_[p][k] * against_r;
      const Pack arm_reduction = reduction_per_overlap * overlap;
      Pack u[Dim], u_j[Dim];
      surface_velocity(i, arm_reduction - i_[p].R, n, u);
      surface_velocity(j, j_[p].R - arm_reduction, n, u_j);
      for (int k = 0; k < Dim; ++k) u[k] -= u_j[k];
      if constexpr (Row::has_couple) {
        for (int k = 0; k < spin_words; ++k) {
          simd::store<Real, N>(into.relative_spin[k] + p * N, i.w[k] - j.w[k]);
        }
      }
      const Pack r_per_all = distance * per_all;
      store(p, n, overlap, u, arm_reduction, m_i * m_j * (R * r_per_all),
            i_[p].R * j_[p].R * (m * r_per_all), into);
    }
  }

  /// The same for grain first[l] and wall element second[l]; nearest(element, x) is the nearest
  /// point. Stores the normals.
  template <class Nearest>
  unsigned find_touching_walls(const Grains& grains, const std::uint32_t* first,
                               const std::uint32_t* second, Nearest&& nearest, Into& into) {
    unsigned touching = 0;
    for (int p = 0; p < packs; ++p) {
      grains.load(first + p * N, i_[p]);
      Real overlaps[N];
      for (int lane = 0; lane < N; ++lane) {
        Vec x;
        for (int k = 0; k < Dim; ++k) x[k] = i_[p].x[k][lane];
        const NearestPoint<Dim, Real> at = nearest(second[p * N + lane], x);
        for (int k = 0; k < Dim; ++k) into.row[Row::n + k][p * N + lane] = at.normal[k];
        overlaps[lane] = i_[p].R[lane] - at.distance;
      }
      overlap_[p] = simd::load<Real, N>(overlaps);
      touching |= simd::less<Real, N>(Pack{}, overlap_[p]) << (p * N);
    }
    return touching;
  }

  /// Computes the contacts of the loaded grains with walls. velocity(element) is the RigidVelocity
  /// of the wall; `nullptr` if no wall moves.
  template <class Velocity>
  void compute_walls(const Grains& grains, const std::uint32_t* first,
                     [[maybe_unused]] const std::uint32_t* second, Real reduction_per_overlap,
                     [[maybe_unused]] Velocity&& velocity, Into& into) const {
    for (int p = 0; p < packs; ++p) {
      typename Grains::Motion i;
      grains.load(first + p * N, i);
      Pack n[Dim];
      for (int k = 0; k < Dim; ++k) n[k] = simd::load<Real, N>(into.row[Row::n + k] + p * N);
      const Pack arm_reduction = reduction_per_overlap * overlap_[p];
      Pack u[Dim];
      surface_velocity(i, arm_reduction - i_[p].R, n, u);
      if constexpr (!std::is_null_pointer_v<std::remove_cvref_t<Velocity>>) {
        // Through arrays, because g++ 12 at -O3 miscompiles packs that are written lane by lane.
        Real u_walls[Dim][N], w_walls[spin_words][N];
        for (int lane = 0; lane < N; ++lane) {
          Vec point;
          for (int k = 0; k < Dim; ++k) {
            point[k] = i_[p].x[k][lane] + (arm_reduction[lane] - i_[p].R[lane]) * n[k][lane];
          }
          const RigidVelocity<Dim, Real> wall = velocity(second[p * N + lane]);
          const Vec u_wall = wall.at(point);
          for (int k = 0; k < Dim; ++k) u_walls[k][lane] = u_wall[k];
          for (int k = 0; k < spin_words; ++k) w_walls[k][lane] = component(wall.spin, k);
        }
        for (int k = 0; k < Dim; ++k) u[k] -= simd::load<Real, N>(u_walls[k]);
        for (int k = 0; k < spin_words; ++k) i.w[k] -= simd::load<Real, N>(w_walls[k]);
      }
      if constexpr (Row::has_couple) {
        for (int k = 0; k < spin_words; ++k) {
          simd::store<Real, N>(into.relative_spin[k] + p * N, i.w[k]);
        }
      }
      store(p, n, overlap_[p], u, arm_reduction, Grains::mass_of(i_[p], i), i_[p].R, into);
    }
  }

 private:
  // u = v + a ω × n, with a to the surface along n, (5).
  [[gnu::always_inline]] static void surface_velocity(const typename Grains::Motion& grain,
                                                      const Pack& a, const Pack (&n)[Dim],
                                                      Pack (&u)[Dim]) {
    const auto& w = grain.w;
    if constexpr (Dim == 2) {
      u[0] = grain.v[0] - a * (w[0] * n[1]);
      u[1] = grain.v[1] + a * (w[0] * n[0]);
    } else {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const int m = (k + 2) % 3;
        u[k] = grain.v[k] + a * (w[l] * n[m] - w[m] * n[l]);
      }
    }
  }

  [[gnu::always_inline]] static void store(int p, const Pack (&n)[Dim], const Pack& overlap,
                                           const Pack (&u)[Dim], const Pack& arm_reduction,
                                           const Pack& mass, const Pack& R, Into& into) {
    const auto put = [p](Real(&column)[lanes], const Pack& pack) {
      simd::store<Real, N>(column + p * N, pack);
    };
    for (int k = 0; k < Dim; ++k) put(into.row[Row::n + k], n[k]);
    for (int k = 0; k < Dim; ++k) put(into.velocity[k], u[k]);
    put(into.row[Row::mass], mass);
    put(into.row[Row::radius], R);
    put(into.row[Row::overlap], overlap);
    put(into.row[Row::arm_reduction], arm_reduction);
  }

  typename Grains::Position i_[packs];
  typename Grains::Position j_[packs];
  Pack r_[packs][Dim];
  Pack r_squared_[packs];
  Pack overlap_[packs];  // at walls
};

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
