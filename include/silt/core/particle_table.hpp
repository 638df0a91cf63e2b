// SPDX-License-Identifier: MIT
// What of a particle container does not depend on its fields: permanent ids, halo and ghosts, which
// rows there are, and what has changed. Compiled once in a program, not for each list of fields.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/column.hpp>
#include <silt/core/error.hpp>
#include <silt/core/ids.hpp>
#include <silt/core/permutation.hpp>
#include <silt/core/time_levels.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace silt {

/// Base of all particle containers. A function that changes rows gets the columns, which the
/// container has; Particles describes each.
class ParticleTable {
 public:
  /// Number of owned particles.
  Index size() const noexcept { return local() - halo_; }
  bool empty() const noexcept { return size() == 0; }
  /// Number of owned particles and those of the halo.
  Index local() const noexcept { return ids_.size() - owners_.size(); }
  /// Number of owned particles, those of the halo, and ghosts.
  Index total() const noexcept { return ids_.size(); }

  /// Number of particles, halo and ghosts for which there is memory.
  Index capacity() const noexcept { return ids_.capacity(); }

  /// Permanent id of particle i, which may be of the halo or a ghost.
  Id id(Index i) const noexcept { return ids_[i]; }
  /// Ids of the owned particles.
  std::span<const Id> ids() const noexcept { return ids_.first(size()); }
  /// Ids of the owned particles and of those of the halo.
  std::span<const Id> ids_with_halo() const noexcept { return ids_.first(local()); }
  /// Index of the particle with this id, owned or of the halo; `no_index` if it was removed or
  /// never added.
  Index index_of(Id id) const noexcept { return ids_.index_of(id); }
  /// Index of the particle, owned or of the halo, of which i is a ghost; i itself if i is none.
  Index owner(Index i) const noexcept { return i < local() ? i : owners_[i - local()]; }

  /// Increases whenever particles or ghosts are added, removed or reordered. Two containers have
  /// the same value only if one is a copy of the other.
  std::uint64_t revision() const noexcept { return revision_; }
  /// Increases whenever owned particles are added, removed or reordered, or the box changes. Unlike
  /// revision(), it is the same after a failed step as before.
  std::uint64_t owned_revision() const noexcept { return owned_revision_; }
  /// Unchanged while particles are only added, at the end: the first rows are then those of before.
  /// A copy has the same value until a particle is added to it. Not changed by a failed step.
  std::uint64_t rows_revision() const noexcept { return rows_revision_; }
  /// Begins a new rows_revision() if this is a copy, whose first added particle would do so.
  void own_rows() noexcept {
    if (is_copy_.test_and_clear()) rows_revision_ = next_revision();
  }

  /// Upper bound of the displacement of the owned particles by steps, except that a periodic side
  /// was crossed; begins anew whenever positions may have been changed otherwise, that is, with
  /// every access to p[position] that is not const. Not to be called by several threads at once.
  Travel travel() const noexcept {
    if (positions_changed_.test_and_clear()) travel_ = {.epoch = next_revision(), .distance = 0};
    return travel_;
  }
  /// Increases whenever a field that steps do not change, such as the radius, may have been
  /// changed: after an access that is not const, with every call until save(), because its view may
  /// be written to until the next step. Not if particles are only added, see rows_revision(). Not
  /// to be called by several threads at once.
  std::uint64_t constants_revision() const noexcept {
    if (constants_changed_.is_set()) constants_revision_ = next_revision();
    return constants_revision_;
  }

  /// From now on, views that were taken before are not written to: constants_revision() is the same
  /// until the next access.
  void note_constants() noexcept {
    if (constants_changed_.test_and_clear()) constants_revision_ = next_revision();
  }

  /// Whether a field of the state may have been changed otherwise than by a step, since the last
  /// call of note_state(): by an access that is not const.
  bool has_state_changed() const noexcept { return state_changed_.is_set(); }
  /// The state is that of now: has_state_changed() is false until the next access.
  void note_state() noexcept { state_changed_.test_and_clear(); }
  /// For the halo, which others advance: no particle of it has moved farther than this [m].
  void add_travel(double distance) {
    travel_.distance += distance;
    if (!is_finite(travel_.distance)) positions_changed_.set();
  }

 protected:
  using AllColumns = std::span<detail::TimeLevels>;

  /// The vectors by which ghosts are displaced have this type.
  explicit ParticleTable(const detail::RowType& vector) : shifts_(vector) {}

  void reserve(AllColumns columns, Index n) {
    ids_.reserve(n, local());
    reserve_columns(columns, n);
  }
  static void resize(AllColumns columns, Index n) {
    for (auto& each : columns) each.now().resize(n);
  }
  Index add(AllColumns columns) {
    clear_halo(columns);
    make_room(columns);
    ids_.make_room_for_id();
    resize(columns, size() + 1);
    ids_.add();
    revision_ = next_revision();
    owned_revision_ = revision_;
    // Others may be added to the original.
    if (is_copy_.is_set()) {
      rows_revision_ = revision_;
      is_copy_.test_and_clear();
    }
    return size() - 1;
  }
  /// Removes the particles `gone`, in ascending order; there are no ghosts.
  void remove(AllColumns columns, std::span<const Index> gone) {
    if (gone.empty()) return;
    Index kept = gone.front();
    auto next_gone = gone.begin();
    for (Index i = kept; i < local(); ++i) {
      if (next_gone != gone.end() && *next_gone == i) {
        ++next_gone;
      } else {
        for (auto& each : columns) each.now().copy(i, kept);
        ids_.move(i, kept++);
      }
    }
    resize(columns, kept);
    ids_.finish_removal(kept);
    note_change();
  }
  void reorder(AllColumns columns, std::span<const Index> order) {
    clear_ghosts(columns);
    detail::Permutation permutation(order, size());
    // All that may throw comes before the first row is moved.
    Buffer<detail::Column*> copied;
    Buffer<detail::Column> sorted;
    copied.reserve(columns.size());
    sorted.reserve(columns.size());
    RowsToMove rows{.ids = ids_, .columns = {}, .aside = {}};
    rows.columns.reserve(columns.size());
    Index row_size = 0;
    for (auto& each : columns) {
      detail::Column& column = each.now();
      if (column.type().functions || column.is_shared()) {
        copied.push_back(&column);
        sorted.push_back(column.in_order(order));
      } else {
        rows.columns.push_back(&column);
        row_size += column.type().size;
      }
    }
    rows.aside.resize(row_size);
    permutation.move(rows);
    for (Index k = 0; k < sorted.size(); ++k) copied[k]->swap(sorted[k]);
    ids_.finish_order();
    note_change();
  }

