// SPDX-License-Identifier: MIT
// A list of contacts in a checkpoint. With it, a resumed run rebuilds the list, and sorts the
// grains, in the same steps as without a restart; see is_stale().
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/contact/pair_history.hpp>

#include <cstdint>
#include <vector>

namespace silt::dem::detail {

template <int Dim, class Real>
class SavedList {
 public:
  using List = ReusableList<Dim, Real>;

  /// Without a list, or with one of the grains as they are.
  SavedList() = default;
  explicit SavedList(const List& list) : is_known_(true), origin_(list) {
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
    archive("since", origin_.since);
    archive("margin", origin_.margin);
    archive("time", origin_.time);
    archive("extent_lower", origin_.extent.lower);
    archive("extent_upper", origin_.extent.upper);
    archive("stable_time_step", origin_.stable_time_step);
  }

  /// Whether there is a list, of these grains and of walls with so many elements.
  template <class P>
  bool fits(const P& grains, Index elements) const {
    if (!is_known_ || origin_.since.size() != grains.size() || first_.size() != second_.size()) {
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
  void restore(const P& grains, List& list,
               std::vector<ContactList::PairsOfBlock>& by_block) const {
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
        by_block);
    static_cast<ListOrigin<Dim, Real>&>(list) = origin_;
    list.owned_revision = grains.owned_revision();
    keep_constants(grains, list);
  }

 private:
  static Index element_of(Id id) { return ~id; }

  bool is_known_ = false;
  std::vector<Id> first_;
  std::vector<Id> second_;
  ListOrigin<Dim, Real> origin_;
};

}  // namespace silt::dem::detail
