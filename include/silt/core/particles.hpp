// SPDX-License-Identifier: MIT
// The particle container: a column for each field, or rows of several fields
// (field_storage.hpp), permanent ids, halo and ghosts.
//
//            owned: 0 … size()-1   halo: … local()-1        ghosts: … total()-1
//   position [ x0 x1 x2 …        | those of particles of  | copies of the particles before,
//                                | other processes        | shifted by a period             ]
//   velocity [ u0 u1 u2 …        | u7 u8 …                | copies                          ]
//   id       [ 17  3  4 …        | 21 5 …                 | that of the copied particle     ]
//
// Only processes that share their particles have a halo, see mpi/shared_particles.hpp.
// Identify particles across steps by id, not by index: a search may reorder them in memory.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/columns.hpp>
#include <silt/core/error.hpp>
#include <silt/core/field_storage.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/ids.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/permutation.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silt {

/// Particles in Dim dimensions with a position and the given fields. A Bundle among them says that
/// these fields, which are given as well, are stored side by side; see core/field_storage.hpp.
///
///   p[position][i]   Vec<Dim, Real>& of owned particle i [m]
///   p[field]         the values of the size() owned particles: a std::span, or a FieldView if the
///                    field is stored in a bundle. Valid until particles are added, removed or
///                    reordered, and until the next step.
template <int Dim, class RealType, FieldOrBundle... Fields>
class Particles {
  static_assert(Dim == 2 || Dim == 3, "silt::Particles: the dimension is 2 or 3");
  static_assert(std::floating_point<RealType>, "silt::Particles: Real is float or double");

 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  /// Whether the particles have this field; see HasFields.
  template <class F>
  static constexpr bool has = std::same_as<F, position_t> || (std::same_as<F, Fields> || ...);

  Particles() = default;
  /// No particles, in this box. Throws as Box::check() does.
  explicit Particles(Box<Dim, Real> box) : box_(std::move(box)) { box_.check(); }

  /// Number of owned particles.
  Index size() const noexcept { return local() - halo_; }
  bool empty() const noexcept { return size() == 0; }
  /// Number of owned particles and those of the halo.
  Index local() const noexcept { return ids_.size() - owners_.size(); }
  /// Number of owned particles, those of the halo, and ghosts.
  Index total() const noexcept { return ids_.size(); }

  template <Field F>
  auto operator[](F field) noexcept {
    check_field<F>();
    if constexpr (std::same_as<F, position_t>) positions_changed_.set();
    if constexpr (role_of<F>() == Role::constant) constants_changed_.set();
    if constexpr (role_of<F>() == Role::state) state_changed_.set();
    return columns_.view(field, size());
  }
  template <Field F>
  auto operator[](F field) const noexcept {
    check_field<F>();
    return columns_.view(field, size());
  }

  /// The values of the owned particles, followed by those of the halo and the ghosts; an index from a
  /// search may refer to any.
  template <Field F>
  auto with_ghosts(F field) const noexcept {
    check_field<F>();
    return columns_.view(field, total());
  }
  /// The values of the owned particles, followed by those of the halo; owner(i) refers to either.
  template <Field F>
  auto with_halo(F field) const noexcept {
    check_field<F>();
    return columns_.view(field, local());
  }
  /// The storage of a field: a column, or the rows of a bundle, see core/field_storage.hpp.
  template <Field F>
  const auto& storage(F field) const noexcept {
    return columns_.storage(field);
  }

  /// Permanent id of particle i, which may be of the halo or a ghost.
  Id id(Index i) const noexcept { return ids_[i]; }
  /// Ids of the owned particles.
  std::span<const Id> ids() const noexcept { return ids_.first(size()); }
  /// Ids of the owned particles and of those of the halo.
  std::span<const Id> ids_with_halo() const noexcept { return ids_.first(local()); }
  /// Index of the particle with this id, owned or of the halo; `no_index` if it was removed or never
  /// added.
  Index index_of(Id id) const noexcept { return ids_.index_of(id); }
  /// Index of the particle, owned or of the halo, of which i is a ghost; i itself if i is none.
  Index owner(Index i) const noexcept { return i < local() ? i : owners_[i - local()]; }

