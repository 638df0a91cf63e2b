// SPDX-License-Identifier: MIT
// What a simulation asks of particles that several processes share.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <exception>
#include <span>
#include <string_view>

namespace silt {

/// Particles of which every process owns some, and has those of others within the interaction range
/// of its own in its halo. Model: mpi::SharedParticles. Functions that are not const are called by
/// all processes in the same order.
///
///   p.together(f)               calls f(), which returns a Largest, and returns the Largest of all.
///                               Throws in all processes if f() does in one, also in calls of
///                               together() within f(). May be called for a copy
///   p.sum(values)               the sums of an array of up to 12 numbers of all processes;
///                               likewise p.largest(values), of each the largest
///   p.report_fault(exception)   makes the next together() throw
///   p.have_all_thrown(exception)  whether all processes have thrown with it, in together() or the
///                               like
///   p.moved_since_halo()        how far an own particle has moved since the halo was found [m]
///   p.update_halo(i, radius, m) with the largest m of these of all processes, gives particles to the
///                               processes that own the space in which they are, with what the
///                               interaction i remembers of them, and finds the halo for a search
///                               with this radius [m], if necessary
///   p.finish_step(d, all)       refreshes the halo after a step; d is the largest displacement of
///                               the own particles, all.displacement that of all [m]
///   p.refresh_halo()            refreshes it within a step
///   p.find_halo_of_changed()    between steps: finds it anew if particles were removed, or constants
///                               changed; no particle moves to another process
///   p.exchange<T>(get, set)     calls set(row, value) for all rows of the halo with the values
///                               get(i) of a type T that the particles have where they are owned
///   p.exchange_back<T>(get, set)  calls set(i, value) with the values get(row) in all halos that
///                               have the owned particle i
///   p.gather(i)                 moves all particles, and what the interaction i remembers of them, to
///                               the first process
///   p.keep_own(i)               if every process has all particles, leaves to each its own
///   p.depth_of_halo()           it has all particles closer than this to one that is owned [m]
///   p.exchange_of(place_of)     an exchange(x), a P::ElementExchange, that gives elements of vectors
///                               to the halo: place_of(row) is the element of a row, or no_index
///   p.process()                 which process this is
///   p.world()                   all of them, for libraries that need to know
template <class P>
concept Shared = requires(P p, const P q, Largest (*f)(), std::exception_ptr fault) {
  { q.together(f) } -> std::same_as<Largest>;
  { q.sum(std::array<double, 4>{}) } -> std::same_as<std::array<double, 4>>;
  { q.largest(std::array<double, 4>{}) } -> std::same_as<std::array<double, 4>>;
  p.report_fault(fault);
  p.finish_step(double{}, Largest{});
  p.refresh_halo();
  p.find_halo_of_changed();
  { q.have_all_thrown(fault) } -> std::same_as<bool>;
  { q.moved_since_halo() } -> std::same_as<double>;
  { q.depth_of_halo() } -> std::convertible_to<double>;
  { q.process() } -> std::same_as<Process>;
  q.world();
};

namespace detail {

/// Replaces any number of values by those of reduce(array), which takes up to 12.
template <class Reduce>
void reduce_by_parts(std::span<double> values, const Reduce& reduce) {
  constexpr std::size_t size = 12;
  for (std::size_t first = 0; first < values.size(); first += size) {
    const auto some = values.subspan(first, std::min(size, values.size() - first));
    std::array<double, size> own{};
    std::ranges::copy(some, own.begin());
    const auto result = reduce(own);
    std::copy_n(result.begin(), some.size(), some.begin());
  }
}

template <Shared P>
struct Processes<P> {
  static constexpr bool are_several = true;

  template <class F>
  static Largest together(const P& particles, F&& f) {
    return particles.together(f);
  }
  template <class F>
  static void call_alone(P& particles, F&& f) {
    try {
      f();
    } catch (...) {
      if (particles.have_all_thrown(std::current_exception())) throw;
      particles.report_fault(std::current_exception());
    }
  }
  template <std::size_t N>
  static std::array<double, N> largest(const P& particles, const std::array<double, N>& own) {
    return particles.largest(own);
  }
  template <std::size_t N>
  static std::array<double, N> sum(const P& particles, const std::array<double, N>& own) {
    return particles.sum(own);
  }
  static void replace_by_sums(const P& particles, std::span<double> values) {
    reduce_by_parts(values, [&](const auto& own) { return particles.sum(own); });
  }
  static void replace_by_largest(const P& particles, std::span<double> values) {
    reduce_by_parts(values, [&](const auto& own) { return particles.largest(own); });
  }
  template <std::size_t N>
  static void require_same(const P& particles, std::string_view what,
                           const std::array<double, N>& own) {
    std::array<double, 2 * N> both;
    for (std::size_t k = 0; k < N; ++k) {
      both[2 * k] = own[k];
      both[2 * k + 1] = -own[k];
    }
    both = particles.largest(both);
    for (std::size_t k = 0; k < N; ++k) {
      const double least = -both[2 * k + 1], most = both[2 * k];
      if (least == most) continue;
      fail({what, " is ", least, " in one process and ", most, " in another; give all the same"});
    }
  }
  template <class Values>
  static void share(const P& particles, Values& values) {
    using T = typename Values::value_type;
    particles.template exchange<T>([&](Index i) -> const T& { return values[i]; },
                                   [&](Index row, const T& value) { values[row] = value; });
  }
  template <class Values>
  static void add_to_owners(const P& particles, Values& values) {
    using T = typename Values::value_type;
    particles.template exchange_back<T>([&](Index row) -> const T& { return values[row]; },
                                        [&](Index i, const T& value) { values[i] += value; });
  }

  static Process this_one(const P& particles) { return particles.process(); }
  static double depth_of_halo(const P& particles) { return particles.depth_of_halo(); }
  static double moved_since_halo(const P& particles) { return particles.moved_since_halo(); }
  template <class I>
  static void update_halo(P& particles, I& interaction, double radius, const Largest& all) {
    particles.update_halo(interaction, static_cast<typename P::Real>(radius), all.displacement);
  }
  static void refresh_halo(P& particles) { particles.refresh_halo(); }
  static void find_halo_of_changed(P& particles) { particles.find_halo_of_changed(); }
  static void finish_step(P& particles, double displacement, const Largest& all) {
    particles.finish_step(displacement, all);
  }
  template <class I>
  static void gather(P& particles, I& interaction) {
    particles.gather(interaction);
  }
  template <class I>
  static void keep_own(P& particles, I& interaction) {
    particles.keep_own(interaction);
  }
};

}  // namespace detail

}  // namespace silt
