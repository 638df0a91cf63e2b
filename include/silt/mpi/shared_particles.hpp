// SPDX-License-Identifier: MIT
// Particles of which every process owns those in its part of space. The halo has those of other
// processes within a depth of its own:
//
//   decide     all reduce what must be known together      agreement.hpp
//   migrate    particles that have left its part of space, with what the interaction remembers of
//              them, move to the process that owns where they are; now and then space is cut anew
//   find halo  every process tells others of its particles near theirs
//   refresh    the values of the halo after every step
//
// The halo is deeper than the search radius, so that it is found anew only after particles have
// moved by a part of the radius.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/shared_particles.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/cuts.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::mpi {

/// P, a Particles, as a part of the particles of all processes. Made by distribute().
template <class P>
class SharedParticles : public P {
 public:
  using typename P::Real;
  using typename P::Vec;
  using P::dimension;

  /// `own` are those of this process; no other has one of the same ids.
  SharedParticles(P own, const World& world)
      : P(std::move(own)), world_(&world), agreement_(world), cuts_(world) {}

  const World& world() const noexcept { return *world_; }

  /// Particles get their ids before they are distributed.
  Index add(const Vec&) = delete;

  void reorder(std::span<const Index> order) {
    std::vector<std::uint32_t> now(order.size());
    const bool is_planned = !needs_plan();
    P::reorder(order);
    if (!is_planned) return;
    for (Index i = 0; i < order.size(); ++i) now[order[i]] = std::uint32_t(i);
    for (Partner& each : partners_) {
      for (std::uint32_t& i : each.sent) i = now[i];
    }
    note_plan();
  }

  // Begins a step, see Particles.
  void save() noexcept {
    P::save();
    planned_constants_ = P::constants_revision();
  }

  // See Shared in core/shared_particles.hpp.

  template <class F>
  Largest together(F&& f) {
    const auto all = agreement_([&]() -> std::array<double, 6> {
      const Largest own = f();
      return {own.reach,    own.displacement,          own.minus_time_step,
              own.ends_run, needs_plan() ? 1.0 : 0.0, P::has_state_changed() ? 1.0 : 0.0};
    });
    must_plan_ = all[4] > 0;
    must_refresh_ = all[5] > 0;
    return {.reach = all[0], .displacement = all[1], .minus_time_step = all[2], .ends_run = all[3]};
  }
  void report_fault(std::exception_ptr fault) { agreement_.report(std::move(fault)); }

  template <class I>
  void share(I& interaction, Real radius) {
    // Enough for the search, and for a skin of a twentieth of its radius.
    if (must_plan_ || !(depth_of_halo() >= 1.05 * double(radius))) {
      plan(interaction, double(radius));
    } else if (must_refresh_) {
      refresh();
    }
  }
  void finish_step(double displacement, const Largest& all) {
    travel_ += all.displacement;
    if (must_plan_) return;  // particles were removed
    P::add_travel(std::max(0.0, all.displacement - displacement));
    refresh();
  }
  void refresh_halo() {
    together([] { return Largest{}; });
    refresh();
  }
  /// Space is cut anew in the next step, as it is when particles are unevenly divided. To be called by
  /// all processes.
  void cut_anew() {
    cuts_anew_ = true;
    planned_revision_ = 0;
  }
  /// How often the halo was found.
  std::uint64_t plans() const noexcept { return plans_; }
  Process process() const noexcept { return {world_->rank(), world_->size()}; }
  double depth_of_halo() const noexcept { return planned_depth_ - 2 * travel_; }

 private:
  // A process with particles near some of ours: we send it rows, and receive others.
  struct Partner {
    int process;
    std::vector<std::uint32_t> sent;
    Index first_received = 0;  // row
    Index received = 0;
  };

  // Whether the plan does not fit the particles: some were added or removed, or the program has
  // moved one, or has changed a constant.
  bool needs_plan() const {
    return planned_revision_ != P::owned_revision() || planned_epoch_ != P::travel().epoch ||
           planned_constants_ != P::constants_revision();
  }

  template <class I>
  void plan(I& interaction, double radius) {
    planned_revision_ = 0;
    partners_.clear();
    number_ = world_->sum(std::uint64_t{P::size()});
    if (number_ > 0) migrate(interaction);
    find_halo(1.5 * radius);
    planned_depth_ = 1.5 * radius;
    travel_ = 0;
    ++plans_;
    note_plan();
    P::note_state();
  }
  void note_plan() {
    planned_revision_ = P::owned_revision();
    planned_epoch_ = P::travel().epoch;
    planned_constants_ = P::constants_revision();
  }

