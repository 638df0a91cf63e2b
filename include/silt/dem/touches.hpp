// SPDX-License-Identifier: MIT
// What contacts keep from step to step, and how a failed step is undone: nothing that the step
// before made is written over until the next save(), so that undoing is a swap.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/pair_history.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact_lanes.hpp>
#include <silt/dem/contact_row.hpp>
#include <silt/dem/near_contacts.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace silt::dem {

/// Memory is the law's LawHistory.
template <int Dim, class RealType, class History, bool has_couple>
class Touches {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Row = ContactRow<has_couple>;
  using Lanes = ContactLanes<Dim, Real, History::words, has_couple>;
  static constexpr bool couples = has_couple;
  static constexpr Index padded_words = Lanes::padded_words;
  using Remembered = PairHistory<typename History::type>;
  /// Row of the contacts that do not touch: all zeros, with the memory of a new contact. Who reads
  /// it like any other saves a branch that cannot be predicted.
  static constexpr std::uint32_t none = 0;
  static constexpr std::uint32_t first_row = lanes;

  /// What one step made. Only contacts that touch have a row of their own; the rows of those found
  /// at a chunk of grains lie together, as far behind first_row as the first of these contacts.
  struct Seen {
    using Row = ContactRow<has_couple>;
    std::vector<Real, Eigen::aligned_allocator<Real>> rows;      ///< see ContactRow
    std::vector<Real, Eigen::aligned_allocator<Real>> histories;  ///< padded_words a row
    std::vector<std::uint32_t> at;  ///< number of the row of each near contact, or `none`
    Index count = 0;                ///< contacts that touch
    Real time_step = 0;             ///< [s]
    double time = 0;                ///< of the positions [s]

    Seen() {
      resize(0);
      std::fill_n(rows.begin(), first_row * Row::words, Real(0));
      std::fill(histories.begin(), histories.end(), Real(0));
      if constexpr (History::words > 0) History::put({}, histories.data());
    }
    void resize(Index contacts) {
      resize_sparingly(rows, (contacts + first_row) * Row::words);
      resize_sparingly(histories, (contacts + first_row) * padded_words);
      resize_sparingly(at, contacts);
    }
    Real* row(Index number) noexcept { return rows.data() + number * Row::words; }
    Real* history(Index number) noexcept { return histories.data() + number * padded_words; }
    const Real* history(Index number) const noexcept {
      return histories.data() + number * padded_words;
    }
    bool touches(Index contact) const noexcept { return at[contact] != none; }
    const Real* row_of(Index contact) const noexcept {
      return rows.data() + Index{at[contact]} * Row::words;
    }
    const Real* history_of(Index contact) const noexcept { return history(at[contact]); }
  };
  /// Since when, and how long, the near contacts are good.
  struct Validity {
    std::vector<Vec<Dim, Real>> since;  ///< positions of the owned grains [m]
    Travel travel;                      ///< of the search then
    Real margin = 0;                    ///< gap up to which pairs are near [m]
    std::uint64_t revision = std::numeric_limits<std::uint64_t>::max();
    double time = 0;              ///< of these positions, and of the walls [s]
    Box<Dim, Real> extent;        ///< in which the grains stay as long [m]
    double stable_time_step = 0;  ///< that all near contacts stand [s]
  };

  const Seen& seen() const noexcept { return seen_; }
  Seen& seen() noexcept { return seen_; }
  const NearContacts& near() const noexcept { return near_; }
  const Validity& validity() const noexcept { return validity_; }
  Validity& validity() noexcept { return validity_; }

  /// What the law remembers of contacts from the last look on.
  struct Histories {
    const std::uint32_t* at;
    const Real* histories;
    const Real* of(Index contact) const noexcept {
      return histories + Index{at[contact]} * padded_words;
    }
  };
  Histories histories_before() const noexcept {
    return {(has_moved_rows_ ? moved_rows_ : before().at).data(), before().histories.data()};
  }

