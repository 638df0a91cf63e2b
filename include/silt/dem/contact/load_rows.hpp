// SPDX-License-Identifier: MIT
// Forces and torques of contacts, kept from their evaluation to the sums over the contacts of each
// grain. They are needed only within a step, most of them only until the next blocks have been
// processed: their memory is used again, so that it stays in the cache.
#pragma once

#include <silt/core/cache_aligned.hpp>
#include <silt/core/four.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace silt::dem::detail {

/// The row of a contact: F on the first grain, R minus the lever arm, F × n, and the couple on the
/// first grain if the law has one. The torque on a grain is (R − arm_reduction) F × n, for both the
/// same.
template <int Dim, bool has_couple>
struct LoadRow {
  static constexpr int F = 0;
  static constexpr int arm_reduction = 3;
  static constexpr int F_x_n = Dim == 2 ? 2 : 4;
  static constexpr int couple = Dim == 2 ? 4 : 8;
  static constexpr int words = (Dim == 2 ? 4 : 8) + (has_couple ? 4 : 0);
};

/// The rows themselves.
template <int Dim, class Real, bool has_couple>
class LoadRows {
  using Row = LoadRow<Dim, has_couple>;

 public:
  void resize(Index slots) { resize_tightly(numbers_, slots * lanes * Row::words); }

  Real* slot(Index number) noexcept { return numbers_.data() + number * lanes * Row::words; }

  /// Stores the loads of eight contacts, zero for those that do not touch.
  template <class Lanes>
  [[gnu::always_inline]] void store(Index slot, const Lanes& eight, unsigned touching) {
    alignas(64) Real columns[Row::words][lanes];
    for (int first = 0; first < lanes; first += N) {
      compute(eight, touching >> first, first, columns);
    }
    Real* const to = this->slot(slot);
    for (int k = 0; k < Row::words; k += 4) rows_from(&columns[k], to + k, Row::words);
  }
  /// The same for the first `count` of them, which touch; row_of(lane) is the row of a
  /// contact.
  template <class Lanes, class RowOf>
  void store(const Lanes& eight, Index count, RowOf&& row_of) {
    alignas(64) Real columns[Row::words][lanes];
    for (int first = 0; first < lanes; first += N) compute(eight, ~0u, first, columns);
    alignas(64) Real rows[lanes * Row::words];
    for (int k = 0; k < Row::words; k += 4) rows_from(&columns[k], rows + k, Row::words);
    for (Index lane = 0; lane < count; ++lane) {
      std::copy_n(rows + lane * Row::words, Row::words,
                  numbers_.data() + row_of(lane) * Row::words);
    }
  }
  void clear(Index slot) { std::fill_n(this->slot(slot), lanes * Row::words, Real(0)); }

  /// Adds Σ F and Σ M (14) of grains [first, last), in the order of the partners' ids.
  template <class P>
  void add_to(P& grains, const ContactList& list, const WorkDivision& division, Index first,
              Index last) const {
    const auto forces = grains[force];
    const auto torques = grains[torque];
    const auto radii = std::as_const(grains)[radius];
    const std::uint32_t* const rows = division.row_of_side();
    const auto* const numbers = reinterpret_cast<const std::byte*>(numbers_.data());
    constexpr Index stride = Row::words * sizeof(Real) / 8;
    const bool is_whole = first % range_size == 0 && last % range_size == 0;
    const std::uint8_t* const order = division.order(first);
    for (Index k_th = 0; k_th < last - first; ++k_th) {
      const Index i = first + (is_whole ? order[k_th] : k_th);
      const Real R = radii[i];
      Four<Real> sum{};
      Four<Real> moment{};
      [[maybe_unused]] Four<Real> couples{};
      const Index end = list.begin(i) + list.count(i);
      for (Index s = list.begin(i); s < end; ++s) {
        // A table, because a conditional expression becomes a branch that is mispredicted.
        static constexpr Real signs[] = {1, -1};
        const Real sign = signs[rows[s] % 8];
        const auto* const row =
            reinterpret_cast<const Real*>(numbers + Index{rows[s] & ~7u} * stride);
        Four<Real> F;
        load_four(row + Row::F, F);
        sum += sign * F;
        const Real arm = R - row[Row::arm_reduction];
        if constexpr (Dim == 2) {
          moment += arm * F;
        } else {
          Four<Real> F_x_n;
          load_four(row + Row::F_x_n, F_x_n);
          moment += arm * F_x_n;
        }
        if constexpr (has_couple) {
          Four<Real> couple;
          load_four(row + Row::couple, couple);
          couples += sign * couple;
        }
      }
      for (int k = 0; k < Dim; ++k) forces[i][k] += sum[k];
      constexpr int first_of_moment = Row::F_x_n % 4;
      for (int k = 0; k < angular_size<Dim>; ++k) {
        Real M = moment[first_of_moment + k];
        if constexpr (has_couple) M += couples[k];
        component(torques[i], k) += M;
      }
    }
  }

 private:
  static constexpr int N = GrainRows<Dim, Real>::N;
  using Pack = simd::Pack<Real, N>;

  template <class Lanes>
  [[gnu::always_inline]] static void compute(const Lanes& eight, unsigned touching, int first,
                                             Real (&to)[Row::words][lanes]) {
    using In = typename Lanes::Row;
    const Pack zero{};
    Pack n[3]{}, F[3]{};
    for (int k = 0; k < Dim; ++k) {
      n[k] = simd::load<Real, N>(eight.row[In::n + k] + first);
      F[k] = simd::load<Real, N>(eight.row[In::F + k] + first);
    }
    const auto put = [&](int k, const Pack& values) {
      simd::store<Real, N>(to[k] + first, simd::select<Real, N>(touching, values, zero));
    };
    for (int k = 0; k < Dim; ++k) put(Row::F + k, F[k]);
    put(Row::arm_reduction, simd::load<Real, N>(eight.row[In::arm_reduction] + first));
    if constexpr (Dim == 2) {
      put(Row::F_x_n, F[0] * n[1] - F[1] * n[0]);
    } else {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const int m = (k + 2) % 3;
        put(Row::F_x_n + k, F[l] * n[m] - F[m] * n[l]);
      }
      put(Row::F_x_n + 3, zero);
    }
    if constexpr (has_couple) {
      for (int k = 0; k < 4; ++k) {
        put(Row::couple + k,
            k < angular_size<Dim> ? simd::load<Real, N>(eight.row[In::couple + k] + first) : zero);
      }
    }
  }

  std::vector<Real, silt::detail::CacheAligned<Real>> numbers_;
};

}  // namespace silt::dem::detail
