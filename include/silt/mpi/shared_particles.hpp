// SPDX-License-Identifier: MIT
// Particles of which every process owns those in its part of space. The halo has those of other
// processes within a depth of its own:
//
//   decide     all reduce what must be known together      agreement.hpp
//   migrate    particles that have left its part of space, with what the interaction remembers of
//              them, move to the process that owns where they are     migration.hpp
//   find halo  every process tells others of its particles near theirs
//   refresh    the values of the halo after every step
//
// The halo is deeper than the search radius, so that it is found anew only after particles have
// moved by a part of the radius.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/shared_particles.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/halo_rows.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/migration.hpp>
#include <silt/mpi/near_processes.hpp>
#include <silt/mpi/particle_messages.hpp>
#include <silt/mpi/world.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::mpi {

namespace detail {
/// How far an interaction moves particles within a step before it needs their neighbours again [m].
template <class I>
double max_move_within_step(const I& interaction) {
  if constexpr (requires { interaction.max_move_within_step(); }) {
    return interaction.max_move_within_step();
  } else {
    return 0;
  }
}
}  // namespace detail

/// P, a Particles, as a part of the particles of all processes. Made by distribute().
template <class P>
class SharedParticles : public P {
 public:
  using typename P::Real;
  using typename P::Vec;
  using P::dimension;

  /// `own` are those of this process; no other has one of the same ids.
  SharedParticles(P own, const World& world)
      : P(std::move(own)),
        world_(&world),
        agree_(world),
        migration_(world, agree_),
        rows_(world, agree_) {}

  const World& world() const noexcept { return *world_; }

  /// Particles get their ids before they are distributed.
  Index add(const Vec&) = delete;

  /// Removes the own particles i for which removed(i) is true, and returns their number.
  template <std::predicate<Index> Removed>
  Index remove_if(Removed&& removed) {
    std::vector<std::uint8_t> is_removed(P::size());
    for (Index i = 0; i < P::size(); ++i) is_removed[i] = removed(i);
    const bool knows_positions = found_.positions.size() == P::size();
    const Index count = P::remove_if([&](Index i) { return is_removed[i]; });
    if (count == 0 || !knows_positions) return count;
    Index kept = 0;
    for (Index i = 0; i < is_removed.size(); ++i) {
      if (!is_removed[i]) found_.positions[kept++] = found_.positions[i];
    }
    found_.positions.resize(kept);
    return count;
  }
  /// Removes one by id, in the process that owns it. Throws elsewhere.
  void remove(Id id) {
    const Index index = P::index_of(id);
    if (index == no_index) P::remove(id);  // throws
    if (index >= P::size()) {
      fail("mpi: the particle " + std::to_string(id) +
           " belongs to another process; remove it there");
    }
    remove_if([index](Index i) { return i == index; });
  }
  /// Moves particle order[i] to place i, as Particles::reorder() does; the rows of the halo stay.
  void reorder(std::span<const Index> order) {
    const bool is_found = found_.positions.size() == P::size();
    const bool is_current = !is_halo_outdated();
    const double moved_before = is_found ? moved() : 0;
    P::reorder(order);
    if (!is_found) return;
    std::vector<Vec> positions(order.size());
    for (Index i = 0; i < order.size(); ++i) positions[i] = found_.positions[order[i]];
    found_.positions = std::move(positions);
    if (!is_current) return;
    rows_.reorder(order);
    note_rows();
    found_.travel.distance -= moved_before;
  }

  // Begins a step, see Particles.
  void save() noexcept {
    P::save();
    found_.constants = P::constants_revision();
  }

  // See Shared in core/shared_particles.hpp.

  template <class F>
  Largest together(F&& f, Doing doing = Doing::step) const {
    const auto own_numbers = [&] {
      const Largest own = f();
      Reduced numbers;
      numbers.largest = {own.reach,
                         own.displacement,
                         own.minus_time_step,
                         own.energy_gain,
                         own.wanted,
                         own.time_step,
                         is_halo_outdated() ? 1.0 : 0.0,
                         P::has_state_changed() ? 1.0 : 0.0,
                         do_rows_match() ? 0.0 : 1.0};
      return numbers;
    };
    const auto all = agree_(own_numbers, doing).largest;
    must_find_halo_ = all[6] > 0;
    must_refresh_ = all[7] > 0;
    do_all_rows_match_ = !(all[8] > 0);
    return {.reach = all[0],
            .displacement = all[1],
            .minus_time_step = all[2],
            .time_step = all[5],
            .energy_gain = all[3],
            .wanted = all[4]};
  }
  template <std::size_t N>
  std::array<double, N> sum(const std::array<double, N>& own) const {
    return agree_.sum(own);
  }
  template <std::size_t N>
  std::array<double, N> largest(const std::array<double, N>& own) const {
    return agree_.largest(own);
  }
  void report_fault(std::exception_ptr fault) { agree_.report(std::move(fault)); }
  bool have_all_thrown(const std::exception_ptr& fault) const {
    return agree_.have_all_thrown(fault);
  }