  /// Increases whenever particles or ghosts are added, removed or reordered. Two containers have
  /// the same value only if one is a copy of the other.
  std::uint64_t revision() const noexcept { return revision_; }
  /// Increases whenever owned particles are added, removed or reordered, or the box changes. Unlike
  /// revision(), it is the same after a failed step as before.
  std::uint64_t owned_revision() const noexcept { return owned_revision_; }

  /// Upper bound of the displacement of the owned particles by steps, except that a periodic side
  /// was crossed; begins anew whenever positions may have been changed otherwise, that is, with
  /// every access to p[position] that is not const. Not to be called by several threads at once.
  Travel travel() const noexcept {
    if (positions_changed_.test_and_clear()) travel_ = {.epoch = next_revision(), .distance = 0};
    return travel_;
  }
  /// Increases whenever a field that steps do not change, such as the radius, may have been
  /// changed: after an access that is not const, with every call until save(), because its view may
  /// be written to until the next step. Not to be called by several threads at once.
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

  const Box<Dim, Real>& box() const noexcept { return box_; }
  /// Throws if the box has no volume, or if a periodic side is not finite.
  void set_box(const Box<Dim, Real>& box) {
    box.check();
    clear_ghosts();
    box_ = box;
    note_change();
  }

  void reserve(Index n) {
    columns_.for_each([n](auto& storage) { storage.reserve(n); });
    ids_.reserve(n, local());
  }

  /// Adds a particle at x [m], all other fields zero, and returns its index. Removes halo and ghosts.
  /// Throws if x is not finite. If it throws, no particle is added.
  Index add(const Vec& x) {
    require_finite("Particles::add: position", x);
    const Vec at = x;  // x may be one of the positions
    clear_halo();
    make_room();
    ids_.make_room_for_id();
    const Index i = size();
    columns_.for_each([](auto& storage) { storage.push_zero(); });
    ids_.add();
    (*this)[position][i] = at;
    note_change();
    return i;
  }

  /// Removes every owned particle i for which removed(i) is true; the others keep their order.
  /// Returns the number of particles removed. If it throws, for example because removed(i) does, no
  /// particle is removed.
  template <std::predicate<Index> Removed>
  Index remove_if(Removed&& removed) {
    clear_ghosts();
    // All are known before the first row is moved: removed(i) may throw, or read other rows.
    std::vector<Index> gone;
    for (Index i = 0; i < size(); ++i) {
      if (removed(i)) gone.push_back(i);
    }
    if (gone.empty()) return 0;
    Index kept = gone.front();
    auto next_gone = gone.begin();
    for (Index i = kept; i < local(); ++i) {
      if (next_gone != gone.end() && *next_gone == i) {
        ++next_gone;
      } else {
        move_row(i, kept++);
      }
    }
    columns_.for_each([kept](auto& storage) { storage.resize(kept); });
    ids_.finish_removal(kept);
    note_change();
    return gone.size();
  }

  /// Removes one particle by id. Throws if there is none.
  void remove(Id id) {
    const Index index = index_of(id);
    if (index == no_index) {
      fail("Particles::remove: no particle has the id " + std::to_string(id) +
           "; it was removed or never added");
    }
    remove_if([index](Index i) { return i == index; });
  }

  /// Moves row order[i] to row i. Throws unless `order` is a permutation of 0 … size()-1.
  void reorder(std::span<const Index> order) {
    clear_ghosts();
    detail::check_permutation(order, size());
    auto ids = ids_.in_order(order);
    columns_.reorder(order);
    ids_.set_order(std::move(ids));
    note_change();
  }

  // The halo, see mpi/shared_particles.hpp.

