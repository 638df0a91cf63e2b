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
#include <silt/core/buffer.hpp>
#include <silt/core/columns.hpp>
#include <silt/core/error.hpp>
#include <silt/core/field_storage.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particle_table.hpp>
#include <silt/core/tuples.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace silt {

/// A field of a particle that is added, and its value.
template <Field F, class Value>
struct Initial {
  F field;
  Value value;
};
template <Field F, class Value>
Initial(F, Value) -> Initial<F, Value>;

/// Particles in Dim dimensions with a position and the given fields. A Bundle among them says that
/// these fields, which are given as well, are stored side by side; see core/field_storage.hpp.
///
///   p[position][i]   Vec<Dim, Real>& of owned particle i [m]
///   p[field]         the values of the size() owned particles: a std::span, or a FieldView if the
///                    field is stored in a bundle. Valid until particles are added, removed or
///                    reordered, and until the next step.
template <int Dim, class RealType, FieldOrBundle... Fields>
class Particles : public ParticleTable {
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

  Particles() : ParticleTable(detail::row_type_of<Vec>) {}
  /// No particles, in this box. Throws as Box::check() does.
  explicit Particles(const Box<Dim, Real>& box) : Particles() {
    box.check();
    box_ = box;
  }

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
  auto storage(F field) const noexcept {
    return columns_.storage(field);
  }

  const Box<Dim, Real>& box() const noexcept { return box_; }
  /// Throws if the box has no volume, or if a periodic side is not finite.
  void set_box(const Box<Dim, Real>& box) {
    box.check();
    clear_ghosts();
    box_ = box;
    note_change();
  }

  void reserve(Index n) { ParticleTable::reserve(columns_.all(), n); }

  /// Adds a particle at x [m] behind the others and returns its index; fields without an initial
  /// value are zero. Removes halo and ghosts. Throws if x is not finite. If it throws, no particle
  /// is added.
  template <Field... F, class... Values>
  Index add(const Vec& x, const Initial<F, Values>&... initial) {
    (check_field<F>(), ...);
    require_finite("Particles::add: position", x);
    const Vec at = x;  // x may be one of the positions
    const Index i = ParticleTable::add(columns_.all());
    columns_.view(position, size())[i] = at;
    try {
      ((columns_.view(initial.field, size())[i] = initial.value), ...);
    } catch (...) {
      ParticleTable::remove(columns_.all(), std::array{i});
      throw;
    }
    return i;
  }

  /// Removes every owned particle i for which removed(i) is true; the others keep their order.
  /// Returns the number of particles removed. If it throws, for example because removed(i) does, no
  /// particle is removed.
  template <std::predicate<Index> Removed>
  Index remove_if(Removed&& removed) {
    clear_ghosts();
    // All are known before the first row is moved: removed(i) may throw, or read other rows.
    Buffer<Index> gone;
    for (Index i = 0; i < size(); ++i) {
      if (removed(i)) gone.push_back(i);
    }
    ParticleTable::remove(columns_.all(), gone);
    return gone.size();
  }

  /// Removes one particle by id. Throws if there is none.
  void remove(Id id) {
    const Index index = index_of(id);
    if (index == no_index) {
      fail({"Particles::remove: no particle has the id ", id, "; it was removed or never added"});
    }
    remove_if([index](Index i) { return i == index; });
  }

  /// Moves row order[i] to row i. Throws unless `order` is a permutation of 0 … size()-1.
  void reorder(std::span<const Index> order) {
    ParticleTable::reorder(columns_.all(), order);
  }

  // The halo, see mpi/shared_particles.hpp.

  /// Removes it, and the ghosts.
  void clear_halo() { ParticleTable::clear_halo(columns_.all()); }
  /// Replaces it by particles with these ids, all fields zero. Removes the ghosts. Throws if a
  /// particle is here already; the halo is then empty.
  void set_halo(std::span<const Id> ids) { ParticleTable::set_halo(columns_.all(), ids); }
  /// Adds an owned particle with this id, all fields zero, and returns its index. Removes halo and
  /// ghosts. Throws if it is here already.
  Index adopt(Id id) { return ParticleTable::adopt(columns_.all(), id); }
  /// The values of the owned particles and of the halo, to be changed in the halo only.
  template <Field F>
  auto halo_to_change(F field) noexcept {
    check_field<F>();
    note_ghosts();
    return columns_.view(field, local());
  }

  // Ghosts, see search/ghosts.hpp.

  /// Removes all ghosts.
  void clear_ghosts() { ParticleTable::clear_ghosts(columns_.all()); }

  /// Adds a ghost of row `source` (of any kind), displaced by `shift` [m].
  void add_ghost(Index source, const Vec& shift) {
    const bool is_of_ghost = source >= local();
    const Vec before = is_of_ghost ? shift_of(source - local()) : Vec(Vec::Zero());
    const Index g = ParticleTable::add_ghost(columns_.all(), source);
    shift_of(g) = is_of_ghost ? Vec(before + shift) : shift;
    columns_.view(position, total()).back() += shift;
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
    note_ghosts();
    (columns_.copy_from_owners(F{}, local(), owners_), ...);
    if constexpr ((std::same_as<F, position_t> || ...)) {
      const auto x = columns_.view(position, total());
      for_each(owners_.size(), [&](Index g) { x[local() + g] += shift_of(g); });
    }
  }

  /// f(values, field) for every field, position first: the values of the owned particles.
  template <class F>
  void for_each_field(F&& f) const {
    detail::for_each_tag(std::type_identity<FieldList>{},
                         [&](auto field) { f(columns_.view(field, size()), field); });
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
      resize(columns_.all(), ids_.size());
    }
    detail::for_each_tag(std::type_identity<FieldList>{},
                         [&](auto field) { transfer(archive, field, owned); });
    if constexpr (Archive::reads) note_change();
  }

  // For rolling back a failed step, see Columns: save() before the step, restore() if it throws.

  /// Begins a step, of which restore() undoes what is passed to keep() and advance().
  void save() noexcept {
    ParticleTable::save(columns_.all());
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
    ParticleTable::finish_advance(columns_.all(), max_displacement);
  }
  /// The values before save(), of the fields passed to keep() and advance().
  void restore() noexcept { ParticleTable::restore(columns_.all()); }

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
        fail({"Particles: ", name_of<F>(), " has ", column.size(), " values for ", values.size(),
              " particles; use an earlier checkpoint"});
      }
      std::copy(column.begin(), column.end(), values.begin());
    }
  }

  Vec& shift_of(Index ghost) { return reinterpret_cast<Vec*>(shifts_.data())[ghost]; }

  Columns<Dim, Real, typename Storage::Units> columns_;
  Box<Dim, Real> box_;
};

/// P has all of these fields.
template <class P, class... Fs>
concept HasFields = (P::template has<Fs> && ...);

}  // namespace silt
