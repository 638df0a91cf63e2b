// SPDX-License-Identifier: MIT
// What a simulation asks of particles that several processes share. For particles of one process,
// nothing of it costs anything.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <exception>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

/// What processes decide together: each gives its own values, and gets the largest of all.
struct Largest {
  double reach = 0;                ///< interaction range [m]
  double displacement = 0;         ///< in the step [m]
  /// The negative of the time step that is chosen, or given [s].
  double minus_time_step = -std::numeric_limits<double>::infinity();
  double time_step = -std::numeric_limits<double>::infinity();  ///< that is given [s]
  double energy_gain = 0;  ///< FinishedStep::max_energy_gain, in core/watch.hpp [-]
  double wanted = 0;       ///< [-] 1 if a process wants what is asked, such as the end of a run
};

/// One of several processes.
struct Process {
  int rank = 0;  ///< from 0 on
  int count = 1;  ///< number of processes
};

/// Particles of which every process owns some, and has those of others within the interaction range
/// of its own in its halo. Model: mpi::SharedParticles. Functions that are not const are called by
/// all processes in the same order.
///
///   p.together(f)               calls f(), which returns a Largest, and returns the Largest of
///   all.
///                               Throws in all processes if f() does in one, also in calls of
///                               together() within f(). May be called for a copy
///   p.sum(values)               the sums of an array of up to 12 numbers of all processes,
///   likewise p.largest(values)           of each the largest p.report_fault(exception)   makes the
///   next together() throw p.have_all_thrown(exception) whether all processes have thrown with it,
///   in together() or the like p.moved_since_halo()        how far an own particle has moved since
///   the halo was found [m] p.update_halo(i, radius, m) with the largest m of these of all
///   processes, gives particles to
///                               the processes that own the space in which they are, with what the
///                               interaction i remembers of them, and finds the halo for a search
///                               with this radius [m], if necessary
///   p.finish_step(d, all)       refreshes the halo after a step; d is the largest displacement of
///   the
///                               own particles, all.displacement that of all [m]
///   p.refresh_halo()            refreshes it within a step
///   p.find_halo_of_changed()    between steps: finds it anew if particles were removed, or
///   constants
///                               changed; no particle moves to another process
///   p.exchange<T>(get, set)     calls set(row, value) for all rows of the halo with the values
///   get(i)
///                               of a type T that the particles have where they are owned
///   p.exchange_back<T>(get, set)  calls set(i, value) with the values get(row) in all halos that
///   have
///                               the owned particle i
///   p.gather(i)                 moves all particles, and what the interaction i remembers of them,
///   to
///                               the first process
///   p.keep_own(i)               if every process has all particles, leaves to each its own
///   p.depth_of_halo()           it has all particles closer than this to one that is owned [m]
///   p.exchange_of(place_of)     an exchange(x), a P::ElementExchange, that gives elements of
///   vectors to
///                               the halo: place_of(row) is the element of a row, or no_index
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

template <class P, class F>
Largest together([[maybe_unused]] const P& particles, F&& f) {
  if constexpr (Shared<P>) {
    return particles.together(f);
  } else {
    return f();
  }
}
/// Calls f(). If it throws in some processes only, outside of together() and the like, all throw in
/// their next together().
template <class P, class F>
void call_alone(P& particles, F&& f) {
  if constexpr (Shared<P>) {
    try {
      f();
    } catch (...) {
      if (particles.have_all_thrown(std::current_exception())) throw;
      particles.report_fault(std::current_exception());
    }
  } else {
    f();
  }
}
/// Of each number the largest of all processes.
template <class P, std::size_t N>
std::array<double, N> largest_of_all([[maybe_unused]] const P& particles,
                                     const std::array<double, N>& own) {
  if constexpr (Shared<P>) {
    return particles.largest(own);
  } else {
    return own;
  }
}
template <class P>
bool any_of_all(const P& particles, bool own) {
  return largest_of_all(particles, std::array{own ? 1.0 : 0.0})[0] > 0;
}
/// Gives the values of owned particles, of an array with elements for the halo as well, to the halo.
template <class P, class T>
void share([[maybe_unused]] const P& particles, [[maybe_unused]] std::vector<T>& values) {
  if constexpr (Shared<P>) {
    particles.template exchange<T>([&](Index i) -> const T& { return values[i]; },
                                   [&](Index row, const T& value) { values[row] = value; });
  }
}
/// Adds the values of the halo, of such an array, to those of the owned particles.
template <class P, class T>
void add_to_owners([[maybe_unused]] const P& particles, [[maybe_unused]] std::vector<T>& values) {
  if constexpr (Shared<P>) {
    particles.template exchange_back<T>([&](Index row) -> const T& { return values[row]; },
                                        [&](Index i, const T& value) { values[i] += value; });
  }
}
/// The sums of these numbers of all processes.
template <class P, std::size_t N>
std::array<double, N> sum_of_all([[maybe_unused]] const P& particles,
                                 const std::array<double, N>& own) {
  if constexpr (Shared<P>) {
    return particles.sum(own);
  } else {
    return own;
  }
}
template <class P>
double sum_of_all(const P& particles, double own) {
  return sum_of_all(particles, std::array{own})[0];
}
template <class P, int N>
Vec<N> sum_of_all(const P& particles, const Vec<N>& own) {
  std::array<double, std::size_t(N)> numbers;
  std::copy_n(own.data(), N, numbers.begin());
  numbers = sum_of_all(particles, numbers);
  return Vec<N>(numbers.data());
}
/// Replaces these numbers, of which there are as many in every process, by the sums of all processes.
template <class P>
void replace_by_sums([[maybe_unused]] const P& particles,
                     [[maybe_unused]] std::span<double> values) {
  if constexpr (Shared<P>) {
    reduce_by_parts(values, [&](const auto& own) { return particles.sum(own); });
  }
}
/// The same by the largest of each.
template <class P>
void replace_by_largest([[maybe_unused]] const P& particles,
                        [[maybe_unused]] std::span<double> values) {
  if constexpr (Shared<P>) {
    reduce_by_parts(values, [&](const auto& own) { return particles.largest(own); });
  }
}
/// Throws in all processes if they do not give the same numbers, at most six; `what` names them.
template <class P, std::size_t N>
void require_same_in_all([[maybe_unused]] const P& particles, [[maybe_unused]] std::string_view what,
                         [[maybe_unused]] const std::array<double, N>& own) {
  if constexpr (Shared<P>) {
    std::array<double, 2 * N> both;
    for (std::size_t k = 0; k < N; ++k) {
      both[2 * k] = own[k];
      both[2 * k + 1] = -own[k];
    }
    both = particles.largest(both);
    for (std::size_t k = 0; k < N; ++k) {
      const double least = -both[2 * k + 1], most = both[2 * k];
      if (least == most) continue;
      fail(std::string(what) + " is " + to_text(least) + " in one process and " + to_text(most) +
           " in another; give all the same");
    }
  }
}
template <class P>
void refresh_halo(P& particles) {
  if constexpr (Shared<P>) particles.refresh_halo();
}

}  // namespace detail

/// Which process this is, of those that share the particles.
template <class P>
Process process_of([[maybe_unused]] const P& particles) {
  if constexpr (Shared<P>) {
    return particles.process();
  } else {
    return {};
  }
}

/// The halo has all particles closer than this to one that is owned [m].
template <class P>
auto depth_of_halo(const P& particles) {
  using Real = typename P::Real;
  if constexpr (Shared<P>) {
    return Real(particles.depth_of_halo());
  } else {
    return std::numeric_limits<Real>::infinity();
  }
}

}  // namespace silt
