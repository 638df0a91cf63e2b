// SPDX-License-Identifier: MIT
// Forces and torques of contacts, kept from their evaluation to the sums over the contacts of each
// grain. They are needed only within a step, most of them only until the next blocks have been
// processed: their memory is used again, so that it stays in the cache.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_LOAD_ROWS
#define SILT_DEM_CONTACT_LOAD_ROWS

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/load_row.hpp>
#include <silt/dem/contact/load_sum.hpp>
#include <silt/dem/contact/touching_grains.hpp>
#include <silt/dem/contact/work_division.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace silt::dem::detail {

/// The rows themselves.
template <int Dim, class RealType, bool has_couple>
class LoadRows {
 public:
  using Real = RealType;
  using Row = LoadRow<Dim, has_couple>;
  static constexpr int dimension = Dim;

  void resize(Index slots) { resize_tightly(numbers_, slots * lanes * Row::words); }

  /// Those of eight contacts.
  Real* slot(Index number) noexcept { return numbers_.data() + number * lanes * Row::words; }
  /// That of one contact.
  Real* row(Index number) noexcept { return numbers_.data() + number * Row::words; }

 private:
  Buffer<Real> numbers_;
};

/// The sums over the contacts of the grains of type P. Refers to its arguments.
template <class P, bool has_couple>
class LoadSums {
  using Real = typename P::Real;
  using Rows = LoadRows<P::dimension, Real, has_couple>;

 public:
  LoadSums(P& grains, const ContactList& contacts, const WorkDivision& work, Rows& rows)
      : list(contacts),
        division(work),
        forces(grains[force]),
        torques(grains[torque]),
        radii(std::as_const(grains)[radius]),
        row_of_side(work.row_of_side()),
        numbers(reinterpret_cast<const std::byte*>(rows.row(0))) {}

  /// Adds Σ F and Σ M (14) over the contacts of each grain of [first, last), in the order of the
  /// partners' ids; only for grains that touch, if these are given.
  void add(Index first, Index last, const TouchingGrains* touching) const;

  const ContactList& list;
  const WorkDivision& division;
  decltype(std::declval<P&>()[force]) forces;
  decltype(std::declval<P&>()[torque]) torques;
  decltype(std::declval<const P&>()[radius]) radii;
  const std::uint32_t* row_of_side;
  const std::byte* numbers;
};

}  // namespace silt::dem::detail

#define SILT_KERNELS <silt/dem/contact/load_rows.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::dem::detail {

template <class P, bool has_couple>
void LoadSums<P, has_couple>::add(Index first, Index last, const TouchingGrains* touching) const {
  SILT_FOR_PROCESSOR(add_loads<P, has_couple>)(*this, first, last, touching);
}

}  // namespace silt::dem::detail

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Writes the loads of contacts to a LoadRows.
template <class Rows>
class LoadStore {
  using Real = typename Rows::Real;
  using Row = typename Rows::Row;
  static constexpr int Dim = Rows::dimension;
  static constexpr int N = GrainPacks<Dim, Real>::N;
  using Pack = simd::Pack<Real, N>;
  static constexpr bool has_couple = Row::words > Row::couple;

 public:
  /// Stores the loads of eight contacts, zero for those that do not touch.
  template <class Lanes>
  [[gnu::always_inline]] static void store(Rows& rows, Index slot, const Lanes& eight,
                                           unsigned touching) {
    alignas(64) Real columns[Row::words][lanes];
    for (int first = 0; first < lanes; first += N) {
      compute(eight, touching >> first, first, columns);
    }
    Real* const to = rows.slot(slot);
    for (int k = 0; k < Row::words; k += 4) simd::rows_from(&columns[k], to + k, Row::words);
  }
  /// The same for the first `count` of them, which touch; row_of(lane) is the row of a
  /// contact.
  template <class Lanes, class RowOf>
  static void store(Rows& to, const Lanes& eight, Index count, RowOf&& row_of) {
    alignas(64) Real columns[Row::words][lanes];
    for (int first = 0; first < lanes; first += N) compute(eight, ~0u, first, columns);
    alignas(64) Real rows[lanes * Row::words];
    for (int k = 0; k < Row::words; k += 4) simd::rows_from(&columns[k], rows + k, Row::words);
    for (Index lane = 0; lane < count; ++lane) {
      std::copy_n(rows + lane * Row::words, Row::words, to.row(row_of(lane)));
    }
  }
  static void clear(Rows& rows, Index slot) {
    // Not std::fill_n, which calls a function for these few.
    Real* const to = rows.slot(slot);
    for (int k = 0; k < lanes * Row::words; k += N) {
      simd::store<Real, N>(to + k, Pack{});
    }
  }

 private:
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
};

/// See LoadSums::add().
template <class P, bool has_couple>
[[gnu::flatten, gnu::noinline]] void add_loads(const LoadSums<P, has_couple>& of, Index first,
                                               Index last, const TouchingGrains* touching) {
  using Real = typename P::Real;
  constexpr int Dim = P::dimension;
  const auto add = [&list = of.list, forces = of.forces, torques = of.torques, radii = of.radii,
                    rows = of.row_of_side, numbers = of.numbers](Index i) {
    constexpr Index stride = LoadRow<Dim, has_couple>::words * sizeof(Real) / 8;
    const Index end = list.begin(i) + list.count(i);
    LoadSum<Dim, Real, has_couple> sum(radii[i]);
    for (Index s = list.begin(i); s < end; ++s) {
      const auto* const row = numbers + Index{rows[s] & ~7u} * stride;
      sum.add(reinterpret_cast<const Real*>(row), rows[s] % 8);
    }
    sum.add_to(forces[i], torques[i]);
  };
  if (touching == nullptr) {
    of.division.for_each_in_order(first, last, add);
  } else {
    touching->for_each(first, last, add);
  }
}

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
