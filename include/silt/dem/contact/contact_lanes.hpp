// SPDX-License-Identifier: MIT
// Evaluates eight contacts at once: geometry and motion, the law, and the rows to be stored. The
// loops over `lane` are vectorised, including the law's code; see core/lane.hpp.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_row.hpp>
#include <silt/dem/contact/four.hpp>
#include <silt/dem/contact/grain_columns.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <cstdint>
#include <type_traits>

namespace silt::dem {

template <int Dim, class RealType, int history_words, bool has_couple>
class ContactLanes {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Columns = GrainColumns<Dim, Real>;
  using Row = ContactRow<has_couple>;
  /// Size of a history in Reals, rounded up to a multiple of four.
  static constexpr int padded_words = (history_words + 3) / 4 * 4;

  /// Loads the grains first[l] and second[l] into lane l; bit l of the result is set if they touch.
  [[gnu::always_inline]] unsigned look_at(const Columns& grains, const std::uint32_t* first,
                                          const std::uint32_t* second) {
    unsigned touching = 0;
    for (int p = 0; p < packs; ++p) {
      grains.load(first + p * N, i_[p]);
      grains.load(second + p * N, j_[p]);
      Pack r_squared{};
      for (int k = 0; k < Dim; ++k) {
        const Pack r = j_[p].x[k] - i_[p].x[k];
        r_squared += r * r;
      }
      distance_[p] = simd::square_root<Real, N>(r_squared);
      overlap_[p] = i_[p].R + j_[p].R - distance_[p];
      touching |= simd::less<Real, N>(Pack{}, overlap_[p]) << (p * N);
    }
    return touching;
  }

  /// Bit l is set if the centres in lane l coincide.
  unsigned coincident() const {
    unsigned apart = 0;
    for (int p = 0; p < packs; ++p) apart |= simd::less<Real, N>(Pack{}, distance_[p]) << (p * N);
    return ~apart;
  }

  /// Computes the contacts of the loaded pairs. arm_share is the fraction of δ by which lever arms
  /// are shorter than R.
  [[gnu::always_inline]] void meet(const Columns& grains, const std::uint32_t* first,
                                   const std::uint32_t* second, Real arm_share) {
    for (int p = 0; p < packs; ++p) {
      typename Columns::Motion i, j;
      grains.load(first + p * N, i);
      grains.load(second + p * N, j);
      const Pack against_r = -1 / distance_[p];
      Pack n[Dim];
      for (int k = 0; k < Dim; ++k) n[k] = (j_[p].x[k] - i_[p].x[k]) * against_r;
      const Pack shorter = arm_share * overlap_[p];
      Pack u[Dim], u_j[Dim];
      surface_velocity(i, shorter - i_[p].R, n, u);
      surface_velocity(j, j_[p].R - shorter, n, u_j);
      for (int k = 0; k < Dim; ++k) u[k] -= u_j[k];
      if constexpr (has_couple) {
        for (int k = 0; k < spin_words; ++k) put_spin(p, k, i.w[k] - j.w[k]);
      }
      put(p, n, overlap_[p], u, shorter, i.m * j.m / (i.m + j.m),
          i_[p].R * j_[p].R / (i_[p].R + j_[p].R));
    }
  }

