// SPDX-License-Identifier: MIT
// Forces and torques of contacts, kept from their evaluation to the sums over the contacts of each
// grain. They are needed only within a step, most of them only until the next blocks have been
// processed: their memory is used again, so that it stays in the cache.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/load_row.hpp>
#include <silt/dem/contact/load_sum.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace silt::dem::detail {

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
  void clear(Index slot) {
    // Not std::fill_n, which calls a function for these few.
    Real* const to = this->slot(slot);
    for (int k = 0; k < lanes * Row::words; k += N) {
      simd::store<Real, N>(to + k, Pack{});
    }
  }

  /// Returns a function of a grain's index that adds Σ F and Σ M (14) over its contacts, in the
  /// order of the partners' ids.
  template <class P>
  auto sums_for(P& grains, const ContactList& list, const WorkDivision& division) const {
    return [&list, forces = grains[force], torques = grains[torque],
            radii = std::as_const(grains)[radius], rows = division.row_of_side(),
            numbers = reinterpret_cast<const std::byte*>(numbers_.data())](Index i) {
      constexpr Index stride = Row::words * sizeof(Real) / 8;
      const Index end = list.begin(i) + list.count(i);
      LoadSum<Dim, Real, has_couple> sum(radii[i]);
      for (Index s = list.begin(i); s < end; ++s) {
        const auto* const row = numbers + Index{rows[s] & ~7u} * stride;
        sum.add(reinterpret_cast<const Real*>(row), rows[s] % 8);
      }
      sum.add_to(forces[i], torques[i]);
    };
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

  Buffer<Real> numbers_;
};

}  // namespace silt::dem::detail
