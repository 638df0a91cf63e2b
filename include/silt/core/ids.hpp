// SPDX-License-Identifier: MIT
// The permanent ids of particles: by index, first those of owned particles, then those of the halo,
// then those of ghosts, which have their owner's id; and the index of each.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/id_table.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <span>

namespace silt::detail {

class Ids {
 public:
  /// Number of owned particles, halo and ghosts.
  Index size() const noexcept { return ids_.size(); }
  Index capacity() const noexcept { return ids_.capacity(); }
  Id operator[](Index i) const noexcept { return ids_[i]; }
  std::span<const Id> first(Index n) const noexcept { return {ids_.data(), n}; }
  /// `no_index` if the particle was removed or never added.
  Index index_of(Id id) const noexcept { return id < next_id_ ? table_.find(id, ids_) : no_index; }

  /// For n particles, of which `present` are there.
  void reserve(Index n, Index present) {
    ids_.reserve(n);
    table_.make_room(n, std::max<Id>(next_id_, n), first(present));
  }
  /// For one more particle or ghost: adding it does not throw. Returns the capacity.
  Index make_room() {
    reserve_one_more(ids_);
    return ids_.capacity();
  }

  // There must be no ghosts from here on.

  /// For one more particle, in addition to make_room().
  void make_room_for_id() { table_.make_room(ids_.size() + 1, next_id_ + 1, ids_); }
  /// Adds a particle with a new id.
  void add() {
    ids_.push_back(next_id_++);
    table_.add(ids_.size() - 1, ids_);
  }
  /// Moves an id to the place of a particle that is removed; finish_removal() follows.
  void move(Index from, Index to) { ids_[to] = ids_[from]; }
  /// Keeps the first n.
  void finish_removal(Index n) {
    ids_.resize(n);
    table_.assign(ids_);
  }
  /// Gives particle i another id; finish_order() follows.
  void set(Index i, Id id) noexcept { ids_[i] = id; }
  /// After the same ids were put into another order.
  void finish_order() noexcept { table_.assign(ids_); }

  /// Adds a particle of another process. False if there is one with this id; it is added all the same.
  bool add_other(Id id) {
    next_id_ = std::max(next_id_, id + 1);
    table_.make_room(ids_.size() + 1, next_id_, ids_);
    ids_.push_back(id);
    return table_.add(ids_.size() - 1, ids_);
  }
  void add_ghost(Index owner) { ids_.push_back(ids_[owner]); }
  /// Removes the ghosts of n particles.
  void resize(Index n) { ids_.resize(n); }

  /// Writes or reads the first n for a checkpoint, see core/transfer.hpp. Throws if those read are
  /// repeated or were never given.
  template <class Archive>
  void transfer(Archive& archive, Index n) {
    archive("next_id", next_id_);
    archive("id", ids_, n);
    if constexpr (Archive::reads) table_ = {ids_, next_id_};
  }

 private:
  Buffer<Id> ids_;
  Id next_id_ = 0;
  IdTable table_;
};

}  // namespace silt::detail
