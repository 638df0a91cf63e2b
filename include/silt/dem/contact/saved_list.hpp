// SPDX-License-Identifier: MIT
// A list of contacts in a checkpoint. With it, a resumed run rebuilds the list, and sorts the
// grains, in the same steps as without a restart: as soon as a grain has moved by half the margin.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/list_constants.hpp>
#include <silt/dem/contact/list_renewal.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cstdint>
#include <vector>

namespace silt::dem {

template <int Dim, class Real>
class SavedList {
 public:
  using List = ListOfStep<Dim, Real>;

  /// Without a list, or with one of the grains as they are.
  SavedList() = default;
  explicit SavedList(const List& list)
      : is_known_(true),
        since_(list.since),
        margin_(list.margin),
        time_(list.time),
        extent_(list.extent),
        stable_time_step_(list.stable_time_step) {
    list.contacts.for_each_contact_by_grain([&](Index c) {
      first_.push_back(list.contacts.first_id(c));
      second_.push_back(list.contacts.second_id(c));
    });
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("is_known", is_known_);
    archive("first", first_);
    archive("second", second_);
    archive("since", since_);
    archive("margin", margin_);
    archive("time", time_);
    archive("extent_lower", extent_.lower);
    archive("extent_upper", extent_.upper);
    archive("stable_time_step", stable_time_step_);
  }

  /// Whether there is a list, of these grains and of walls with so many elements.
  template <class P>
  bool fits(const P& grains, Index elements) const {
    if (!is_known_ || since_.size() != grains.size() || first_.size() != second_.size()) {
      return false;
    }
    for (Index k = 0; k < first_.size(); ++k) {
      const bool is_second_known = is_wall_id(second_[k]) ? element_of(second_[k]) < elements
                                                          : grains.index_of(second_[k]) != no_index;
      if (grains.index_of(first_[k]) == no_index || !is_second_known) return false;
    }
    return true;
  }

  /// Requires fits().
  template <class P>
  void restore(const P& grains, List& list, std::vector<ContactList::Found>& found) const {
    std::vector<std::vector<Index>> of_grain(grains.size());
    for (Index k = 0; k < first_.size(); ++k) of_grain[grains.index_of(first_[k])].push_back(k);
    list.contacts.build(
        grains,
        [&](Index i, auto&& add) {
          for (const Index k : of_grain[i]) {
            if (is_wall_id(second_[k])) continue;
            add({static_cast<std::uint32_t>(i),
                 static_cast<std::uint32_t>(grains.index_of(second_[k]))});
          }
        },
        [&](Index i, auto&& add) {
          for (const Index k : of_grain[i]) {
            if (is_wall_id(second_[k])) add(static_cast<std::uint32_t>(element_of(second_[k])));
          }
        },
        found);
    list.since = since_;
    list.margin = margin_;
    list.owned_revision = grains.owned_revision();
    list.time = time_;
    list.extent = extent_;
    list.stable_time_step = stable_time_step_;
    detail::keep_constants(grains, list);
  }

 private:
  static Index element_of(Id id) { return ~id; }

  bool is_known_ = false;
  std::vector<Id> first_;
  std::vector<Id> second_;
  std::vector<Vec<Dim, Real>> since_;
  Real margin_ = 0;
  double time_ = 0;
  Box<Dim, Real> extent_;
  double stable_time_step_ = 0;
};

}  // namespace silt::dem