  /// The step from `time` on begins to see and make: in place of what the one before the last did.
  struct Step {
    double time;       ///< [s]
    double time_step;  ///< [s]
  };
  void begin_step(const Step& step) {
    // Of a look that an exception ended, and that nobody undid, nothing is remembered.
    if (!is_whole_) seen_.at.assign(near_.size(), none);
    is_whole_ = false;
    std::swap(seen_, keeps_seen_ ? spare_seen_ : last_seen_);
    before_is_spare_ = keeps_seen_;
    keeps_seen_ = true;
    has_moved_rows_ = false;
    seen_.time_step = static_cast<Real>(step.time_step);
    seen_.time = step.time;
  }

  /// For what this look will see of the near contacts.
  void make_room() { seen_.resize(near_.size()); }
  /// All is seen; so many touch.
  void end_step(Index count) {
    seen_.count = count;
    is_whole_ = true;
  }

  /// find(near, found, validity) finds the near contacts anew.
  template <class Find>
  void renew_near(Find&& find) {
    NearContacts& last = keeps_near_ ? spare_near_ : last_near_;
    std::swap(near_, last);
    std::swap(validity_, keeps_near_ ? spare_validity_ : last_validity_);
    keeps_near_ = true;
    find(near_, found_, validity_);
    moved_rows_.assign(near_.size(), none);
    if (recalled() != nullptr) {
      recall();
    } else {
      last.tabulate();
      near_.for_each_contact([&](Index c) {
        const Index known = last.find(near_.first_id(c), near_.second_id(c));
        if (known != no_index) moved_rows_[c] = before().at[known];
      });
    }
    has_moved_rows_ = true;
  }

  /// From now on, this is what is remembered.
  void set_history(const Remembered& history) {
    recalled_ = history;
    was_recalled_ = false;
    validity_ = {};
  }

  /// That, until a look has taken it; else `nullptr`.
  const Remembered* recalled() const noexcept {
    return recalled_ && !was_recalled_ ? &*recalled_ : nullptr;
  }

  void save() noexcept {
    if (was_recalled_) recalled_.reset();
    keeps_seen_ = keeps_near_ = was_recalled_ = false;
  }
  void restore() noexcept {
    if (keeps_seen_) {
      std::swap(seen_, last_seen_);
      is_whole_ = true;
    }
    if (keeps_near_) {
      std::swap(near_, last_near_);
      std::swap(validity_, last_validity_);
    }
    keeps_seen_ = keeps_near_ = was_recalled_ = false;
  }

 private:
  const Seen& before() const noexcept { return before_is_spare_ ? spare_seen_ : last_seen_; }

  // Rows of their own for what a restart remembers.
  void recall() {
    before_is_spare_ = true;
    spare_seen_.resize(near_.size());
    near_.for_each_contact([&](Index c) {
      const auto* const known = recalled_->find(near_.first_id(c), near_.second_id(c));
      if (known == nullptr) return;
      moved_rows_[c] = static_cast<std::uint32_t>(first_row + c);
      History::put(*known, spare_seen_.history(moved_rows_[c]));
    });
    was_recalled_ = true;
  }

  Seen seen_;
  Seen last_seen_;
  Seen spare_seen_;  // for a second look within a step
  NearContacts near_;
  NearContacts last_near_;
  NearContacts spare_near_;
  NearContacts::Found found_;
  Validity validity_;
  Validity last_validity_;
  Validity spare_validity_;
  std::vector<std::uint32_t> moved_rows_;  // where the contacts just found were before
  std::optional<Remembered> recalled_;
  bool is_whole_ = true;  // what was seen last
  bool keeps_seen_ = false;
  bool keeps_near_ = false;
  bool before_is_spare_ = false;
  bool has_moved_rows_ = false;
  bool was_recalled_ = false;
};

}  // namespace silt::dem
