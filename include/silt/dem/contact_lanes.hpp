// SPDX-License-Identifier: MIT
// Eight contacts at once: their geometry and motion, the law's answer, and what is kept of each.
// The loops over `lane` become vector instructions, the law's code included; see core/lane.hpp.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/four.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/grain_columns.hpp>
#include <silt/dem/walls.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace silt::dem {

/// What a law remembers, as a row of Reals; none for a law without memory.
template <class Law, int Dim, class Real>
struct LawMemory {
  using type = NoMemory;
  static constexpr int words = 0;
  static type from(const Real*) { return {}; }
  static void put(const type&, Real*) {}
};
template <class Law, int Dim, class Real>
  requires LawWithMemory<Law, Dim, Real>
struct LawMemory<Law, Dim, Real> {
  using type = typename Law::template Memory<Dim, Real>;
  static constexpr int words =
      static_cast<int>((sizeof(type) + sizeof(Real) - 1) / sizeof(Real));
  static type from(const Real* row) {
    type memory{};
    std::memcpy(static_cast<void*>(&memory), row, sizeof memory);
    return memory;
  }
  static void put(const type& memory, Real* row) {
    std::memcpy(row, static_cast<const void*>(&memory), sizeof memory);
  }
};

namespace detail {
// A scalar of odd size: among such, anything else shows in the size of the whole.
struct OddScalar {
  float parts[3];
};
template <class Law, int Dim, class Real>
concept RemembersRealsOnly =
    !LawWithMemory<Law, Dim, Real> ||
    (sizeof(typename Law::template Memory<Dim, OddScalar>) ==
         sizeof(OddScalar) * LawMemory<Law, Dim, Real>::words &&
     sizeof(typename Law::template Memory<Dim, Lane<Real>>) ==
         sizeof(Real) * LawMemory<Law, Dim, Real>::words);
}  // namespace detail

/// The law is written for any scalar, and remembers nothing but Reals: the same code then works on
/// eight contacts at once.
template <class Law, int Dim, class Real>
concept LawInLanes =
    ContactLaw<Law, Dim, Lane<Real>> && detail::RemembersRealsOnly<Law, Dim, Real>;

/// What is kept of a contact that touches, besides what the law remembers: n, δ, F on its first grain, and
/// the share of δ by which the lever arms are shorter than R.
struct ContactRow {
  static constexpr int n = 0;
  static constexpr int overlap = 3;
  static constexpr int F = 4;
  static constexpr int arm_share = 7;
  static constexpr int words = 8;
};

template <int Dim, class RealType, int memory_words>
class ContactLanes {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Columns = GrainColumns<Dim, Real>;
  using Row = ContactRow;
  /// Words of memory, filled up to whole fours.
  static constexpr int padded_words = (memory_words + 3) / 4 * 4;

  /// Lane l looks at grains first[l] and second[l]; bit l is set if the two touch.
  unsigned look_at(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second) {
    grains.load_places(first, i_);
    grains.load_places(second, j_);
    for (int lane = 0; lane < lanes; ++lane) {
      Real r_squared = 0;
      for (int k = 0; k < Dim; ++k) {
        r_squared += squared(j_[Columns::x + k][lane] - i_[Columns::x + k][lane]);
      }
      distance_[lane] = std::sqrt(r_squared);
      row_[Row::overlap][lane] = i_[Columns::R][lane] + j_[Columns::R][lane] - distance_[lane];
    }
    return touching();
  }

  /// The contacts of the pairs looked at.
  void between(const Columns& grains, const std::uint32_t* first, const std::uint32_t* second,
               Real share_of_overlap) {
    grains.load_motion(first, i_);
    grains.load_motion(second, j_);
    for (int lane = 0; lane < lanes; ++lane) {
      const Real against_r = -1 / distance_[lane];
      for (int k = 0; k < Dim; ++k) {
        row_[Row::n + k][lane] =
            (j_[Columns::x + k][lane] - i_[Columns::x + k][lane]) * against_r;
      }
      const Real m_i = i_[Columns::m][lane];
      const Real m_j = j_[Columns::m][lane];
      const Real R_i = i_[Columns::R][lane];
      const Real R_j = j_[Columns::R][lane];
      mass_[lane] = m_i * m_j / (m_i + m_j);
      radius_[lane] = R_i * R_j / (R_i + R_j);
    }
    std::fill_n(row_[Row::arm_share], lanes, share_of_overlap);
  }

  /// Lane l looks at grain first[l] and wall second[l]; nearest(number, x) is the wall's nearest point.
  template <class Nearest>
  unsigned look_at_walls(const Columns& grains, const std::uint32_t* first,
                         const std::uint32_t* second, Nearest&& nearest) {
    grains.load_places(first, i_);
    for (int lane = 0; lane < lanes; ++lane) {
      Vec x;
      for (int k = 0; k < Dim; ++k) x[k] = i_[Columns::x + k][lane];
      const NearestPoint<Dim, Real> at = nearest(second[lane], x);
      for (int k = 0; k < Dim; ++k) row_[Row::n + k][lane] = at.normal[k];
      row_[Row::overlap][lane] = i_[Columns::R][lane] - at.distance;
    }
    return touching();
  }