  template <class I>
  void migrate(I& interaction) {
    const auto x = std::as_const(*this)[position];
    std::vector<silt::Vec<dimension>> points(x.size());
    for (Index i = 0; i < x.size(); ++i) points[i] = x[i].template cast<double>();
    const auto most = world_->max(std::uint64_t{points.size()});
    const double mean = double(number_) / world_->size();
    if (std::exchange(cuts_anew_, false) || !cuts_.are_made() || double(most) > 1.1 * mean + 16) {
      cuts_.make(points);
    }

    std::vector<int> owners(points.size());
    for (Index i = 0; i < points.size(); ++i) owners[i] = cuts_.owner_of(points[i]);
    const auto owner_of_id = [&](Id id) {
      const Index i = P::index_of(id);
      return i < P::size()
                 ? owners[i]
                 : cuts_.owner_of(P::with_halo(position)[i].template cast<double>());
    };
    migrate_memory(interaction, owner_of_id);
    std::vector<Writer> writers(Index(world_->size()));
    for (Index i = 0; i < points.size(); ++i) {
      if (owners[i] == world_->rank()) continue;
      Writer& write = writers[Index(owners[i])];
      write(P::id(i));
      each_field([&](auto field) { write_value(write, field, i); });
    }
    P::clear_halo();
    P::remove_if([&](Index i) { return owners[i] != world_->rank(); });
    for (const Message& message : exchange_messages(*world_, messages_of(writers))) {
      Reader read(message.bytes);
      while (!read.is_at_end()) {
        Id id = 0;
        read(id);
        const Index i = P::adopt(id);
        each_field([&](auto field) { read_value(read, (*this)[field], i); });
      }
    }
    const auto now = world_->sum(std::uint64_t{P::size()});
    if (now != number_) {
      fail("mpi: there are " + std::to_string(now) + " particles instead of " +
           std::to_string(number_) + " after some moved to other processes; please report it");
    }
  }

  // Contacts remember pairs. Each is known where the grain with the lower id is owned, and is sent
  // to the new owners of both.
  template <class I, class OwnerOf>
  void migrate_memory(I& interaction, const OwnerOf& owner_of) {
    if constexpr (requires { interaction.for_each_part([](auto&) {}); }) {
      interaction.for_each_part([&](auto& part) { migrate_memory(part, owner_of); });
    } else if constexpr (requires { interaction.set_history(*this, interaction.history(*this)); }) {
      using History = std::remove_cvref_t<decltype(interaction.history(*this))>;
      std::vector<typename History::Entry> kept;
      std::vector<Writer> writers(Index(world_->size()));
      interaction.history(*this).for_each_pair([&](Id a, Id b, const auto& value) {
        const typename History::Entry entry{a, b, value};
        const int first = owner_of(a);
        // A partner that is no particle, such as a wall, is everywhere.
        const int second = P::index_of(b) == no_index ? first : owner_of(b);
        const auto send = [&](int process) {
          if (process == world_->rank()) {
            kept.push_back(entry);
          } else {
            writers[Index(process)](entry);
          }
        };
        send(first);
        if (second != first) send(second);
      });
      for (const Message& message : exchange_messages(*world_, messages_of(writers))) {
        Reader read(message.bytes);
        while (!read.is_at_end()) read(kept.emplace_back());
      }
      interaction.set_history(*this, History(std::move(kept)));
    } else {
      static_assert(!Transactional<I>,
                    "silt::mpi: this interaction has state that does not migrate between "
                    "processes yet (contacts do)");
    }
  }

  void find_halo(double depth) {
    if (number_ == 0) return P::clear_halo();
    const auto x = std::as_const(*this)[position];
    std::vector<std::vector<std::uint32_t>> near(Index(world_->size()));
    std::vector<int> processes;
    for (Index i = 0; i < x.size(); ++i) {
      processes.clear();
      add_processes_near(x[i].template cast<double>(), depth, processes);
      std::sort(processes.begin(), processes.end());
      processes.erase(std::unique(processes.begin(), processes.end()), processes.end());
      for (const int process : processes) {
        if (process != world_->rank()) near[Index(process)].push_back(std::uint32_t(i));
      }
    }
    std::vector<Writer> writers(near.size());
    for (Index process = 0; process < near.size(); ++process) {
      for (const std::uint32_t i : near[process]) writers[process](P::id(i));
      each_field([&](auto field) {
        for (const std::uint32_t i : near[process]) write_value(writers[process], field, i);
      });
    }
    const auto messages = exchange_messages(*world_, messages_of(writers));
    const Index bytes = bytes_of_particle();
    std::vector<Id> ids;
    for (const Message& message : messages) {
      Reader read(message.bytes);
      for (Index k = 0; k < message.bytes.size() / bytes; ++k) read(ids.emplace_back());
    }
    P::set_halo(ids);
    Index row = P::size();
    for (Index process = 0; process < near.size(); ++process) {
      if (!near[process].empty()) partners_.push_back({int(process), std::move(near[process])});
    }
    for (const Message& message : messages) {
      Partner& partner = partner_with(message.process);
      partner.first_received = row;
      partner.received = message.bytes.size() / bytes;
      row += partner.received;
      Reader read(std::span(message.bytes).subspan(partner.received * sizeof(Id)));
      each_field([&](auto field) { read_values(read, field, partner); });
    }
  }
  Partner& partner_with(int process) {
    for (Partner& each : partners_) {
      if (each.process == process) return each;
    }
    return partners_.emplace_back(Partner{process, {}});
  }
  // Also those that are near across a periodic side.
  void add_processes_near(const silt::Vec<dimension>& x, double depth,
                          std::vector<int>& processes) {
    const auto& box = P::box();
    std::array<std::array<double, 3>, 3> shifts{};
    std::array<int, 3> count{1, 1, 1};
    for (int k = 0; k < dimension; ++k) {
      if (!box.periodic[Index(k)]) continue;
      const double period = double(box.upper[k]) - double(box.lower[k]);
      auto& of_axis = shifts[Index(k)];
      int& n = count[Index(k)];
      if (x[k] - depth < double(box.lower[k])) of_axis[Index(n++)] = period;
      if (x[k] + depth > double(box.upper[k])) of_axis[Index(n++)] = -period;
    }
    for (int a = 0; a < count[0]; ++a) {
      for (int b = 0; b < count[1]; ++b) {
        for (int c = 0; c < count[2]; ++c) {
          silt::Vec<dimension> at = x;
          const std::array<int, 3> chosen{a, b, c};
          for (int k = 0; k < dimension; ++k) at[k] += shifts[Index(k)][Index(chosen[Index(k)])];
          cuts_.add_owners_of(at.array() - depth, at.array() + depth, processes);
        }
      }
    }
  }