  /// The same for grain first[l] and wall element second[l]; nearest(element, x) is the nearest
  /// point.
  template <class Nearest>
  unsigned look_at_walls(const Columns& grains, const std::uint32_t* first,
                         const std::uint32_t* second, Nearest&& nearest) {
    unsigned touching = 0;
    for (int p = 0; p < packs; ++p) {
      grains.load(first + p * N, i_[p]);
      Real overlaps[N];
      for (int lane = 0; lane < N; ++lane) {
        Vec x;
        for (int k = 0; k < Dim; ++k) x[k] = i_[p].x[k][lane];
        const NearestPoint<Dim, Real> at = nearest(second[p * N + lane], x);
        for (int k = 0; k < Dim; ++k) row_[Row::n + k][p * N + lane] = at.normal[k];
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
  void meet_walls(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
                  Real arm_share, [[maybe_unused]] Velocity&& velocity) {
    for (int p = 0; p < packs; ++p) {
      typename Columns::Motion i;
      grains.load(first + p * N, i);
      Pack n[Dim];
      for (int k = 0; k < Dim; ++k) n[k] = simd::load<Real, N>(row_[Row::n + k] + p * N);
      const Pack shorter = arm_share * overlap_[p];
      Pack u[Dim];
      surface_velocity(i, shorter - i_[p].R, n, u);
      if constexpr (!std::is_null_pointer_v<std::remove_cvref_t<Velocity>>) {
        // Through arrays, because g++ 12 at -O3 miscompiles packs that are written lane by lane.
        Real u_walls[Dim][N], w_walls[spin_words][N];
        for (int lane = 0; lane < N; ++lane) {
          Vec point;
          for (int k = 0; k < Dim; ++k) {
            point[k] = i_[p].x[k][lane] + (shorter[lane] - i_[p].R[lane]) * n[k][lane];
          }
          const RigidVelocity<Dim, Real> wall = velocity(second[p * N + lane]);
          const Vec u_wall = wall.at(point);
          for (int k = 0; k < Dim; ++k) u_walls[k][lane] = u_wall[k];
          for (int k = 0; k < spin_words; ++k) w_walls[k][lane] = component(wall.spin, k);
        }
        for (int k = 0; k < Dim; ++k) u[k] -= simd::load<Real, N>(u_walls[k]);
        for (int k = 0; k < spin_words; ++k) i.w[k] -= simd::load<Real, N>(w_walls[k]);
      }
      if constexpr (has_couple) {
        for (int k = 0; k < spin_words; ++k) put_spin(p, k, i.w[k]);
      }
      put(p, n, overlap_[p], u, shorter, i.m, i_[p].R);
    }
  }

  /// Loads the histories; history(lane) points to that of a lane.
  template <class HistoryAt>
  [[gnu::always_inline]] void recall(HistoryAt&& history) {
    for (int p = 0; p < packs; ++p) {
      for (int k = 0; k < history_words; k += 4) {
        Pack four[4];
        columns_from<Real, N>([&](int lane) { return history(p * N + lane) + k; }, four);
        for (int m = 0; m < 4; ++m) simd::store<Real, N>(history_[k + m] + p * N, four[m]);
      }
    }
  }

  /// Evaluates one law for all lanes.
  template <class Law>
  [[gnu::flatten, gnu::noinline]] void ask(const Law& shared, Real dt) {
    const Law law = shared;  // a copy that no store below can change
    SILT_INDEPENDENT_ITERATIONS
    for (int lane = 0; lane < lanes; ++lane) ask<Lane<Real>>(law, dt, lane);
  }

  /// Evaluates a law for one lane: for lanes with different laws, and for laws that support only
  /// one scalar type.
  template <class Scalar = Real, class Law>
  void ask(const Law& law, Real dt, int lane) {
    const auto contact = this->contact<Scalar>(lane, dt);
    if constexpr (history_words == 0) {
      keep(lane, contact, evaluate_law(law, contact));
    } else if constexpr (std::is_same_v<Scalar, Real>) {
      using History = LawHistory<Law, Dim, Real>;
      Real words[history_words];
      for (int k = 0; k < history_words; ++k) words[k] = history_[k][lane];
      auto own = History::from(words);
      keep(lane, contact, evaluate_law(law, contact, own));
      History::put(own, words);
      for (int k = 0; k < history_words; ++k) history_[k][lane] = words[k];
    } else {
      typename LawHistory<Law, Dim, Scalar>::type own;
      auto* const word = reinterpret_cast<Scalar*>(&own);
      for (int k = 0; k < history_words; ++k) word[k] = history_[k][lane];
      keep(lane, contact, evaluate_law(law, contact, own));
      for (int k = 0; k < history_words; ++k) history_[k][lane] = word[k];
    }
  }

  /// Stores the row and the history of each lane.
  [[gnu::always_inline]] void give(Real* rows, Real* histories) const {
    for (int k = 0; k < Row::words; k += 4) rows_from(&row_[k], rows + k, Row::words);
    for (int k = 0; k < padded_words; k += 4) rows_from(&history_[k], histories + k, padded_words);
  }

 private:
  static constexpr int N = Columns::N;
  static constexpr int packs = lanes / N;
  static constexpr int spin_words = angular_size<Dim>;
  using Pack = typename Columns::Pack;

  // u = v + a ω × n, with a to the surface along n, (5).
  [[gnu::always_inline]] static void surface_velocity(const typename Columns::Motion& grain,
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

  [[gnu::always_inline]] void put(int p, const Pack (&n)[Dim], const Pack& overlap,
                                  const Pack (&u)[Dim], const Pack& shorter, const Pack& mass,
                                  const Pack& R) {
    const auto store = [p](Real(&column)[lanes], const Pack& pack) {
      simd::store<Real, N>(column + p * N, pack);
    };
    for (int k = 0; k < Dim; ++k) store(row_[Row::n + k], n[k]);
    store(row_[Row::overlap], overlap);
    store(row_[Row::shorter], shorter);
    for (int k = 0; k < Dim; ++k) store(velocity_[k], u[k]);
    store(mass_, mass);
    store(radius_, R);
  }

  [[gnu::always_inline]] void put_spin(int p, int k, const Pack& spin) {
    simd::store<Real, N>(spin_[k] + p * N, spin);
  }

  template <class C, class Answer>
  void keep(int lane, const C& contact, const Answer& answer) {
    const auto force = force_of(answer, contact.normal);
    for (int k = 0; k < Dim; ++k) row_[Row::F + k][lane] = force[k];
    if constexpr (has_couple) {
      const auto couple = couple_of(answer);
      for (int k = 0; k < spin_words; ++k) row_[Row::couple + k][lane] = component(couple, k);
    }
  }

  // The contact in one lane as input of a law. Scalar is Real or Lane<Real>.
  template <class Scalar>
  Contact<Dim, Scalar> contact(int lane, Real dt) const {
    Contact<Dim, Scalar> contact;
    for (int k = 0; k < Dim; ++k) {
      contact.normal[k] = row_[Row::n + k][lane];
      contact.relative_velocity[k] = velocity_[k][lane];
    }
    if constexpr (has_couple) {
      for (int k = 0; k < spin_words; ++k) component(contact.relative_spin, k) = spin_[k][lane];
    }
    contact.overlap = row_[Row::overlap][lane];
    contact.effective_mass = mass_[lane];
    contact.effective_radius = radius_[lane];
    contact.time_step = dt;
    return contact;
  }

  // From look_at().
  typename Columns::Position i_[packs];
  typename Columns::Position j_[packs];
  Pack distance_[packs];
  Pack overlap_[packs];
  // One array per quantity of the contacts.
  alignas(64) Real row_[Row::words][lanes] = {};
  alignas(64) Real velocity_[Dim][lanes];
  alignas(64) Real spin_[has_couple ? spin_words : 1][lanes];
  alignas(64) Real mass_[lanes];
  alignas(64) Real radius_[lanes];
  alignas(64) Real history_[std::max(padded_words, 1)][lanes] = {};
};

}  // namespace silt::dem
