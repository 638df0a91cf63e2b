// SPDX-License-Identifier: MIT
// The index in memory of every id of the present particles.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <string>

namespace silt::detail {

/// Its memory depends on the number of particles only, not on how many there were before: an inflow
/// and an outflow may use up any number of ids. As long as few were removed, an id is the number of
/// its slot; then slots are found by Fibonacci hashing with linear probing, Knuth, The Art of
/// Computer Programming, vol. 3, section 6.4. `ids` are always those of the particles by index, and
/// next_id is above all of them.
class IdTable {
 public:
  IdTable() = default;
  /// Of ids that were read. Throws unless all are different and below next_id, and that at most
  /// 2^63: larger ids belong to walls, see wall_id().
  IdTable(std::span<const Id> ids, Id next_id) {
    const auto refuse = [](Id id, const std::string& reason) {
      fail({"Particles: id = ", id, reason, "; use an earlier checkpoint"});
    };
    if (next_id > Id(1) << 63) refuse(next_id, " as the next one is above 2^63");
    for (const Id id : ids) {
      if (id >= next_id) refuse(id, " is not below next_id = " + std::to_string(next_id));
    }
    make_room(ids.size(), next_id, {});
    for (Index i = 0; i < ids.size(); ++i) {
      if (!add(i, ids)) refuse(ids[i], " occurs twice");
    }
  }

  Index find(Id id, std::span<const Id> ids) const noexcept {
    if (slots_.empty()) return no_index;
    for (Index slot = home(id);; slot = next(slot)) {
      const std::uint32_t i = slots_[slot];
      if (i == none) return no_index;
      if (ids[i] == id) return i;
    }
  }

  /// For that many particles with ids below next_id. If it throws, as for 2³² particles or more,
  /// nothing has changed.
  void make_room(Index number, Id next_id, std::span<const Id> ids) {
    if (is_direct_ && next_id <= slots_.size()) return;
    if (2 * number <= slots_.size()) {
      if (!is_direct_) return;
      is_direct_ = false;
    } else {
      if (number >= none) fail("Particles: 2^32 - 1 particles or more; use fewer in a process");
      Buffer<std::uint32_t> slots(std::bit_ceil(std::max<Index>(2 * number, 16)), none);
      slots_.swap(slots);
      is_direct_ = next_id <= slots_.size();
    }
    assign(ids);
  }

  /// Adds the id of particle i; requires make_room(). False if it is there already.
  bool add(Index i, std::span<const Id> ids) noexcept {
    Index slot = home(ids[i]);
    for (; slots_[slot] != none; slot = next(slot)) {
      if (ids[slots_[slot]] == ids[i]) return false;
    }
    slots_[slot] = static_cast<std::uint32_t>(i);
    return true;
  }

  /// After particles were removed or reordered.
  void assign(std::span<const Id> ids) noexcept {
    std::fill(slots_.begin(), slots_.end(), none);
    for (Index i = 0; i < ids.size(); ++i) add(i, ids);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  Index home(Id id) const noexcept {
    if (is_direct_) return id & (slots_.size() - 1);
    return (id * 0x9e3779b97f4a7c15u) >> (64 - std::countr_zero(slots_.size()));
  }
  Index next(Index slot) const noexcept { return (slot + 1) & (slots_.size() - 1); }

  Buffer<std::uint32_t> slots_;  // indices; a power of two
  bool is_direct_ = true;
};

}  // namespace silt::detail
