// SPDX-License-Identifier: MIT
// Eight contacts at once: their geometry and motion, the law's answer, and what goes to the grains.
// The loops over `lane` become vector instructions, the law's code included; see core/lane.hpp.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/grain_columns.hpp>
#include <silt/dem/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

// g++ must be told that no lane reads what another writes; clang sees it.
#ifdef __clang__
#define SILT_EACH_LANE_ALONE
#else
#define SILT_EACH_LANE_ALONE _Pragma("GCC ivdep")
#endif

namespace silt::dem {

/// What a law remembers, as a row of Reals; none for a law without memory.
template <class Law, int Dim, class Real>
struct LawMemory {
  using type = NoMemory;
  static constexpr int words = 0;
};
template <class Law, int Dim, class Real>
  requires LawWithMemory<Law, Dim, Real>
struct LawMemory<Law, Dim, Real> {
  using type = typename Law::template Memory<Dim, Real>;
  static constexpr int words =
      static_cast<int>((sizeof(type) + sizeof(Real) - 1) / sizeof(Real));
};

/// The law is written for any scalar, and remembers nothing but Reals: the same code then works on
/// eight contacts at once.
template <class Law, int Dim, class Real>
concept LawInLanes =
    ContactLaw<Law, Dim, Lane<Real>> &&
    (!LawWithMemory<Law, Dim, Real> ||
     (sizeof(typename LawMemory<Law, Dim, float>::type) * 2 ==
          sizeof(typename LawMemory<Law, Dim, double>::type) &&
      sizeof(typename LawMemory<Law, Dim, Lane<Real>>::type) ==
          sizeof(typename LawMemory<Law, Dim, Real>::type)));

template <int Dim, class RealType>
class ContactLanes {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Columns = GrainColumns<Dim, Real>;
  static constexpr int spins = Dim == 2 ? 1 : 3;

  /// What is kept of a contact, at these places of a row of eight: n, δ, F on its first grain, and the
  /// share of δ by which the lever arms are shorter than R.
  static constexpr int n = 0;
  static constexpr int overlap_word = 3;
  static constexpr int F = 4;
  static constexpr int arm_share_word = 7;
  static constexpr int row_words = 8;

  /// Lane l is the contact of grains first[l] and second[l].
  void between(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
               Real arm_share) {
    grains.load(first, i_);
    grains.load(second, j_);
    arm_share_ = arm_share;
    for (int lane = 0; lane < lanes; ++lane) {
      Real r_ij[Dim];
      Real r_squared = 0;
      for (int k = 0; k < Dim; ++k) {
        r_ij[k] = j_[Columns::x + k][lane] - i_[Columns::x + k][lane];
        r_squared += r_ij[k] * r_ij[k];
      }
      const Real r = std::sqrt(r_squared);
      distance_[lane] = r;
      for (int k = 0; k < Dim; ++k) normal_[k][lane] = -r_ij[k] / r;
      const Real m_i = i_[Columns::m][lane];
      const Real m_j = j_[Columns::m][lane];
      const Real R_i = i_[Columns::R][lane];
      const Real R_j = j_[Columns::R][lane];
      overlap_[lane] = R_i + R_j - r;
      mass_[lane] = m_i * m_j / (m_i + m_j);
      radius_[lane] = R_i * R_j / (R_i + R_j);
      arm_i_[lane] = R_i - arm_share * overlap_[lane];
      arm_j_[lane] = R_j - arm_share * overlap_[lane];
    }
    find_motion();
  }

  /// Lane l is the contact of grain first[l] with wall second[l]; nearest(number, x) is the wall's
  /// nearest point.
  template <class Nearest>
  void at_walls(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
                Real arm_share, Nearest&& nearest) {
    grains.load(first, i_);
    arm_share_ = arm_share;
    for (auto& column : j_) std::fill(column, column + lanes, Real(0));
    for (int lane = 0; lane < lanes; ++lane) {
      Vec x;
      for (int k = 0; k < Dim; ++k) x[k] = i_[Columns::x + k][lane];
      const NearestPoint<Dim, Real> at = nearest(second[lane], x);
      const Real R_i = i_[Columns::R][lane];
      for (int k = 0; k < Dim; ++k) normal_[k][lane] = at.normal[k];
      distance_[lane] = 1;
      overlap_[lane] = R_i - at.distance;
      mass_[lane] = i_[Columns::m][lane];
      radius_[lane] = R_i;
      arm_i_[lane] = R_i - arm_share * overlap_[lane];
      arm_j_[lane] = 0;
    }
    find_motion();
  }

  Real overlap(int lane) const { return overlap_[lane]; }
  /// Of the two centres [m]; 0 where they coincide.
  Real distance(int lane) const { return distance_[lane]; }
  /// The contact in one lane, as a law sees it. Scalar is Real or Lane<Real>.
  template <class Scalar = Real>
  Contact<Dim, Scalar> contact(int lane, Real dt) const {
    Contact<Dim, Scalar> contact;
    for (int k = 0; k < Dim; ++k) {
      contact.normal[k] = normal_[k][lane];
      contact.relative_velocity[k] = velocity_[k][lane];
    }
    contact.overlap = overlap_[lane];
    contact.effective_mass = mass_[lane];
    contact.effective_radius = radius_[lane];
    contact.time_step = dt;
    return contact;
  }

