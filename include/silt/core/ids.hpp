// SPDX-License-Identifier: MIT
// The permanent ids of particles, and the index of each:
//
//   by index     [ 4  1  3 | 1 … ]        owned particles, then ghosts, which have their owner's id
//   index of id  [ –  1  –  2  0 ]        of owned particles; none for those that were removed
#pragma once

#include <silt/core/types.hpp>

#include <span>
#include <vector>

namespace silt::detail {

class Ids {
 public:
  /// Number of owned particles and ghosts.
  Index size() const noexcept { return ids_.size(); }
  Id operator[](Index i) const noexcept { return ids_[i]; }
  std::span<const Id> first(Index n) const noexcept { return {ids_.data(), n}; }
  /// `no_index` if the particle was removed or never added.
  Index index_of(Id id) const noexcept {
    return id < index_of_id_.size() ? index_of_id_[id] : no_index;
  }

  void reserve(Index n) {
    ids_.reserve(n);
    index_of_id_.reserve(n);
  }
  /// For one more particle or ghost: adding it does not throw. Returns the capacity for both.
  Index make_room() {
    reserve_one_more(ids_);
    reserve_one_more(index_of_id_);
    return ids_.capacity();
  }

  /// Adds a particle with a new id. There must be no ghosts, as for all of the following.
  void add() {
    ids_.push_back(index_of_id_.size());
    index_of_id_.push_back(ids_.size() - 1);
  }
  /// Removes a particle; its place is still to be filled by move(), or removed by resize().
  void remove(Index i) { index_of_id_[ids_[i]] = no_index; }
  void move(Index from, Index to) {
    ids_[to] = ids_[from];
    index_of_id_[ids_[to]] = to;
  }
  /// The ids of particles order[i].
  std::vector<Id> in_order(std::span<const Index> order) const {
    std::vector<Id> ids(order.size());
    for (Index i = 0; i < order.size(); ++i) ids[i] = ids_[order[i]];
    return ids;
  }
  /// Replaces the ids by the same ones in another order. Does not throw.
  void set_order(std::vector<Id>&& ids) {
    ids_.swap(ids);
    for (Index i = 0; i < ids_.size(); ++i) index_of_id_[ids_[i]] = i;
  }

  void add_ghost(Index owner) { ids_.push_back(ids_[owner]); }
  /// Keeps the first n.
  void resize(Index n) { ids_.resize(n); }

  /// Writes or reads the first n for a checkpoint, see core/transfer.hpp. Returns whether they are
  /// valid: false if those read are repeated or were never given.
  template <class Archive>
  bool transfer(Archive& archive, Index n) {
    Index next_id = index_of_id_.size();
    archive("next_id", next_id);
    archive("id", ids_, n);
    if constexpr (!Archive::reads) return true;
    index_of_id_.assign(next_id, no_index);
    for (Index i = 0; i < ids_.size(); ++i) {
      if (ids_[i] >= next_id || index_of_id_[ids_[i]] != no_index) return false;
      index_of_id_[ids_[i]] = i;
    }
    return true;
  }

 private:
  std::vector<Id> ids_;
  std::vector<Index> index_of_id_;
};

}  // namespace silt::detail