  /// The contacts of the grains looked at.
  void at_walls(const Columns& grains, const std::uint32_t* first, Real share_of_overlap) {
    grains.load_motion(first, i_);
    for (auto& column : j_) std::fill(column, column + lanes, Real(0));
    std::copy_n(i_[Columns::m], lanes, mass_);
    std::copy_n(i_[Columns::R], lanes, radius_);
    std::fill_n(row_[Row::arm_share], lanes, share_of_overlap);
  }

  /// The first lane of those in `bits` whose centres coincide, `lanes` if there is none.
  int coincident(unsigned bits) const {
    int lane = 0;
    while (lane < lanes && !((bits >> lane & 1) != 0 && !(distance_[lane] > 0))) ++lane;
    return lane;
  }

  /// memory(lane) is what the law remembers there.
  template <class MemoryAt>
  void recall(MemoryAt&& memory) {
    for (int half = 0; half < lanes; half += 4) {
      for (int k = 0; k < memory_words; k += 4) {
        transpose_four<Real>([&](int lane) { return memory(half + lane) + k; },
                             [&](int number) { return &memory_[k + number][half]; });
      }
    }
  }

  /// Asks one law for all lanes.
  template <class Law>
  [[gnu::flatten]] void ask(const Law& shared, Real dt) {
    using Scalar = Lane<Real>;
    const Law law = shared;  // a copy that no store below can change
    SILT_EACH_LANE_ALONE
    for (int lane = 0; lane < lanes; ++lane) {
      const auto contact = this->contact<Scalar>(lane, dt);
      silt::Vec<Dim, Scalar> f;
      if constexpr (memory_words > 0) {
        typename LawMemory<Law, Dim, Scalar>::type own;
        auto* const word = reinterpret_cast<Scalar*>(&own);
        for (int k = 0; k < memory_words; ++k) word[k] = memory_[k][lane];
        f = law.force(contact, own);
        for (int k = 0; k < memory_words; ++k) memory_[k][lane] = word[k];
      } else {
        f = law.force(contact);
      }
      for (int k = 0; k < Dim; ++k) row_[Row::F + k][lane] = f[k];
    }
  }

  /// Asks a law for one lane: where lanes have different laws, or a law is for one scalar type only.
  template <class Law>
  void ask(const Law& law, Real dt, int lane) {
    using Memory = LawMemory<Law, Dim, Real>;
    const auto contact = this->contact<Real>(lane, dt);
    Vec f;
    if constexpr (memory_words > 0) {
      Real words[memory_words];
      for (int k = 0; k < memory_words; ++k) words[k] = memory_[k][lane];
      auto own = Memory::from(words);
      f = law.force(contact, own);
      Memory::put(own, words);
      for (int k = 0; k < memory_words; ++k) memory_[k][lane] = words[k];
    } else {
      f = law.force(contact);
    }
    for (int k = 0; k < Dim; ++k) row_[Row::F + k][lane] = f[k];
  }

  /// The row and the memory of each lane.
  void give(Real* rows, Real* memories) const {
    give<Row::words>(row_, rows);
    give<padded_words>(memory_, memories);
  }

 private:
  unsigned touching() const {
    unsigned bits = 0;
    for (int lane = 0; lane < lanes; ++lane) {
      if (row_[Row::overlap][lane] > 0) bits |= 1u << lane;
    }
    return bits;
  }

  template <int words, class Lanes>
  static void give(const Lanes& columns, Real* rows) {
    for (int half = 0; half < lanes; half += 4) {
      for (int k = 0; k < words; k += 4) {
        transpose_four<Real>([&](int number) { return &columns[k + number][half]; },
                             [&](int lane) { return &rows[(half + lane) * words + k]; });
      }
    }
  }

  // The contact in one lane, as a law sees it. Scalar is Real or Lane<Real>.
  template <class Scalar>
  Contact<Dim, Scalar> contact(int lane, Real dt) const {
    Contact<Dim, Scalar> contact;
    for (int k = 0; k < Dim; ++k) contact.normal[k] = row_[Row::n + k][lane];
    contact.overlap = row_[Row::overlap][lane];
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
    const Real shorter = row_[Row::arm_share][lane] * row_[Row::overlap][lane];
    contact.relative_velocity = surface(i_, Scalar(shorter - i_[Columns::R][lane])) -
                                surface(j_, Scalar(j_[Columns::R][lane] - shorter));
    return contact;
  }

  alignas(64) typename Columns::Column i_[Columns::words];
  alignas(64) typename Columns::Column j_[Columns::words];
  alignas(64) Real row_[Row::words][lanes] = {};
  alignas(64) Real memory_[std::max(padded_words, 1)][lanes] = {};
  alignas(64) Real distance_[lanes];
  alignas(64) Real mass_[lanes];
  alignas(64) Real radius_[lanes];
};

}  // namespace silt::dem
