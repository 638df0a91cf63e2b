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
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

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

  /// What is kept of a contact, at these places of a row of eight: n, δ, F on its first grain, and the
  /// share of δ by which the lever arms are shorter than R.
  static constexpr int n = 0;
  static constexpr int overlap = 3;
  static constexpr int F = 4;
  static constexpr int arm_share = 7;
  static constexpr int row_words = 8;

  /// Lane l is the contact of grains first[l] and second[l]; only the first `filled` are contacts.
  void between(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
               int filled, Real share_of_overlap) {
    grains.load(first, i_);
    grains.load(second, j_);
    std::fill_n(row_[arm_share], lanes, share_of_overlap);
    for (int lane = 0; lane < lanes; ++lane) {
      Real r_ij[Dim];
      Real r_squared = 0;
      for (int k = 0; k < Dim; ++k) {
        r_ij[k] = j_[Columns::x + k][lane] - i_[Columns::x + k][lane];
        r_squared += r_ij[k] * r_ij[k];
      }
      const Real r = std::sqrt(r_squared);
      const Real against_r = -1 / r;
      distance_[lane] = r;
      for (int k = 0; k < Dim; ++k) row_[n + k][lane] = r_ij[k] * against_r;
      const Real m_i = i_[Columns::m][lane];
      const Real m_j = j_[Columns::m][lane];
      const Real R_i = i_[Columns::R][lane];
      const Real R_j = j_[Columns::R][lane];
      row_[overlap][lane] = R_i + R_j - r;
      mass_[lane] = m_i * m_j / (m_i + m_j);
      radius_[lane] = R_i * R_j / (R_i + R_j);
    }
    fill_up(filled);
  }

  /// Lane l is the contact of grain first[l] with wall second[l]; nearest(number, x) is the wall's
  /// nearest point.
  template <class Nearest>
  void at_walls(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
                int filled, Real share_of_overlap, Nearest&& nearest) {
    grains.load(first, i_);
    std::fill_n(row_[arm_share], lanes, share_of_overlap);
    for (auto& column : j_) std::fill(column, column + lanes, Real(0));
    for (int lane = 0; lane < lanes; ++lane) {
      Vec x;
      for (int k = 0; k < Dim; ++k) x[k] = i_[Columns::x + k][lane];
      const NearestPoint<Dim, Real> at = nearest(second[lane], x);
      const Real R_i = i_[Columns::R][lane];
      for (int k = 0; k < Dim; ++k) row_[n + k][lane] = at.normal[k];
      distance_[lane] = 1;
      row_[overlap][lane] = R_i - at.distance;
      mass_[lane] = i_[Columns::m][lane];
      radius_[lane] = R_i;
    }
    fill_up(filled);
  }

  bool touches(int lane) const { return row_[overlap][lane] > 0; }
  /// How many lanes touch.
  int count() const {
    std::int64_t count = 0;
    for (int lane = 0; lane < lanes; ++lane) count += touches(lane);
    return static_cast<int>(count);
  }
  /// A lane that touches and whose centres coincide, `lanes` if there is none.
  int coincident() const {
    std::int64_t any = 0;
    for (int lane = 0; lane < lanes; ++lane) any |= !(distance_[lane] > 0);
    int lane = any != 0 ? 0 : lanes;
    while (lane < lanes && !(touches(lane) && !(distance_[lane] > 0))) ++lane;
    return lane;
  }

  /// Asks one law for all lanes. before[k * lanes + lane] is word k of what it remembers, and goes to
  /// after; a lane that does not touch remembers `fresh`.
  template <class Law, std::size_t words>
  [[gnu::flatten]] void ask(const Law& shared, Real dt, const std::array<Real, words>& fresh,
                            const Real* before, Real* after) {
    using Scalar = Lane<Real>;
    const Law law = shared;  // copies that no store below can change
    const std::array<Real, words> unknown = fresh;
    SILT_EACH_LANE_ALONE
    for (int lane = 0; lane < lanes; ++lane) {
      const auto contact = this->contact<Scalar>(lane, dt);
      const bool touches = contact.overlap > 0;
      silt::Vec<Dim, Scalar> f;
      if constexpr (words > 0) {
        typename LawMemory<Law, Dim, Scalar>::type own;
        auto* const word = reinterpret_cast<Scalar*>(&own);
        for (std::size_t k = 0; k < words; ++k) word[k] = before[k * lanes + lane];
        f = law.force(contact, own);
        for (std::size_t k = 0; k < words; ++k) {
          after[k * lanes + lane] = touches ? Real(word[k]) : unknown[k];
        }
      } else {
        f = law.force(contact);
      }
      for (int k = 0; k < Dim; ++k) row_[F + k][lane] = touches ? Real(f[k]) : Real(0);
    }
  }

  /// Asks a law for one lane: where lanes have different laws, or a law is for one scalar type only.
  template <class Law>
  void ask_one(const Law& law, int lane, Real dt, const Real* before, Real* after) {
    const auto contact = this->contact<Real>(lane, dt);
    Vec f;
    if constexpr (LawMemory<Law, Dim, Real>::words > 0) {
      auto own = memory_at<Law>(before, lane);
      f = law.force(contact, own);
      remember<Law>(own, after, lane);
    } else {
      f = law.force(contact);
    }
    for (int k = 0; k < Dim; ++k) row_[F + k][lane] = f[k];
  }

  /// No force in a lane.
  template <std::size_t words>
  void rest(int lane, const std::array<Real, words>& fresh, Real* after) {
    for (std::size_t k = 0; k < words; ++k) after[k * lanes + static_cast<Index>(lane)] = fresh[k];
    for (int k = 0; k < Dim; ++k) row_[F + k][lane] = 0;
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

  /// The row of each lane.
  void give(Real* rows) const {
    for (int half = 0; half < lanes; half += 4) {
      for (int k = 0; k < row_words; k += 4) {
        transpose_four<Real>([&](int number) { return &row_[k + number][half]; },
                             [&](int lane) { return &rows[(half + lane) * row_words + k]; });
      }
    }
  }

 private:
  // Lanes that are no contacts do not touch.
  void fill_up(int filled) {
    for (int lane = filled; lane < lanes; ++lane) row_[overlap][lane] = -1;
  }

  // The contact in one lane, as a law sees it. Scalar is Real or Lane<Real>.
  template <class Scalar>
  Contact<Dim, Scalar> contact(int lane, Real dt) const {
    Contact<Dim, Scalar> contact;
    for (int k = 0; k < Dim; ++k) contact.normal[k] = row_[n + k][lane];
    contact.overlap = row_[overlap][lane];
    contact.effective_mass = mass_[lane];
    contact.effective_radius = radius_[lane];
    contact.time_step = dt;
    // Velocity of i's surface against j's at the contact point, (5).
    const auto surface = [&](const typename Columns::Column* side, Scalar signed_arm) {
      silt::Vec<Dim, Scalar> v;
      silt::Spin<Dim, Scalar> w;
      for (int k = 0; k < Dim; ++k) v[k] = side[Columns::v + k][lane];
      if constexpr (Dim == 2) {
        w = side[Columns::w][lane];
      } else {
        for (int k = 0; k < Dim; ++k) w[k] = side[Columns::w + k][lane];
      }
      return silt::Vec<Dim, Scalar>(v + signed_arm * cross(w, contact.normal));
    };
    const Real shorter = row_[arm_share][lane] * row_[overlap][lane];
    contact.relative_velocity = surface(i_, Scalar(shorter - i_[Columns::R][lane])) -
                                surface(j_, Scalar(j_[Columns::R][lane] - shorter));
    return contact;
  }

  alignas(64) typename Columns::Column i_[Columns::words];
  alignas(64) typename Columns::Column j_[Columns::words];
  alignas(64) Real row_[row_words][lanes] = {};
  alignas(64) Real distance_[lanes];
  alignas(64) Real mass_[lanes];
  alignas(64) Real radius_[lanes];
};

}  // namespace silt::dem
