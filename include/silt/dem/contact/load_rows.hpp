// SPDX-License-Identifier: MIT
// Forces and torques of contacts, kept from their evaluation to the sums over the contacts of each
// grain. They are needed only within a step, most of them only until the next blocks have been
// processed: their memory is used again, so that it stays in the cache.
#pragma once

#include <silt/core/columns.hpp>
#include <silt/core/four.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace silt::dem {

/// The row of a contact: F on the first grain, R minus the lever arm, F × n, and the couple on the
/// first grain if the law has one. The torque on a grain is (R − shorter) F × n, for both the same.
template <int Dim, bool has_couple>
struct LoadRow {
  static constexpr int F = 0;
  static constexpr int shorter = 3;
  static constexpr int turning = Dim == 2 ? 2 : 4;
  static constexpr int couple = Dim == 2 ? 4 : 8;
  static constexpr int words = (Dim == 2 ? 4 : 8) + (has_couple ? 4 : 0);
};

/// How the blocks of grains are divided among threads, and in which rows the loads of each contact
/// are kept. Each thread processes consecutive blocks: it evaluates the contacts of a block and
/// then sums the forces on its grains, except those with contacts that belong to blocks of other
/// threads, which have to wait for these. No result depends on the division.
class WorkDivision {
 public:
  /// Adapts it to a list and a number of threads; `list_identity` identifies the list.
  void fit(const ContactList& list, const void* list_identity, Index threads) {
    threads = std::min(threads, std::max<Index>(list.blocks(), 1));
    if (list_identity == list_ && threads == this->threads()) return;
    list_ = list_identity;
    divide(list, threads);
    slot_of_group_.resize(list.groups());
    row_of_side_.resize(list.sides().size());
    waits_.assign(list.grains(), 0);
    waiting_.resize(threads);
    slots_.assign(threads + 1, 0);
    for_each_task(threads, [&](Index t) { find_waiting(list, t); });
    for_each_task(threads, [&](Index t) { slots_[t + 1] = assign_slots(list, t); });
    for (Index t = 0; t < threads; ++t) slots_[t + 1] += slots_[t];
    for_each_task(threads, [&](Index t) {
      for (Index g = group_of(list, first_block_[t]); g < group_of(list, first_block_[t + 1]);
           ++g) {
        slot_of_group_[g] += static_cast<std::uint32_t>(slots_[t]);
      }
    });
    order_.resize(list.grains());
    for_each_range(list.grains(), [&](Index first, Index last) { order(list, first, last); });
    for_each(list.grains(), [&](Index i) {
      for (Index s = list.begin(i); s < list.begin(i) + list.count(i); ++s) {
        const ContactList::Side side = list.sides()[s];
        const Index row =
            slot_of_group_[side.contact() / lanes] * Index(lanes) + side.contact() % lanes;
        row_of_side_[s] = static_cast<std::uint32_t>(8 * row + side.is_second());
      }
    });
  }
  /// Forgets the list.
  void reset() { list_ = nullptr; }

  Index threads() const noexcept { return first_block_.empty() ? 0 : first_block_.size() - 1; }
  /// The first block of a thread.
  Index first_block(Index thread) const noexcept { return first_block_[thread]; }
  /// Whether a grain has to wait until all threads have evaluated their contacts.
  bool waits(Index grain) const noexcept { return waits_[grain] != 0; }
  /// f(grain) for a thread's share of these.
  template <class F>
  void for_each_waiting(Index thread, F&& f) const {
    for (const auto& each : waiting_) {
      const Index end = each.size() * (thread + 1) / threads();
      for (Index k = each.size() * thread / threads(); k < end; ++k) f(each[k]);
    }
  }

  /// The grains of the range [first, last), which begins at a multiple of range_size, by number of
  /// contacts, as offsets from `first`: a processor then predicts the number better.
  const std::uint8_t* order(Index first) const noexcept { return order_.data() + first; }

  /// Number of groups of eight rows.
  Index slots() const noexcept { return slots_.back(); }
  Index slot_of(Index group) const noexcept { return slot_of_group_[group]; }
  /// For each side in the list: eight times the number of its row, plus one for the second grain.
  const std::uint32_t* row_of_side() const noexcept { return row_of_side_.data(); }

 private:
  // Equal shares of the work, where a grain takes as long as two contacts.
  void divide(const ContactList& list, Index threads) {
    std::vector<Index> work(list.blocks() + 1, 0);
    for (Index b = 0; b < list.blocks(); ++b) {
      const auto [pairs, walls] = list.block(b);
      work[b + 1] =
          work[b] + 2 * block_size + (pairs.last - pairs.first) + (walls.last - walls.first);
    }
    first_block_.resize(threads + 1);
    for (Index t = 0; t <= threads; ++t) {
      const auto first = std::lower_bound(work.begin(), work.end(), work.back() * t / threads);
      first_block_[t] = static_cast<Index>(first - work.begin());
    }
  }

  static Index group_of(const ContactList& list, Index block) {
    return block < list.blocks() ? list.block(block).all().first / lanes : list.groups();
  }

