// SPDX-License-Identifier: MIT
// State that belongs to a pair of ids (a tangential spring, say). It is kept in rows, one per
// owner, the particle with the lower id; a row is sorted by the partner's id:
//
//   owner   7        3              12
//   rows   [9 15 |  4 8 ~0 |        ...     partners (~w is wall w)
//          [m m  |  m m m  |        ...     values
//
// renew() takes the pairs of this step and carries the values over by id, so that re-search,
// reordering and removal in between do not matter.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt {

/// Partner id of wall w: above every particle's id.
constexpr Id wall_id(Index wall) { return ~static_cast<Id>(wall); }

template <class Value>
class PairMemory {
 public:
  /// Makes the rows [first[r], first[r+1]) of `partners` the current ones. owners[r] is the id of
  /// row r, partners are sorted within a row. A pair that was there keeps its value, a new one gets
  /// zero_of<Value>(); the others are forgotten.
  void renew(std::span<const Id> owners, std::span<const Index> first,
             std::span<const Id> partners) {
    Rows& next = renewed_ ? spare_ : previous_;
    next.owners.assign(owners.begin(), owners.end());
    next.first.assign(first.begin(), first.end());
    next.partners.assign(partners.begin(), partners.end());
    next.values.resize(partners.size());
    for_each(owners.size(), [&](Index r) {
      const Index old = row_of(owners[r]);
      Index o = old == nowhere ? 0 : current_.first[old];
      const Index end = old == nowhere ? 0 : current_.first[old + 1];
      for (Index c = first[r]; c < first[r + 1]; ++c) {
        while (o < end && current_.partners[o] < partners[c]) ++o;
        const bool known = o < end && current_.partners[o] == partners[c];
        next.values[c] = known ? current_.values[o] : zero_of<Value>();
      }
    });
    tabulate(next);
    std::swap(current_, next);
    renewed_ = true;
  }

  /// Values of the current pairs, in the order of `partners`.
  std::span<Value> values() noexcept { return current_.values; }
  std::span<const Value> values() const noexcept { return current_.values; }

  /// Value of the pair, in either order; nullptr if there is none.
  const Value* find(Id a, Id b) const noexcept {
    const Index r = row_of(std::min(a, b));
    if (r == nowhere) return nullptr;
    const auto begin = current_.partners.begin();
    const auto from = begin + static_cast<std::ptrdiff_t>(current_.first[r]);
    const auto to = begin + static_cast<std::ptrdiff_t>(current_.first[r + 1]);
    const auto at = std::lower_bound(from, to, std::max(a, b));
    if (at == to || *at != std::max(a, b)) return nullptr;
    return &current_.values[static_cast<Index>(at - begin)];
  }

  Index size() const noexcept { return current_.values.size(); }

  /// f(owner id, partner id, value) for every pair: what a checkpoint writes.
  template <class F>
  void for_each_pair(F&& f) const {
    for (Index r = 0; r < current_.owners.size(); ++r) {
      for (Index c = current_.first[r]; c < current_.first[r + 1]; ++c) {
        f(current_.owners[r], current_.partners[c], current_.values[c]);
      }
    }
  }

  /// A pair and its value, as a checkpoint holds it; owner < partner.
  struct Entry {
    Id owner;
    Id partner;
    Value value;
  };
  /// Replaces all memory: what a restart reads. Throws unless owner < partner in every entry and
  /// every pair stands there once.
  void assign(std::vector<Entry> entries) {
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return std::pair(a.owner, a.partner) < std::pair(b.owner, b.partner);
    });
    for (Index e = 0; e < entries.size(); ++e) {
      const auto& [owner, partner, value] = entries[e];
      const bool twice =
          e > 0 && entries[e - 1].owner == owner && entries[e - 1].partner == partner;
      if (owner >= partner || twice) {
        fail("PairMemory::assign: the pair " + std::to_string(owner) + ", " +
             std::to_string(partner) +
             (twice ? " is there twice" : " does not begin with the lower id") +
             "; give each pair once, as for_each_pair does");
      }
    }
    Rows& next = previous_;
    next = {};
    next.first.push_back(0);
    for (const Entry& entry : entries) {
      if (next.owners.empty() || next.owners.back() != entry.owner) {
        next.owners.push_back(entry.owner);
        next.first.push_back(next.partners.size());
      }
      next.partners.push_back(entry.partner);
      next.values.push_back(entry.value);
      next.first.back() = next.partners.size();
    }
    tabulate(next);
    std::swap(current_, previous_);
    renewed_ = false;
  }

  /// The rows before the first renew() after save() stay untouched, so undoing a step is a swap.
  void save() noexcept { renewed_ = false; }
  void restore() noexcept {
    if (renewed_) std::swap(current_, previous_);
    renewed_ = false;
  }

 private:
  struct Rows {
    std::vector<Id> owners;
    std::vector<Index> first;
    std::vector<Id> partners;
    std::vector<Value> values;
    std::vector<Index> row_of;  // by owner id
  };

  Index row_of(Id owner) const noexcept {
    return owner < current_.row_of.size() ? current_.row_of[owner] : nowhere;
  }

  static void tabulate(Rows& rows) {
    const auto highest = std::max_element(rows.owners.begin(), rows.owners.end());
    rows.row_of.assign(rows.owners.empty() ? 0 : *highest + 1, nowhere);
    for (Index r = 0; r < rows.owners.size(); ++r) rows.row_of[rows.owners[r]] = r;
  }

  Rows current_;
  Rows previous_;
  Rows spare_;  // for a second renew() within a step
  bool renewed_ = false;
};

}  // namespace silt