  /// Removes it, and the ghosts.
  void clear_halo() {
    clear_ghosts();
    if (halo_ == 0) return;
    const Index owned = size();
    columns_.for_each([owned](auto& storage) { storage.resize(owned); });
    ids_.finish_removal(owned);
    halo_ = 0;
    note_change();
  }
  /// Replaces it by particles with these ids, all fields zero. Removes the ghosts. Throws if a
  /// particle is here already; the halo is then empty.
  void set_halo(std::span<const Id> ids) {
    clear_halo();
    reserve(size() + ids.size());
    for (const Id id : ids) {
      columns_.for_each([](auto& storage) { storage.push_zero(); });
      ++halo_;
      if (ids_.add_other(id)) continue;
      clear_halo();
      fail("Particles: the particle " + std::to_string(id) + " is on two processes");
    }
    note_change();
  }
  /// Adds an owned particle with this id, all fields zero, and returns its index. Removes halo and
  /// ghosts. Throws if it is here already.
  Index adopt(Id id) {
    clear_halo();
    if (index_of(id) != no_index) {
      fail("Particles::adopt: the particle " + std::to_string(id) + " is here already");
    }
    make_room();
    columns_.for_each([](auto& storage) { storage.push_zero(); });
    ids_.add_other(id);
    note_change();
    return size() - 1;
  }
  /// The values of the owned particles and of the halo, to be changed in the halo only.
  template <Field F>
  auto halo_to_change(F field) noexcept {
    check_field<F>();
    ghosts_revision_ = next_revision();
    return columns_.view(field, local());
  }

  // Ghosts, see search/ghosts.hpp.

  /// Removes all ghosts.
  void clear_ghosts() {
    if (owners_.empty()) return;
    revision_ = next_revision();
    const Index rows = local();
    columns_.for_each([rows](auto& storage) { storage.resize(rows); });
    ids_.resize(rows);
    owners_.clear();
    shifts_.clear();
  }

  /// Adds a ghost of row `source` (of any kind), displaced by `shift` [m].
  void add_ghost(Index source, const Vec& shift) {
    revision_ = next_revision();
    make_room();
    const Index owner_index = owner(source);
    const Vec total_shift = source < local() ? shift : Vec(shifts_[source - local()] + shift);
    columns_.for_each([source](auto& storage) { storage.push_copy(source); });
    ids_.add_ghost(owner_index);
    columns_.view(position, total()).back() += shift;
    owners_.push_back(owner_index);
    shifts_.push_back(total_shift);
  }

  /// Copies these fields of the owners to their ghosts; positions are shifted. Of particles that
  /// processes share, all call it, and it copies them to the halo before.
  template <Field... F>
  void refresh_ghosts(F... fields) {
    copy_to_ghosts(fields...);
  }
  /// The same without the halo, which one process may do alone.
  template <Field... F>
  void copy_to_ghosts(F...) {
    (check_field<F>(), ...);
    ghosts_revision_ = next_revision();
    for_each(owners_.size(), [&](Index g) { (refresh_ghost<F>(g), ...); });
  }

  /// f(values, field) for every field, position first: the values of the owned particles.
  template <class F>
  void for_each_field(F&& f) const {
    std::apply([&](auto... field) { (f(columns_.view(field, size()), field), ...); }, FieldList{});
  }