  // The state of the halo.
  void refresh() {
    std::vector<Bytes> sent(partners_.size()), received(partners_.size());
    std::vector<MPI_Request> requests;
    const auto for_each_state = [this](auto&& f) {
      each_field([&]<class F>(F field) {
        if constexpr (role_of<F>() == Role::state) f(field);
      });
    };
    Index bytes = 0;
    for_each_state([&]<class F>(F) { bytes += sizeof(value_of<F, dimension, Real>); });
    constexpr int tag = 2;
    for (Index k = 0; k < partners_.size(); ++k) {
      const Partner& partner = partners_[k];
      received[k].resize(partner.received * bytes);
      if (received[k].empty()) continue;
      detail::check(MPI_Irecv(received[k].data(), detail::count_of(received[k].size()), MPI_BYTE,
                              partner.process, tag, world_->communicator(),
                              &requests.emplace_back()),
                    "MPI_Irecv");
    }
    for (Index k = 0; k < partners_.size(); ++k) {
      Writer write;
      for_each_state([&](auto field) {
        for (const std::uint32_t i : partners_[k].sent) write_value(write, field, i);
      });
      sent[k] = std::move(write.bytes());
      if (sent[k].empty()) continue;
      detail::check(MPI_Isend(sent[k].data(), detail::count_of(sent[k].size()), MPI_BYTE,
                              partners_[k].process, tag, world_->communicator(),
                              &requests.emplace_back()),
                    "MPI_Isend");
    }
    detail::check(MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE),
                  "MPI_Waitall");
    for (Index k = 0; k < partners_.size(); ++k) {
      Reader read(received[k]);
      for_each_state([&](auto field) { read_values(read, field, partners_[k]); });
    }
    P::note_state();
  }

  template <class F>
  void each_field(F&& f) const {
    P::for_each_field([&](auto, auto field) { f(field); });
  }
  Index bytes_of_particle() const {
    Index bytes = sizeof(Id);
    each_field([&]<class F>(F) { bytes += sizeof(value_of<F, dimension, Real>); });
    return bytes;
  }
  template <class F>
  void write_value(Writer& write, F field, Index i) const {
    const value_of<F, dimension, Real> value = P::with_halo(field)[i];
    write(value);
  }
  template <class Values>
  static void read_value(Reader& read, const Values& values, Index i) {
    typename Values::value_type value;
    read(value);
    values[i] = value;
  }
  template <class F>
  void read_values(Reader& read, F field, const Partner& partner) {
    const auto values = P::halo_to_change(field);
    for (Index k = 0; k < partner.received; ++k) {
      read_value(read, values, partner.first_received + k);
    }
  }
  static std::vector<Message> messages_of(std::vector<Writer>& writers) {
    std::vector<Message> messages;
    for (Index process = 0; process < writers.size(); ++process) {
      if (writers[process].bytes().empty()) continue;
      messages.push_back({int(process), std::move(writers[process].bytes())});
    }
    return messages;
  }

  const World* world_;
  Agreement<6> agreement_;
  Cuts<dimension> cuts_;
  std::uint64_t number_ = 0;  // of particles of all processes
  std::vector<Partner> partners_;
  double planned_depth_ = 0;  // [m]
  double travel_ = 0;         // of all particles since the plan was made [m]
  std::uint64_t planned_revision_ = 0;
  std::uint64_t planned_epoch_ = 0;
  std::uint64_t planned_constants_ = 0;
  std::uint64_t plans_ = 0;
  bool cuts_anew_ = false;
  bool must_plan_ = true;
  bool must_refresh_ = false;
};

/// The share of this process of particles that all processes have made alike, for up to some 10⁷.
template <class P>
SharedParticles<P> distribute(P particles, const World& world) {
  // Until space is cut, in turn.
  const auto rank = Index(world.rank());
  const auto size = Index(world.size());
  particles.remove_if([&](Index i) { return particles.id(i) % size != rank; });
  return SharedParticles<P>(std::move(particles), world);
}

}  // namespace silt::mpi
