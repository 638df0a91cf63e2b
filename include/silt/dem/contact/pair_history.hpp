// SPDX-License-Identifier: MIT
// State of pairs of particles (such as a tangential spring) as a table sorted by ids, for
// checkpoints. Ids remain valid when particles are reordered or removed.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <utility>
#include <vector>

namespace silt {

/// Partner id of wall w; larger than the id of any particle.
constexpr Id wall_id(Index wall) { return ~static_cast<Id>(wall); }
/// Whether an id is one that wall_id() gives.
constexpr bool is_wall_id(Id id) { return id >> 63 != 0; }

/// A table of pairs of ids, with a Value each.
template <class Value>
class PairHistory {
 public:
  /// A pair and its value; owner < partner.
  struct Entry {
    Id owner;
    Id partner;
    Value value;
  };

  PairHistory() = default;
  /// Throws unless owner < partner in every entry and every pair occurs once.
  explicit PairHistory(std::vector<Entry> entries) : entries_(std::move(entries)) {
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return ids(a) < ids(b); });
    for (Index e = 0; e < entries_.size(); ++e) {
      const bool twice = e > 0 && ids(entries_[e - 1]) == ids(entries_[e]);
      if (entries_[e].owner >= entries_[e].partner || twice) {
        fail({"PairHistory: the pair ", entries_[e].owner, ", ", entries_[e].partner,
              (twice ? " occurs twice" : " does not begin with the lower id"),
              "; give each pair once, lower id first"});
      }
    }
  }

  Index size() const noexcept { return entries_.size(); }

  /// Removes the pairs for which is_kept(owner id, partner id) is false.
  template <std::predicate<Id, Id> IsKept>
  void keep_if(IsKept&& is_kept) {
    std::erase_if(entries_, [&](const Entry& e) { return !is_kept(e.owner, e.partner); });
  }

  /// Writes or reads the table for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    Buffer<Id> owners, partners;
    std::vector<Value> values;
    for (const Entry& entry : entries_) {
      owners.push_back(entry.owner);
      partners.push_back(entry.partner);
      values.push_back(entry.value);
    }
    archive("owners", owners);
    archive("partners", partners);
    archive("values", values);
    if constexpr (Archive::reads) {
      if (owners.size() != partners.size() || owners.size() != values.size()) {
        fail(
            "PairHistory: the data read have columns of different lengths; they were not written "
            "by transfer()");
      }
      std::vector<Entry> entries;
      for (Index e = 0; e < owners.size(); ++e) {
        entries.push_back({owners[e], partners[e], values[e]});
      }
      *this = PairHistory(std::move(entries));
    }
  }

  /// Value of the pair, in either order; nullptr if the pair is not in the table.
  const Value* find(Id a, Id b) const noexcept {
    const std::pair pair = std::minmax(a, b);
    const std::pair<Id, Id> sought{pair.first, pair.second};
    const auto at = std::lower_bound(
        entries_.begin(), entries_.end(), sought,
        [](const Entry& entry, const std::pair<Id, Id>& id) { return ids(entry) < id; });
    return at != entries_.end() && ids(*at) == sought ? &at->value : nullptr;
  }

  /// f(owner id, partner id, value) for every pair, in the order of the ids.
  template <class F>
  void for_each_pair(F&& f) const {
    for (const Entry& entry : entries_) f(entry.owner, entry.partner, entry.value);
  }

 private:
  static std::pair<Id, Id> ids(const Entry& entry) { return {entry.owner, entry.partner}; }

  std::vector<Entry> entries_;
};

}  // namespace silt