  /// How far an own particle has moved since the halo was found, at least [m]; infinite if it does not
  /// fit the particles.
  double moved_since_halo() const {
    return is_halo_outdated() ? std::numeric_limits<double>::infinity() : moved();
  }
  template <class I>
  void update_halo(I& interaction, Real radius, double moved_by_all) {
    moved_ = moved_by_all;
    // Enough for the search, and for a skin of a twentieth of its radius.
    const double moves_in_step = detail::max_move_within_step(interaction);
    found_.least_depth = 1.05 * double(radius) + 2 * moves_in_step;
    if (must_find_halo_ || found_.strayed > 0 || !(depth_of_halo() >= found_.least_depth)) {
      find_halo(interaction, 1.5 * double(radius) + 2 * moves_in_step);
    } else if (must_refresh_) {
      refresh();
    }
  }
  void finish_step(double displacement, const Largest& all) {
    P::add_travel(std::max(0.0, all.displacement - displacement));
    if (!do_all_rows_match_) return find_halo_of_same_owners(moved_ + all.displacement);
    refresh();
  }
  void refresh_halo() {
    together([] { return Largest{}; });
    if (do_all_rows_match_) refresh();
  }
  void find_halo_of_changed() {
    const auto own = [&] { return Largest{.displacement = moved()}; };
    const double moved_by_all = together(own, Doing::state).displacement;
    const bool is_deep = found_.depth - 2 * moved_by_all >= found_.least_depth;
    if (must_find_halo_ || !is_deep) {
      find_halo_of_same_owners(moved_by_all);
    } else {
      refresh();
    }
  }
  template <class I>
  void gather(I& interaction) {
    migration_.count(*this);
    migration_.migrate(interaction, *this, [](const auto&) { return 0; });
    // In an order that every number of processes gives.
    std::vector<Index> order(P::size());
    std::iota(order.begin(), order.end(), Index(0));
    std::ranges::sort(order, {}, [&](Index i) { return P::id(i); });
    P::reorder(order);
  }
  template <class I>
  void keep_own(I& interaction) {
    migration_.keep_own(interaction, *this);
  }
  template <class T, class Get, class Set>
  void exchange(const Get& get, const Set& set) const {
    rows_.template exchange<T>(get, set, [this] { require_matching_rows(); });
  }
  template <class T, class Get, class Set>
  void exchange_back(const Get& get, const Set& set) const {
    rows_.template exchange_back<T>(get, set, [this] { require_matching_rows(); });
  }
  using ElementExchange = HaloRows::ElementExchange;
  template <class PlaceOf>
  ElementExchange exchange_of(const PlaceOf& place_of) const {
    return rows_.elements(place_of);
  }
  /// Copies these fields to the halo, from the processes that own its particles, and to the ghosts.
  /// To be called by all processes.
  template <Field... F>
  void refresh_ghosts(F... fields) {
    (exchange_field(fields), ...);
    P::copy_to_ghosts(fields...);
  }
  /// Divides space anew in the next step, as is done when the work is unevenly divided. To be called by
  /// all processes.
  void repartition() { migration_.repartition(); }
  /// How often the halo was found.
  std::uint64_t halos_found() const noexcept { return halos_found_; }
  Process process() const noexcept { return {world_->rank(), world_->size()}; }
  double depth_of_halo() const noexcept { return found_.depth - 2 * moved_; }

 private:
  // How far an own particle has moved since the halo was found, at least [m].
  double moved() const {
    const Travel now = P::travel();
    if (now.epoch == found_.travel.epoch) return now.distance - found_.travel.distance;
    const auto x = std::as_const(*this)[position];
    const NearestImage<dimension, Real> image(P::box());
    return std::sqrt(silt::largest(x.size(), 0.0, [&](Index i) {
      return double(image(Vec(x[i] - found_.positions[i])).squaredNorm());
    }));
  }

