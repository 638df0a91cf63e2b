// SPDX-License-Identifier: MIT
// Data that contacts keep from step to step. The results of the previous step are not overwritten
// until the next save(), so that a failed step is rolled back by a swap.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/contact_row.hpp>
#include <silt/dem/contact/near_contacts.hpp>
#include <silt/dem/contact/pair_history.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace silt::dem {

/// History is the law's LawHistory.
template <int Dim, class RealType, class History, bool has_couple>
class Touches {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Row = ContactRow<has_couple>;
  using Lanes = LawLanes<Dim, Real, History::words, has_couple>;
  static constexpr bool couples = has_couple;
  static constexpr Index padded_words = Lanes::padded_words;
  using Remembered = PairHistory<typename History::type>;
  /// Row for pairs that do not touch: all zeros, with the history of a new contact. Reading it like
  /// any other avoids an unpredictable branch.
  static constexpr std::uint32_t none = 0;
  static constexpr std::uint32_t first_row = lanes;

  /// Results of one step. Only pairs that touch have their own row; the rows of a chunk of grains
  /// are contiguous and begin at first_row plus the index of the chunk's first near contact.
  struct Seen {
    using Row = ContactRow<has_couple>;
    std::vector<Real, Eigen::aligned_allocator<Real>> rows;       ///< see ContactRow
    std::vector<Real, Eigen::aligned_allocator<Real>> histories;  ///< padded_words a row
    std::vector<std::uint32_t> at;  ///< row number of each near contact, or `none`
    Index count = 0;                ///< number of contacts that touch
    Real time_step = 0;             ///< [s]
    double time = 0;                ///< of the positions [s]

    Seen() {
      resize(0);
      std::fill_n(rows.begin(), first_row * Row::words, Real(0));
      std::fill(histories.begin(), histories.end(), Real(0));
      if constexpr (History::words > 0) History::put({}, histories.data());
    }
    void resize(Index contacts) {
      resize_tightly(rows, (contacts + first_row) * Row::words);
      resize_tightly(histories, (contacts + first_row) * padded_words);
      resize_tightly(at, contacts);
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
  /// Conditions under which the list of near contacts remains valid.
  struct Validity {
    std::vector<Vec<Dim, Real>> since;  ///< positions of the owned grains at the rebuild [m]
    Travel travel;                      ///< of the search at the rebuild
    Real reach = 0;                     ///< twice the largest radius [m]
    Real margin = 0;                    ///< largest gap of near pairs [m]
    std::uint64_t revision = std::numeric_limits<std::uint64_t>::max();
    std::uint64_t owned_revision = std::numeric_limits<std::uint64_t>::max();
    double time = 0;              ///< of these positions and of the walls [s]
    Box<Dim, Real> extent;        ///< contains all grains while the list is valid [m]
    double stable_time_step = 0;  ///< stable even if all near pairs touch [s]
  };

  const Seen& seen() const noexcept { return seen_; }
  Seen& seen() noexcept { return seen_; }
  const NearContacts& near() const noexcept { return near_; }
  const Validity& validity() const noexcept { return validity_; }
  Validity& validity() noexcept { return validity_; }

  /// Histories of the contacts after the last evaluation.
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

  /// Begins the evaluation of the step from `time` on; overwrites the results of the step before
  /// the last one.
  struct Step {
    double time;       ///< [s]
    double time_step;  ///< [s]
  };
  void begin_step(const Step& step) {
    // If the last step threw and was not rolled back, drop its history.
    if (!is_whole_) seen_.at.assign(near_.size(), none);
    is_whole_ = false;
    std::swap(seen_, keeps_seen_ ? spare_seen_ : last_seen_);
    before_is_spare_ = keeps_seen_;
    keeps_seen_ = true;
    has_moved_rows_ = false;
    seen_.time_step = static_cast<Real>(step.time_step);
    seen_.time = step.time;
  }

  /// Resizes the rows for the near contacts of this step.
  void make_room() { seen_.resize(near_.size()); }
  /// Ends the evaluation; `count` contacts touch.
  void end_step(Index count) {
    seen_.count = count;
    is_whole_ = true;
  }

  /// Rebuilds the list of near contacts with find(near, found, validity).
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

  /// Replaces the histories of all contacts.
  void set_history(const Remembered& history) {
    recalled_ = history;
    was_recalled_ = false;
    validity_ = {};
  }

  /// The histories passed to set_history() until the next step uses them; otherwise `nullptr`.
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

  // Stores the histories passed to set_history() in rows.
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
  Seen spare_seen_;  // for a second evaluation without save()
  NearContacts near_;
  NearContacts last_near_;
  NearContacts spare_near_;
  NearContacts::Found found_;
  Validity validity_;
  Validity last_validity_;
  Validity spare_validity_;
  std::vector<std::uint32_t> moved_rows_;  // previous rows of the contacts after a rebuild
  std::optional<Remembered> recalled_;
  bool is_whole_ = true;  // the last evaluation was completed
  bool keeps_seen_ = false;
  bool keeps_near_ = false;
  bool before_is_spare_ = false;
  bool has_moved_rows_ = false;
  bool was_recalled_ = false;
};

}  // namespace silt::dem
