// SPDX-License-Identifier: MIT
// What interactions remember of pairs of particles, when these move to other processes.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/messages.hpp>
#include <silt/mpi/world.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace silt::mpi {

/// Replaces what an interaction remembers of pairs by change(history), see PairHistory. An interaction
/// with remembers_particles = false has a state, but none of particles.
template <class I, class P, class F>
void change_memory(I& interaction, const P& particles, const F& change) {
  if constexpr (requires { interaction.for_each_part([](auto&) {}); }) {
    interaction.for_each_part([&](auto& part) { change_memory(part, particles, change); });
  } else if constexpr (requires {
                         interaction.set_history(particles, interaction.history(particles));
                       }) {
    interaction.set_history(particles, change(interaction.history(particles)));
  } else {
    static_assert(!Transactional<I> || requires { requires !I::remembers_particles; },
                  "silt::mpi: this interaction has state that does not migrate between "
                  "processes yet (contacts do)");
  }
}

/// The history of this process after particles have moved to the processes owners[i], which are known
/// for those of the halo, too. Sent to the new owners of both particles of a pair: by the process that
/// owns the one with the lower id, and, if that does not know the other yet, by the process that owns
/// the other. exchange(writers) sends what was written for each process.
template <class History, class P, class Exchange>
History migrated(const History& history, const P& particles, const std::vector<int>& owners,
                 const World& world, const Exchange& exchange) {
  std::vector<typename History::Entry> kept;
  std::vector<Writer> writers(Index(world.size()));
  history.for_each_pair([&](Id a, Id b, const auto& value) {
    const typename History::Entry entry{a, b, value};
    const Index first = particles.index_of(a), second = particles.index_of(b);
    const bool owns_first = first < particles.size(), owns_second = second < particles.size();
    const auto send = [&](int process) {
      if (process == world.rank()) {
        kept.push_back(entry);
      } else {
        writers[Index(process)](entry);
      }
    };
    if (owns_first) send(owners[first]);
    if (owns_second || (owns_first && second != no_index)) send(owners[second]);
  });
  for (const Transfer& message : exchange(writers)) {
    Reader read(message.from);
    while (!read.is_at_end()) read(kept.emplace_back());
  }
  const auto ids = [](const auto& entry) { return std::pair(entry.owner, entry.partner); };
  std::ranges::sort(kept, {}, ids);
  const auto are_same = [&](const auto& a, const auto& b) { return ids(a) == ids(b); };
  kept.erase(std::unique(kept.begin(), kept.end(), are_same), kept.end());
  return History(std::move(kept));
}

}  // namespace silt::mpi
