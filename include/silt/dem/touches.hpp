// SPDX-License-Identifier: MIT
// The contacts of one step as they are kept: who touches whom, how, with what memory.
//
//   row of i       contacts of i with higher ids, sorted by the partner's id, then with walls
//   incoming of i  contacts that stand in the rows of lower ids, sorted by those
//
// Every contact stands once, in the row of its lower id; a grain's sums run over its row and then
// over its incoming contacts. Neither the search nor the order in memory shows in any sum.
#pragma once

#include <silt/core/pair_memory.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace silt::dem {

/// One contact, found at i.
template <int Dim, class RealType>
struct Touch {
  using Real = RealType;

  Index j = nowhere;                   ///< partner, owned or ghost; `nowhere`: a wall
  Id id = 0;                           ///< of i
  Id partner = 0;                      ///< id of j, or wall_id
  std::uint32_t material = 0;          ///< of i
  std::uint32_t partner_material = 0;  ///< of j or the wall
  Real arm_i = 0;                      ///< from the centre of i to where the force acts [m]
  Real arm_j = 0;                      ///< likewise of j [m]
  Contact<Dim, Real> contact{};
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();  ///< on i [N]
};

/// The contacts of the last step, and of the one before while a step is being made.
template <int Dim, class RealType, class Memory>
class Touches {
 public:
  using Real = RealType;
  using Touch = dem::Touch<Dim, Real>;

  Index size() const noexcept { return rows_.items().size(); }
  std::span<Touch> row(Index i) noexcept { return rows_[i]; }
  std::span<const Touch> row(Index i) const noexcept { return rows_[i]; }
  std::span<const Touch> all() const noexcept { return rows_.items(); }

  /// What the law remembers, contact by contact: that of row(i)[k] is memory_of_row(i)[k].
  std::span<Memory> memory_of_row(Index i) noexcept {
    return memory_.values().subspan(rows_.first()[i], rows_[i].size());
  }
  PairMemory<Memory>& memory() noexcept { return memory_; }
  const PairMemory<Memory>& memory() const noexcept { return memory_; }

  /// Row i becomes what find(i, add) adds; memory goes with the ids.
  template <class P, class Find>
  void renew(const P& grains, Find&& find) {
    keep_last();
    rows_.build(grains.size(), find);
    partners_.resize(rows_.items().size());
    for_each(grains.size(), [&](Index i) {
      const auto touches = rows_[i];
      std::sort(touches.begin(), touches.end(),
                [](const Touch& a, const Touch& b) { return a.partner < b.partner; });
      Index c = rows_.first()[i];
      for (const Touch& touch : touches) partners_[c++] = touch.partner;
    });
    memory_.renew(grains.ids(), rows_.first(), partners_);
    list_incoming(grains);
  }

  /// f(touch, true) for the contacts in the row of i, then f(touch, false) for those in which i is
  /// the partner.
  template <class F>
  void for_each_of(Index i, F&& f) const {
    for (const Touch& touch : rows_[i]) f(touch, true);
    for (Index k = incoming_first_[i]; k < incoming_first_[i + 1]; ++k) {
      f(rows_.items()[incoming_[k]], false);
    }
  }

  void save() noexcept {
    memory_.save();
    keeps_last_ = false;
  }
  void restore() noexcept {
    memory_.restore();
    if (keeps_last_) std::swap(rows_, last_rows_);
    keeps_last_ = false;
  }

 private:
  // The first renewal within a step puts the contacts of the step before aside, for restore().
  void keep_last() noexcept {
    if (keeps_last_) return;
    std::swap(rows_, last_rows_);
    keeps_last_ = true;
  }

  template <class P>
  void list_incoming(const P& grains) {
    auto& first = incoming_first_;
    first.assign(grains.size() + 1, 0);
    for (const Touch& touch : rows_.items()) {
      if (touch.j != nowhere) ++first[grains.owner(touch.j) + 1];
    }
    for (Index i = 0; i < grains.size(); ++i) first[i + 1] += first[i];
    incoming_.resize(first.back());
    // Fill from behind: first[i + 1] walks down from the end of row i to its beginning.
    for (Index c = rows_.items().size(); c-- > 0;) {
      const Index j = rows_.items()[c].j;
      if (j != nowhere) incoming_[--first[grains.owner(j) + 1]] = c;
    }
    // Now first[i + 1] is the beginning of row i.
    for (Index i = 0; i < grains.size(); ++i) first[i] = first[i + 1];
    first.back() = incoming_.size();
    // They came in the order of memory; sums go in the order of ids.
    for_each(grains.size(), [&](Index i) {
      const auto begin = incoming_.begin();
      std::sort(begin + static_cast<std::ptrdiff_t>(first[i]),
                begin + static_cast<std::ptrdiff_t>(first[i + 1]),
                [touches = all()](Index a, Index b) { return touches[a].id < touches[b].id; });
    });
  }

  Rows<Touch> rows_;
  std::vector<Id> partners_;
  PairMemory<Memory> memory_;
  std::vector<Index> incoming_first_;  // by grain
  std::vector<Index> incoming_;
  Rows<Touch> last_rows_;
  bool keeps_last_ = false;
};

}  // namespace silt::dem