  void clear_halo(AllColumns columns) {
    clear_ghosts(columns);
    if (halo_ == 0) return;
    const Index owned = size();
    resize(columns, owned);
    ids_.finish_removal(owned);
    halo_ = 0;
    note_change();
  }
  void set_halo(AllColumns columns, std::span<const Id> ids) {
    clear_halo(columns);
    reserve(columns, size() + ids.size());
    for (const Id id : ids) {
      resize(columns, total() + 1);
      ++halo_;
      if (ids_.add_other(id)) continue;
      clear_halo(columns);
      fail({"Particles: the particle ", id, " is on two processes"});
    }
    note_change();
  }
  Index adopt(AllColumns columns, Id id) {
    clear_halo(columns);
    if (index_of(id) != no_index) {
      fail({"Particles::adopt: the particle ", id, " is here already"});
    }
    make_room(columns);
    resize(columns, total() + 1);
    ids_.add_other(id);
    note_change();
    return size() - 1;
  }

  void clear_ghosts(AllColumns columns) {
    if (owners_.empty()) return;
    revision_ = next_revision();
    const Index rows = local();
    resize(columns, rows);
    ids_.resize(rows);
    owners_.clear();
    shifts_.resize(0);
  }
  /// Adds a ghost with the values of row `source`, and returns its number; its shift is zero.
  Index add_ghost(AllColumns columns, Index source) {
    revision_ = next_revision();
    make_room(columns);
    const Index owner_index = owner(source);
    for (auto& each : columns) each.now().push_copy(source);
    ids_.add_ghost(owner_index);
    owners_.push_back(owner_index);
    shifts_.resize(owners_.size());
    return owners_.size() - 1;
  }
  /// The values of halo or ghosts change.
  void note_ghosts() noexcept { ghosts_revision_ = next_revision(); }

  void save(AllColumns columns) noexcept {
    note_constants();
    for (auto& each : columns) each.save();
  }
  void finish_advance(AllColumns columns, double max_displacement) {
    const auto ghosts = std::max(revision_, ghosts_revision_);
    for (auto& each : columns) each.finish_advance(size(), ghosts);
    add_travel(max_displacement);
  }
  void restore(AllColumns columns) noexcept {
    for (auto& each : columns) each.restore(size());
    positions_changed_.set();
    state_changed_.set();  // the halo has values of the step that was undone
  }

  void note_change() noexcept {
    revision_ = next_revision();
    owned_revision_ = revision_;
    rows_revision_ = revision_;
    is_copy_.test_and_clear();
    positions_changed_.set();
    constants_changed_.set();
  }
  detail::Ids ids_;
  Buffer<Index> owners_;       // by ghost
  detail::Column shifts_;      // by ghost
  mutable detail::Mark positions_changed_{detail::Mark::Copied::set};
  mutable detail::Mark constants_changed_;
  detail::Mark state_changed_;
  detail::Mark is_copy_{detail::Mark::Copied::set};  // with the rows of another container

 private:
  static std::uint64_t next_revision() noexcept {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
  }
  // For Permutation::move().
  struct RowsToMove {
    detail::Ids& ids;
    Buffer<detail::Column*> columns;
    Buffer<std::byte> aside;  // one row of each column
    Id id_aside = 0;

    void move(Index from, Index to) noexcept {
      std::byte* place = aside.data();
      for (detail::Column* const column : columns) {
        const Index size = column->type().size;
        detail::copy_bytes(to == no_index ? place : column->row(to),
                           from == no_index ? place : column->row(from), size);
        place += size;
      }
      if (to == no_index) {
        id_aside = ids[from];
      } else {
        ids.set(to, from == no_index ? id_aside : ids[from]);
      }
    }
  };

  static void reserve_columns(AllColumns columns, Index n) {
    for (auto& each : columns) each.now().reserve(n);
  }
  // For one more row, in all arrays at once: what is then added does not throw.
  void make_room(AllColumns columns) {
    const Index n = ids_.make_room();
    reserve_one_more(owners_);
    shifts_.reserve(owners_.capacity());
    reserve_columns(columns, n);
  }

  Index halo_ = 0;  // number of particles in it
  std::uint64_t revision_ = 0;
  std::uint64_t owned_revision_ = 0;
  std::uint64_t rows_revision_ = 0;
  std::uint64_t ghosts_revision_ = 0;  // of their values
  mutable Travel travel_;
  mutable std::uint64_t constants_revision_ = 0;
};

}  // namespace silt
