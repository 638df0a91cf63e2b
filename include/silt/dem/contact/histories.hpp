// SPDX-License-Identifier: MIT
// The histories of all contacts after a step, and how they move to a new list: by the ids of the
// grains, because their indices may have changed.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace silt::dem::detail {

/// The histories of all contacts of a list, of `words` numbers each, to be read.
template <class Real, int words>
class KnownHistories {
 public:
  KnownHistories(const Real* numbers, const std::uint8_t* touching)
      : numbers_(numbers), touching_(touching) {}

  unsigned touching_in_group(Index group) const noexcept { return touching_[group]; }
  bool touches(Index contact) const noexcept {
    return (touching_[contact / lanes] >> (contact % lanes) & 1) != 0;
  }
  const Real* group(Index number) const noexcept { return numbers_ + number * words * lanes; }
  /// Number k of contact c.
  Real at(Index contact, int k) const noexcept {
    return group(contact / lanes)[k * lanes + int(contact % lanes)];
  }

 private:
  const Real* numbers_;
  const std::uint8_t* touching_;  // a bit for each contact of a group
};

/// The histories of all contacts of a list after a step, in groups of eight, number by number, and
/// which of them touch. Those of contacts that do not touch are unspecified. LawHistoryType is a
/// dem::LawHistory.
template <class Real, class LawHistoryType>
class Histories {
 public:
  using LawHistory = LawHistoryType;
  static constexpr int words = LawHistory::words;

  void resize(Index groups) {
    resize_tightly(numbers_, groups * words * lanes);
    resize_tightly(touching_, groups);
  }
  /// Makes them those of a new list, as far as they are in a PairHistory.
  template <class PairHistory>
  void fill(const ContactList& list, const PairHistory& pairs) {
    begin(list);
    list.for_each_contact([&](Index c) {
      const auto* const known = pairs.find(list.first_id(c), list.second_id(c));
      if (known != nullptr) set(c, *known);
    });
  }
  /// The same from the histories of the list before it; index_of(id) is the index of a grain of
  /// the new one.
  template <class IndexOf>
  void fill(const ContactList& list, IndexOf&& index_of, const ContactList& last,
            const Histories& from) {
    begin(list);
    last.for_each_contact([&](Index c) {
      if (!from.touches(c)) return;
      const Index now = list.find(last.first_id(c), last.second_id(c), index_of);
      if (now != no_index) set(now, from.of(c));
    });
  }

  KnownHistories<Real, words> known() const noexcept { return {numbers_.data(), touching_.data()}; }
  /// The same while the next ones replace them, contact by contact; `touching` is memory for it.
  KnownHistories<Real, words> known_in_place(Buffer<std::uint8_t>& touching) const {
    touching = touching_;
    return {numbers_.data(), touching.data()};
  }

  void set_touching_in_group(Index group, unsigned touching) noexcept {
    touching_[group] = static_cast<std::uint8_t>(touching);
  }
  bool touches(Index contact) const noexcept { return known().touches(contact); }

  Real* group(Index number) noexcept { return numbers_.data() + number * words * lanes; }
  /// Number k of contact c.
  Real& at(Index contact, int k) noexcept {
    return group(contact / lanes)[k * lanes + int(contact % lanes)];
  }
  /// The history of a contact; that of a new one if it does not touch.
  typename LawHistory::type of(Index contact) const {
    if constexpr (words == 0) {
      return {};
    } else {
      if (!touches(contact)) return {};
      Real own[words];
      for (int k = 0; k < words; ++k) own[k] = known().at(contact, k);
      return LawHistory::from(own);
    }
  }

 private:
  // None touches.
  void begin(const ContactList& list) {
    resize(list.groups());
    std::fill(touching_.begin(), touching_.end(), std::uint8_t(0));
  }
  // May be called for contacts of the same group by several threads.
  void set(Index contact, const typename LawHistory::type& history) {
    const auto bit = static_cast<std::uint8_t>(1u << (contact % lanes));
    std::atomic_ref(touching_[contact / lanes]).fetch_or(bit, std::memory_order_relaxed);
    if constexpr (words > 0) {
      Real own[words];
      LawHistory::put(history, own);
      for (int k = 0; k < words; ++k) at(contact, k) = own[k];
    }
  }

  Buffer<Real> numbers_;
  Buffer<std::uint8_t> touching_;  // a bit for each contact of a group
};

}  // namespace silt::dem::detail