  /// Asks one law for all lanes. memory[k * lanes + lane] is word k of what it remembers.
  template <class Law>
  [[gnu::flatten]] void ask(const Law& shared, Real dt, Real* __restrict memory) {
    using Scalar = Lane<Real>;
    constexpr int words = LawMemory<Law, Dim, Real>::words;
    const Law law = shared;  // a copy that no store below can change
    SILT_EACH_LANE_ALONE
    for (int lane = 0; lane < lanes; ++lane) {
      const auto contact = this->contact<Scalar>(lane, dt);
      silt::Vec<Dim, Scalar> f;
      if constexpr (words > 0) {
        typename LawMemory<Law, Dim, Scalar>::type own;
        auto* const word = reinterpret_cast<Scalar*>(&own);
        for (int k = 0; k < words; ++k) word[k] = memory[k * lanes + lane];
        f = law.force(contact, own);
        for (int k = 0; k < words; ++k) memory[k * lanes + lane] = word[k];
      } else {
        f = law.force(contact);
      }
      for (int k = 0; k < Dim; ++k) force_[k][lane] = f[k];
    }
  }

  /// Asks a law for one lane: where lanes have different laws, or a law is for one scalar type only.
  template <class Law>
  void ask_one(const Law& law, int lane, Real dt, Real* memory) {
    constexpr int words = LawMemory<Law, Dim, Real>::words;
    const auto contact = this->contact(lane, dt);
    Vec f;
    if constexpr (words > 0) {
      auto own = memory_at<Law>(memory, lane);
      f = law.force(contact, own);
      remember<Law>(own, memory, lane);
    } else {
      f = law.force(contact);
    }
    for (int k = 0; k < Dim; ++k) force_[k][lane] = f[k];
  }

  /// What the law remembers in one lane, from and to words.
  template <class Law>
  static auto memory_at(const Real* memory, int lane) {
    using Memory = typename LawMemory<Law, Dim, Real>::type;
    constexpr int words = LawMemory<Law, Dim, Real>::words;
    Memory own{};
    if constexpr (words > 0) {
      Real word[words];
      for (int k = 0; k < words; ++k) word[k] = memory[k * lanes + lane];
      std::memcpy(static_cast<void*>(&own), word, sizeof own);
    }
    return own;
  }
  template <class Law, class Memory>
  static void remember(const Memory& own, Real* memory, int lane) {
    constexpr int words = LawMemory<Law, Dim, Real>::words;
    if constexpr (words > 0) {
      Real word[words] = {};
      std::memcpy(word, static_cast<const void*>(&own), sizeof own);
      for (int k = 0; k < words; ++k) memory[k * lanes + lane] = word[k];
    }
  }

  /// The row of each lane; no force in lanes that do not touch.
  void give(const bool* touches, Real* rows) const {
    Real columns[row_words][lanes] = {};
    for (int lane = 0; lane < lanes; ++lane) {
      for (int k = 0; k < Dim; ++k) {
        columns[n + k][lane] = normal_[k][lane];
        columns[F + k][lane] = touches[lane] ? force_[k][lane] : Real(0);
      }
      columns[overlap_word][lane] = overlap_[lane];
      columns[arm_share_word][lane] = arm_share_;
    }
    for (int half = 0; half < lanes; half += 4) {
      for (int k = 0; k < row_words; k += 4) {
        transpose_four<Real>([&](int number) { return &columns[k + number][half]; },
                             [&](int lane) { return &rows[(half + lane) * row_words + k]; });
      }
    }
  }

 private:
  // Velocity of i's surface against j's at the contact point, (5).
  void find_motion() {
    for (int lane = 0; lane < lanes; ++lane) {
      const auto surface = [&](const typename Columns::Column* side, Real signed_arm, int k) {
        Real w_cross_n;
        if constexpr (Dim == 2) {
          w_cross_n = (k == 0 ? -1 : 1) * side[Columns::w][lane] * normal_[1 - k][lane];
        } else {
          const int a = (k + 1) % Dim;
          const int b = (k + 2) % Dim;
          w_cross_n = side[Columns::w + a][lane] * normal_[b][lane] -
                      side[Columns::w + b][lane] * normal_[a][lane];
        }
        return side[Columns::v + k][lane] + signed_arm * w_cross_n;
      };
      for (int k = 0; k < Dim; ++k) {
        velocity_[k][lane] = surface(i_, -arm_i_[lane], k) - surface(j_, arm_j_[lane], k);
      }
    }
  }

  Real arm_share_;
  alignas(64) typename Columns::Column i_[Columns::words];
  alignas(64) typename Columns::Column j_[Columns::words];
  alignas(64) Real normal_[Dim][lanes];
  alignas(64) Real velocity_[Dim][lanes];
  alignas(64) Real force_[Dim][lanes];
  alignas(64) Real distance_[lanes];
  alignas(64) Real overlap_[lanes];
  alignas(64) Real mass_[lanes];
  alignas(64) Real radius_[lanes];
  alignas(64) Real arm_i_[lanes];
  alignas(64) Real arm_j_[lanes];
};

}  // namespace silt::dem