  // Whether the rows are those of the particles, of which none was removed since the halo was found.
  bool do_rows_match() const { return found_.revision == P::owned_revision(); }
  void require_matching_rows() const {
    if (do_rows_match()) return;
    fail("mpi: particles were removed or reordered since the last step, and those of other processes "
         "are not known before the next one; measure before particles are changed");
  }
  // Also if the program may have changed a constant.
  bool is_halo_outdated() const {
    return migration_.must_repartition() || !do_rows_match() ||
           found_.constants != P::constants_revision();
  }

  template <class I>
  void find_halo(I& interaction, double depth) {
    found_.revision = 0;
    rows_.partners().clear();
    migration_.run(interaction, *this, halos_found_);
    receive_halo(depth);
    found_.depth = depth;
    found_.strayed = 0;
    note_halo();
  }
  // No particle migrates until the next step: those outside the space of their process are at most as
  // far from it as they have moved since they were there.
  void find_halo_of_same_owners(double moved_by_all) {
    rows_.partners().clear();
    migration_.count(*this);
    found_.strayed += moved_by_all;
    receive_halo(found_.depth + found_.strayed);
    note_halo();
  }
  // That is, where the particles are now, and with these constants.
  void note_halo() {
    moved_ = 0;
    const auto x = std::as_const(*this)[position];
    found_.positions.assign(x.begin(), x.end());
    ++halos_found_;
    note_rows();
    P::note_state();
  }
  void note_rows() {
    found_.revision = P::owned_revision();
    found_.travel = P::travel();
    P::note_constants();
    found_.constants = P::constants_revision();
  }

  void receive_halo(double depth) {
    if (migration_.number() == 0) return P::clear_halo();
    auto near = rows_near_processes(std::as_const(*this), depth, migration_.cuts(), *world_);
    std::vector<Writer> writers(near.size());
    for (Index process = 0; process < near.size(); ++process) {
      detail::write_copies<P>(writers[process], *this, near[process]);
    }
    const auto messages = exchange_messages(*world_, agree_, writers);
    std::vector<Id> ids;
    for (const Transfer& message : messages) {
      detail::read_ids_of_copies<P>(message.from, *this, ids);
    }
    P::set_halo(ids);
    Index row = P::size();
    for (Index process = 0; process < near.size(); ++process) {
      if (near[process].empty()) continue;
      rows_.partners().push_back({int(process), std::move(near[process])});
    }
    for (const Transfer& message : messages) {
      HaloRows::Partner& partner = rows_.partner_with(message.process);
      partner.first_received = row;
      partner.received = detail::number_of_copies<P>(*this, message.from);
      detail::read_fields_of_copies<P>(message.from, *this, row);
      row += partner.received;
    }
    rows_.prepare_refresh(detail::bytes_of_state<P>(*this));
  }

  template <class F>
  void exchange_field(F field) {
    using T = value_of<F, dimension, Real>;
    const auto values = P::halo_to_change(field);
    exchange<T>([&](Index i) -> T { return values[i]; },
                [&](Index row, const T& value) { values[row] = value; });
  }
  // The state of the halo. After an agreement; throws nothing but errors of MPI.
  void refresh() {
    const auto write = [this](std::byte* to, const std::vector<std::uint32_t>& rows) {
      detail::write_state<P>(to, *this, rows);
    };
    const auto read = [this](const Bytes& from, const HaloRows::Partner& partner) {
      detail::read_state<P>(from, *this, partner.first_received, partner.received);
    };
    rows_.refresh(write, read);
    P::note_state();
  }

  const World* world_;
  Agreement agree_;
  Migration<dimension> migration_;
  HaloRows rows_;
  struct Found {
    double depth = 0;        // of the halo [m]
    double least_depth = 0;  // until it is found anew [m]
    double strayed = 0;      // by particles, since they migrated and until it was found [m]
    std::vector<Vec> positions;
    std::uint64_t revision = 0;  // of the owned particles; 0: there is no halo
    Travel travel;
    std::uint64_t constants = 0;
  };
  Found found_;       // when the halo was found
  double moved_ = 0;  // by a particle since then [m]
  std::uint64_t halos_found_ = 0;
  // Found by the last reduction.
  mutable bool must_find_halo_ = true;
  mutable bool must_refresh_ = false;
  mutable bool do_all_rows_match_ = false;
};

}  // namespace silt::mpi
