// SPDX-License-Identifier: MIT
// What a simulation asks of particles that several processes share. For particles of one process,
// nothing of it costs anything.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <exception>
#include <limits>
#include <type_traits>
#include <utility>

namespace silt {

/// What processes decide together: each gives its own values, and gets the largest of all.
struct Largest {
  double reach = 0;                ///< interaction range [m]
  double displacement = 0;         ///< in the step [m]
  /// The negative of the time step that is chosen [s].
  double minus_time_step = -std::numeric_limits<double>::infinity();
  double wanted = 0;  ///< 1 if a process wants what is asked, such as the end of a run
};

/// One of several processes.
struct Process {
  int rank = 0;  ///< from 0 on
  int count = 1;
};

/// Particles of which every process owns some, and has those of others within the interaction range
/// of its own in its halo. Model: mpi::SharedParticles. Functions that are not const are called by
/// all processes in the same order.
///   p.together(f)               calls f(), which returns a Largest, and returns the Largest of all.
///                               Throws in all processes if f() does in one, also in calls of
///                               together() within f(). May be called for a copy
///   p.report_fault(exception)   makes the next together() throw
///   p.share(i, radius)          gives particles to the processes that own the space in which they
///                               are, with what the interaction i remembers of them, and finds the
///                               halo for a search with this radius [m], if necessary
///   p.finish_step(d, all)       refreshes the halo after a step; d is the largest displacement of the
///                               own particles, all.displacement that of all [m]
///   p.refresh_halo()            refreshes it within a step
///   p.gather(i)                 moves all particles, and what the interaction i remembers of them, to
///                               the first process
///   p.keep_own(i)               if every process has all particles, leaves to each its own
///   p.depth_of_halo()           it has all particles closer than this to one that is owned [m]
///   p.process()                 which process this is
template <class P>
concept Shared = requires(P p, const P q, Largest (*f)(), std::exception_ptr fault) {
  { q.together(f) } -> std::same_as<Largest>;
  p.report_fault(fault);
  p.finish_step(double{}, Largest{});
  p.refresh_halo();
  { q.depth_of_halo() } -> std::convertible_to<double>;
  { q.process() } -> std::same_as<Process>;
};

namespace detail {

template <class P, class F>
Largest together([[maybe_unused]] const P& particles, F&& f) {
  if constexpr (Shared<P>) {
    return particles.together(f);
  } else {
    return f();
  }
}
/// Calls f(), which only some processes may do without an exception.
template <class P, class F>
void alone(P& particles, F&& f) {
  if constexpr (Shared<P>) {
    try {
      f();
    } catch (...) {
      particles.report_fault(std::current_exception());
    }
  } else {
    f();
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
