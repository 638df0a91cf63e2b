// SPDX-License-Identifier: MIT
// A list of contacts in a checkpoint. With it, a resumed run rebuilds the list, and sorts the
// grains, in the same steps as without a restart; see is_stale().
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/wall/wall_set.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem::detail {

inline Index element_of(Id id) { return ~id; }

[[noreturn]] inline void refuse_pair(Id first, Id second, const std::string& reason) {
  const std::string name = is_wall_id(second)
                               ? "element " + std::to_string(element_of(second)) + " of the walls"
                               : "grain " + std::to_string(second);
  fail({"dem::Contacts: the contact of grain ", first, " with ", name, " ", reason,
        "; use an earlier checkpoint"});
}

/// Whether these ids may be those of a contact: of a present grain, and of another with a higher id
/// or of an element that walls may have.
template <class P>
bool may_touch(const P& grains, Id first, Id second) {
  const bool is_second_known = is_wall_id(second) ? element_of(second) < max_wall_elements
                                                  : grains.index_of(second) != no_index;
  return first < second && grains.index_of(first) != no_index && is_second_known;
}
/// Throws unless they may.
template <class P>
void check_pair(const P& grains, Id first, Id second) {
  if (may_touch(grains, first, second)) return;
  refuse_pair(first, second, "is impossible: one of them does not exist, or the order is wrong");
}

template <int Dim, class Real>
class SavedList {
 public:
  using List = ReusableList<Dim, Real>;

  /// Without a list, or with one of the grains as they are.
  SavedList() = default;
  explicit SavedList(const List& list) : is_known_(true), origin_(list) {
    list.contacts.for_each_contact_by_grain([&](Index c) {
      if (!list.contacts.is_owned(list.contacts.first(c))) return;  // another process saves it
      first_.push_back(list.contacts.first_id(c));
      second_.push_back(list.contacts.second_id(c));
    });
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("is_known", is_known_);
    archive("first", first_);
    archive("second", second_);
    Buffer<Vec<Dim, Real>> since;
    if constexpr (!Archive::reads) since.assign(origin_.since.begin(), origin_.since.end());
    archive("since", since);
    if constexpr (Archive::reads) origin_.since.assign(since.begin(), since.end());
    archive("margin", origin_.margin);
    archive("time", origin_.time);
    archive("extent_lower", origin_.extent.lower);
    archive("extent_upper", origin_.extent.upper);
    archive("stable_time_step", origin_.stable_time_step);
    archive("added", origin_.added);
  }

  /// Throws if there is a list that cannot be of these grains.
  template <class P>
  void check(const P& grains) const {
    if (!is_known_) return;
    if (origin_.since.size() > grains.size() || first_.size() != second_.size()) {
      fail({"dem::Contacts: the list has ", origin_.since.size(), " positions for ", grains.size(),
            " grains, and ", first_.size(), " and ", second_.size(),
            " partners of pairs; use an earlier checkpoint"});
    }
    Buffer<std::pair<Id, Id>> pairs(first_.size());
    for (Index k = 0; k < pairs.size(); ++k) {
      check_pair(grains, first_[k], second_[k]);
      for (const Id id : {first_[k], second_[k]}) {
        if (is_wall_id(id) || grains.index_of(id) < origin_.since.size()) continue;
        refuse_pair(first_[k], second_[k], "has no position in the list");
      }
      pairs[k] = {first_[k], second_[k]};
    }
    std::sort(pairs.begin(), pairs.end());
    const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
    if (twice != pairs.end()) refuse_pair(twice->first, twice->second, "occurs twice");
  }
  /// Whether there is a list, and walls with so many elements have all of its elements. They have
  /// not if the checkpoint is read by a simulation with other walls.
  bool fits(Index elements) const {
    return is_known_ && std::ranges::none_of(second_, [&](Id id) {
             return is_wall_id(id) && element_of(id) >= elements;
           });
  }

  /// Requires check() and fits().
  template <class P>
  void restore(const P& grains, List& list) const {
    const Index n = origin_.since.size();  // others may have been added after the last step
    std::vector<Buffer<Index>> of_grain(n);
    for (Index k = 0; k < first_.size(); ++k) of_grain[grains.index_of(first_[k])].push_back(k);
    list.contacts.build(grains.ids().first(n), n,
                        [&](Index first, Index last, ContactList::PairsOfBlock& pairs) {
                          for (Index i = first; i < last; ++i) {
                            for (const Index k : of_grain[i]) {
                              if (is_wall_id(second_[k])) {
                                pairs.add_wall(i, element_of(second_[k]));
                              } else {
                                pairs.add_pair(i, grains.index_of(second_[k]));
                              }
                            }
                          }
                        });
    static_cast<ListOrigin<Dim, Real>&>(list) = origin_;
    list.rows_revision = grains.rows_revision();
    list.constants.keep(grains, n);
    const auto& radii = list.constants.radii;
    list.largest_radius = largest(n, Real(0), [&](Index i) { return radii[i]; });
    list.boxes.clear();
  }

 private:
  bool is_known_ = false;
  Buffer<Id> first_;
  Buffer<Id> second_;
  ListOrigin<Dim, Real> origin_;
};

}  // namespace silt::dem::detail
