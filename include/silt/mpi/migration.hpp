// SPDX-License-Identifier: MIT
// Which process owns a particle: the one that owns the space where it is. Particles that have left
// it migrate, with what the interaction remembers of them; now and then space is cut anew.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/cuts.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/pair_memory.hpp>
#include <silt/mpi/particle_messages.hpp>
#include <silt/mpi/work.hpp>
#include <silt/mpi/world.hpp>

#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace silt::mpi {

/// Moves particles to the processes that own them. What communicates, count() and the functions
/// after repartition(), is to be called by all processes.
template <int Dim>
class Migration {
 public:
  /// Space is not cut yet.
  Migration(const World& world, const Agreement& agree)
      : world_(&world), agree_(agree), cuts_(world) {}

  /// The parts of space.
  Cuts<Dim>& cuts() noexcept { return cuts_; }
  /// Number of particles of all processes, when they were counted.
  std::uint64_t number() const noexcept { return number_; }
  /// Counts them.
  template <class P>
  void count(const P& particles) {
    number_ = counted(particles);
  }
  /// Space is divided anew by the next run().
  void repartition() noexcept { must_repartition_ = true; }
  /// Whether it has not been divided since.
  bool must_repartition() const noexcept { return must_repartition_; }

  /// Counts the particles and moves those that have left the space of their process. Space is cut
  /// anew if the work is unevenly divided, but at most at every eighth halo that is found: some
  /// particles cannot be divided evenly.
  template <class I, class P>
  void run(I& interaction, P& particles, std::uint64_t halos_found) {
    count(particles);
    if (number_ == 0) return;
    cut_if_uneven(interaction, particles, halos_found);
    migrate(interaction, particles, [this](const auto& x) { return cuts_.owner_of(x); });
  }

  /// Moves particles, and what the interaction remembers of them, to the processes
  /// owner_of(position). Throws if there are not number() particles after it.
  template <class I, class P, class OwnerOf>
  void migrate(I& interaction, P& particles, const OwnerOf& owner_of) {
    const auto exchange = [this](std::vector<Writer>& writers) {
      return exchange_messages(*world_, agree_, writers);
    };
    const int rank = world_->rank();
    std::vector<int> owners(particles.local());
    for (Index i = 0; i < owners.size(); ++i) owners[i] = owner_of(point(particles, i));
    change_memory(interaction, particles, [&](const auto& history) {
      return migrated(history, particles, owners, *world_, exchange);
    });
    std::vector<Writer> writers(Index(world_->size()));
    for (Index i = 0; i < particles.size(); ++i) {
      if (owners[i] == rank) continue;
      detail::write_particle<P>(writers[Index(owners[i])], particles, i);
    }
    particles.clear_halo();
    particles.remove_if([&](Index i) { return owners[i] != rank; });
    for (const Transfer& message : exchange(writers)) {
      Reader read(message.from);
      while (!read.is_at_end()) detail::read_particle<P>(read, particles);
    }
    const auto now = counted(particles);
    if (now != number_) {
      fail("mpi: there are " + std::to_string(now) + " particles instead of " +
           std::to_string(number_) + " after some moved to other processes; please report it");
    }
  }

  /// Of particles that are the same in all processes, keeps those that this one owns.
  template <class I, class P>
  void keep_own(I& interaction, P& particles) {
    number_ = particles.size();
    std::vector<Vec<Dim>> points;
    agree_([&] {
      for (Index i = 0; i < particles.size(); ++i) {
        const bool is_given = particles.id(i) % Index(world_->size()) == Index(world_->rank());
        if (is_given) points.push_back(point(particles, i));
      }
      return Reduced();
    });
    if (number_ > 0) cuts_.make(points, std::vector<double>(points.size(), 1.0));
    std::vector<std::uint8_t> is_own(particles.size());
    for (Index i = 0; i < particles.size(); ++i) {
      is_own[i] = cuts_.owner_of(point(particles, i)) == world_->rank();
    }
    const auto is_of_own = [&](Id id) {
      const Index i = particles.index_of(id);
      return i != no_index && is_own[i];
    };
    change_memory(interaction, particles, [&](auto history) {
      history.keep_if([&](Id a, Id b) { return is_of_own(a) || is_of_own(b); });
      return history;
    });
    particles.remove_if([&](Index i) { return !is_own[i]; });
  }

 private:
  // Position of a particle, also of the halo [m].
  template <class P>
  static Vec<Dim> point(const P& particles, Index i) {
    return particles.with_halo(position)[i].template cast<double>();
  }
  template <class P>
  std::uint64_t counted(const P& particles) const {
    return std::uint64_t(agree_.sum(std::array{double(particles.size())})[0]);
  }

  template <class I, class P>
  void cut_if_uneven(const I& interaction, const P& particles, std::uint64_t halos_found) {
    constexpr std::uint64_t halos_between_cuts = 8;
    std::vector<double> work;
    const Reduced all = agree_([&] {
      work.assign(particles.size(), 1.0);
      const bool is_known = add_work(interaction, particles, work);
      Reduced own;
      own.sum[0] = own.largest[0] = std::accumulate(work.begin(), work.end(), 0.0);
      own.largest[1] = is_known ? 0 : 1;
      return own;
    });
    const bool is_known = !(all.largest[1] > 0);
    const bool is_even = all.largest[0] <= 1.1 * all.sum[0] / world_->size();
    const bool is_soon = halos_found < last_cut_ + halos_between_cuts;
    const bool is_asked = std::exchange(must_repartition_, false);
    if (!is_asked && cuts_.are_made() && (!is_known || is_even || is_soon)) return;
    std::vector<Vec<Dim>> points;
    agree_([&] {
      if (!is_known) work.assign(particles.size(), 1.0);
      for (Index i = 0; i < particles.size(); ++i) points.push_back(point(particles, i));
      return Reduced();
    });
    cuts_.make(points, work);
    last_cut_ = halos_found;
  }

  const World* world_;
  Agreement agree_;
  Cuts<Dim> cuts_;
  std::uint64_t number_ = 0;
  std::uint64_t last_cut_ = 0;  // halos found until then
  bool must_repartition_ = false;
};

}  // namespace silt::mpi