  void find_waiting(const ContactList& list, Index t) {
    auto& waiting = waiting_[t];
    waiting.clear();
    const Index first = first_block_[t];
    const Index last = std::min(first_block_[t + 1] * block_size, list.grains());
    for (Index i = first * block_size; i < last; ++i) {
      for (const ContactList::Side side : list.of(i)) {
        if (list.block_of(side.contact()) >= first) continue;
        waits_[i] = 1;
        waiting.push_back(static_cast<std::uint32_t>(i));
        break;
      }
    }
  }

  void order(const ContactList& list, Index first, Index last) {
    constexpr Index most = 15;
    std::array<Index, most + 2> begin{};
    const auto count = [&](Index i) { return std::min(list.count(i), most); };
    for (Index i = first; i < last; ++i) ++begin[count(i) + 1];
    for (Index k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
    for (Index i = first; i < last; ++i) {
      order_[first + begin[count(i)]++] = static_cast<std::uint8_t>(i - first);
    }
  }

  // Numbers the slots of one thread from 0 on; returns how many there are. A slot is used again
  // after the last block that reads it.
  Index assign_slots(const ContactList& list, Index t) {
    const Index first_block = first_block_[t];
    const Index last_block = first_block_[t + 1];
    std::vector<std::vector<std::uint32_t>> released(last_block - first_block);
    std::vector<std::uint32_t> free;
    Index count = 0;
    for (Index b = first_block; b < last_block; ++b) {
      const ContactList::Range all = list.block(b).all();
      for (Index c = all.first; c < all.last; c += lanes) {
        std::uint32_t slot = 0;
        if (free.empty()) {
          slot = static_cast<std::uint32_t>(count++);
        } else {
          slot = free.back();
          free.pop_back();
        }
        slot_of_group_[c / lanes] = slot;
        Index last_read = b;
        for (Index lane = 0; lane < lanes; ++lane) {
          last_read = std::max(last_read, last_reader(list, c + lane, last_block));
        }
        if (last_read < last_block) released[last_read - first_block].push_back(slot);
      }
      free.insert(free.end(), released[b - first_block].begin(), released[b - first_block].end());
    }
    return count;
  }
  // The last block in which the row of a contact is read; `never` if after all blocks.
  Index last_reader(const ContactList& list, Index c, Index never) const {
    const Index i = list.first(c);
    if (waits_[i]) return never;
    if (list.is_of_wall(c)) return i / block_size;
    const Index j = list.second(c);
    return waits_[j] ? never : std::min(never, std::max(i, j) / block_size);
  }

  const void* list_ = nullptr;
  std::vector<Index> first_block_;  // by thread
  std::vector<std::uint32_t> slot_of_group_;
  std::vector<Index> slots_;  // before those of each thread
  std::vector<std::uint32_t> row_of_side_;
  std::vector<std::uint8_t> order_;
  std::vector<char> waits_;                          // by grain
  std::vector<std::vector<std::uint32_t>> waiting_;  // by the thread of their block
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
  /// The same for the first `count` of them, which touch; place_of(lane) is the slot, and the row
  /// in it, of a contact.
  template <class Lanes, class PlaceOf>
  void store(const Lanes& eight, Index count, PlaceOf&& place_of) {
    alignas(64) Real columns[Row::words][lanes];
    for (int first = 0; first < lanes; first += N) compute(eight, ~0u, first, columns);
    alignas(64) Real rows[lanes * Row::words];
    for (int k = 0; k < Row::words; k += 4) rows_from(&columns[k], rows + k, Row::words);
    for (Index lane = 0; lane < count; ++lane) {
      const auto [slot, row] = place_of(lane);
      std::copy_n(rows + lane * Row::words, Row::words, this->slot(slot) + row * Row::words);
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
    for (Index place = 0; place < last - first; ++place) {
      const Index i = first + (is_whole ? order[place] : place);
      const Real R = radii[i];
      Four<Real> sum{};
      Four<Real> turning{};
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
        const Real arm = R - row[Row::shorter];
        if constexpr (Dim == 2) {
          turning += arm * F;
        } else {
          Four<Real> F_x_n;
          load_four(row + Row::turning, F_x_n);
          turning += arm * F_x_n;
        }
        if constexpr (has_couple) {
          Four<Real> couple;
          load_four(row + Row::couple, couple);
          couples += sign * couple;
        }
      }
      for (int k = 0; k < Dim; ++k) forces[i][k] += sum[k];
      constexpr int first_turning = Row::turning % 4;
      for (int k = 0; k < angular_size<Dim>; ++k) {
        Real M = turning[first_turning + k];
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
    put(Row::shorter, simd::load<Real, N>(eight.row[In::shorter] + first));
    if constexpr (Dim == 2) {
      put(Row::turning, F[0] * n[1] - F[1] * n[0]);
    } else {
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        const int m = (k + 2) % 3;
        put(Row::turning + k, F[l] * n[m] - F[m] * n[l]);
      }
      put(Row::turning + 3, zero);
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

}  // namespace silt::dem
