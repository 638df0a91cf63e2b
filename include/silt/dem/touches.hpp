// SPDX-License-Identifier: MIT
// What contacts keep from step to step, and how a failed step is undone: nothing that a step before
// made is written over, so that undoing is a swap.
#pragma once

#include <silt/core/pair_memory.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/near_contacts.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace silt::dem {

template <int Dim, class RealType, int words>
class Touches {
 public:
  using Real = RealType;
  using Near = NearContacts<Real, words>;

  /// What one step made.
  struct Seen {
    std::vector<Real> rows;  ///< by contact, see ContactLanes
    Index count = 0;         ///< contacts that touch
    Real time_step = 0;      ///< [s]
  };
  /// Since when, and how long, the near contacts are good.
  struct Validity {
    std::vector<Vec<Dim, Real>> since;  ///< positions of the owned grains [m]
    double travelled = 0;               ///< of the search then, see KnowsTravel [m]
    Real margin = 0;                    ///< gap up to which pairs are near [m]
    std::uint64_t revision = std::numeric_limits<std::uint64_t>::max();
    double stable_time_step = 0;  ///< that all near contacts stand [s]
  };

  const Seen& seen() const noexcept { return seen_; }
  Seen& seen() noexcept { return seen_; }
  const Near& near() const noexcept { return near_; }
  const Validity& validity() const noexcept { return validity_; }
  Validity& validity() noexcept { return validity_; }

  /// The step begins to see and make: in place of what the one before the last did.
  void begin_step() {
    if (keeps_seen_) return;
    std::swap(seen_, last_seen_);
    keeps_seen_ = true;
  }

  /// find(near, validity, recall) finds the near contacts anew; recall(first id, second id, words)
  /// is what find_all takes.
  template <class Find>
  void renew_near(Find&& find) {
    Near& before = keeps_near_ ? spare_near_ : last_near_;
    Validity& validity_before = keeps_near_ ? spare_validity_ : last_validity_;
    std::swap(near_, before);
    std::swap(validity_, validity_before);
    keeps_near_ = true;
    if (recalled_) {
      find(near_, validity_, [this](Id a, Id b, typename Near::Words& own) {
        if (const auto* const known = recalled_->find(a, b)) own = *known;
      });
      recalled_.reset();
    } else {
      before.tabulate();
      find(near_, validity_,
           [&](Id a, Id b, typename Near::Words& own) { before.recall(a, b, own); });
    }
  }

  /// From now on, this is what is remembered.
  void remember(PairMemory<typename Near::Words> memory) {
    recalled_ = std::move(memory);
    validity_ = {};
  }

  /// ask(near, before, after) asks the law; before(group) is where it finds what it remembers, after(group)
  /// where it leaves that.
  template <class Ask>
  void use_memory(Ask&& ask) {
    if (keeps_near_ || keeps_memory_) {
      const auto in_place = [this](Index group) { return near_.memory(group); };
      ask(near_, in_place, in_place);
      return;
    }
    near_.make_room_for_next_memory();
    ask(near_, [this](Index group) { return near_.memory(group); },
        [this](Index group) { return near_.next_memory(group); });
    near_.swap_memory();
    keeps_memory_ = true;
  }

  void save() noexcept { keeps_seen_ = keeps_near_ = keeps_memory_ = false; }
  void restore() noexcept {
    if (keeps_seen_) std::swap(seen_, last_seen_);
    if (keeps_near_) {
      std::swap(near_, last_near_);
      std::swap(validity_, last_validity_);
    }
    if (keeps_memory_) near_.swap_memory();
    save();
  }

 private:
  Seen seen_;
  Seen last_seen_;
  Near near_;
  Near last_near_;
  Near spare_near_;  // for a second search within a step
  Validity validity_;
  Validity last_validity_;
  Validity spare_validity_;
  std::optional<PairMemory<typename Near::Words>> recalled_;
  bool keeps_seen_ = false;
  bool keeps_near_ = false;
  bool keeps_memory_ = false;
};

}  // namespace silt::dem