  /// Writes or reads everything but the ghosts for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.same("dimension", std::to_string(Dim));
    archive.same("precision", sizeof(Real) == 4 ? "float" : "double");
    std::string names;
    for_each_field([&]<class F>(auto, F) {
      if (!names.empty()) names += ' ';
      names += name_of<F>();
    });
    archive.same("fields", names);
    if constexpr (Archive::reads) clear_halo();
    const Index owned = size();
    ids_.transfer(archive, owned);
    archive.within("box", [&] { box_.transfer(archive); });
    if constexpr (Archive::reads) {
      const Index bytes_of_each = std::apply(
          [](auto... field) { return (sizeof(value_of<decltype(field), Dim, Real>) + ... + 0); },
          FieldList{});
      archive.require_left(size(), bytes_of_each);
      columns_.for_each([&](auto& storage) { storage.resize(ids_.size()); });
    }
    std::apply([&](auto... field) { (transfer(archive, field, owned), ...); }, FieldList{});
    if constexpr (Archive::reads) note_change();
  }

  // For rolling back a failed step, see Columns: save() before the step, restore() if it throws.

  /// Begins a step, of which restore() undoes what is passed to keep() and advance().
  void save() noexcept {
    note_constants();
    columns_.save();
  }
  /// Saves the values of a field that the step then changes in place.
  template <Field F>
  void keep(F field) {
    if constexpr (std::same_as<F, position_t>) positions_changed_.set();
    columns_.keep(field);
  }
  /// Views of the values before the step, `before`, and of the memory for those after it, `after`,
  /// of the owned particles. They become the values by finish_advance().
  template <Field F>
  auto advance(F field) {
    return columns_.advance(field, size());
  }
  /// The same of a bundle: the addresses of its rows.
  template <Field F>
  auto advance_rows(F field) {
    return columns_.advance_rows(field);
  }
  /// Whether the next values of this field are written to other memory.
  template <Field F>
  bool is_advancing(F field) const noexcept {
    return columns_.is_advancing(field);
  }
  /// Makes the next values of the fields passed to advance() their values. No particle has moved
  /// farther than max_displacement [m], except across a periodic side.
  void finish_advance(double max_displacement = std::numeric_limits<double>::infinity()) {
    columns_.finish_advance(size(), std::max(revision_, ghosts_revision_));
    add_travel(max_displacement);
  }
  /// For the halo, which others advance: no particle of it has moved farther than this [m].
  void add_travel(double distance) {
    travel_.distance += distance;
    if (!is_finite(travel_.distance)) positions_changed_.set();
  }
  /// The values before save(), of the fields passed to keep() and advance().
  void restore() noexcept {
    columns_.restore(size());
    positions_changed_.set();
    state_changed_.set();  // the halo has values of the step that was undone
  }

 private:
  static_assert(!(std::same_as<Fields, position_t> || ...),
                "silt::Particles: position is always included; remove it from the template "
                "arguments");

  using Storage = detail::StorageList<position_t, Fields...>;
  using FieldList = typename Storage::List;

  // An assertion, for its error message. To test for a field, use HasFields.
  template <class F>
  static constexpr void check_field() {
    static_assert(has<F>,
                  "silt::Particles: these particles do not have this field; add its type "
                  "(temperature_t for temperature) to their template arguments");
  }

  void note_change() noexcept {
    revision_ = next_revision();
    owned_revision_ = revision_;
    positions_changed_.set();
    constants_changed_.set();
  }
  static std::uint64_t next_revision() noexcept {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
  }

  // For one more row, in all arrays at once: what is then added does not throw.
  void make_room() {
    const Index n = ids_.make_room();
    reserve_one_more(owners_);
    reserve_one_more(shifts_);
    columns_.for_each([n](auto& storage) { storage.reserve(n); });
  }

  template <class F>
  void refresh_ghost(Index g) {
    const auto values = columns_.view(F{}, total());
    auto& ghost = values[local() + g];
    ghost = values[owners_[g]];
    if constexpr (std::same_as<F, position_t>) ghost += shifts_[g];
  }

  void move_row(Index from, Index to) {
    columns_.for_each([from, to](auto& storage) { storage.copy(from, to); });
    ids_.move(from, to);
  }

  template <class Archive, class F>
  void transfer(Archive& archive, F field, Index owned) {
    const auto values = columns_.view(field, size());
    std::vector<value_of<F, Dim, Real>> column;
    if constexpr (!Archive::reads) column.assign(values.begin(), values.end());
    const auto transfer_column = [&] { archive(name_of<F>(), column, owned); };
    // Steps throw unless the state is finite. They overwrite derived fields, which may be anything
    // after a failed step; what the constants mean is known to their users only.
    if constexpr (role_of<F>() == Role::state && requires { is_finite(values[0]); }) {
      archive.finite(transfer_column);
    } else {
      transfer_column();
    }
    if constexpr (Archive::reads) {
      if (column.size() != values.size()) {
        fail("Particles: " + std::string(name_of<F>()) + " has " + std::to_string(column.size()) +
             " values for " + std::to_string(values.size()) +
             " particles; use an earlier checkpoint");
      }
      std::copy(column.begin(), column.end(), values.begin());
    }
  }

  Columns<Dim, Real, typename Storage::Units> columns_;
  detail::Ids ids_;
  Index halo_ = 0;             // number of particles in it
  std::vector<Index> owners_;  // by ghost
  std::vector<Vec> shifts_;    // by ghost
  Box<Dim, Real> box_;
  std::uint64_t revision_ = 0;
  std::uint64_t owned_revision_ = 0;
  std::uint64_t ghosts_revision_ = 0;  // of their values
  mutable detail::Mark positions_changed_{detail::Mark::Copied::set};
  mutable detail::Mark constants_changed_;
  detail::Mark state_changed_;
  mutable Travel travel_;
  mutable std::uint64_t constants_revision_ = 0;
};

/// P has all of these fields.
template <class P, class... Fs>
concept HasFields = (P::template has<Fs> && ...);

}  // namespace silt
