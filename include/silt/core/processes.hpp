// SPDX-License-Identifier: MIT
// What processes that share particles do together, in steps, observers and measures. Particles of
// one process need nothing of it: here every function does what one process has to do alone, or
// nothing. shared_particles.hpp has the same for several.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

namespace silt {

/// What processes decide together: each gives its own values, and gets the largest of all.
struct Largest {
  double reach = 0;         ///< interaction range [m]
  double displacement = 0;  ///< in the step [m]
  /// The negative of the time step that is chosen, or given [s].
  double minus_time_step = -std::numeric_limits<double>::infinity();
  double time_step = -std::numeric_limits<double>::infinity();  ///< that is given [s]
  double energy_gain = 0;  ///< FinishedStep::max_energy_gain, in core/watch.hpp [-]
  double wanted = 0;       ///< [-] 1 if a process wants what is asked, such as the end of a run
};

/// One of several processes.
struct Process {
  int rank = 0;   ///< from 0 on
  int count = 1;  ///< number of processes
};

namespace detail {

/// What the processes do that own particles of type P: here, one process. Further functions of the
/// particles of several are described in shared_particles.hpp.
template <class P>
struct Processes {
  static constexpr bool are_several = false;

  /// Calls f(), which returns a Largest, and returns the Largest of all. Throws in all if f() does
  /// in one.
  template <class F>
  static Largest together(const P&, F&& f) {
    return f();
  }
  /// Calls f(). If it throws in some processes only, outside of together() and the like, all throw
  /// in their next together().
  template <class F>
  static void call_alone(P&, F&& f) {
    f();
  }
  /// Of each number the largest, and the sum, of all processes.
  template <std::size_t N>
  static std::array<double, N> largest(const P&, const std::array<double, N>& own) {
    return own;
  }
  template <std::size_t N>
  static std::array<double, N> sum(const P&, const std::array<double, N>& own) {
    return own;
  }
  /// Replaces these numbers, of which there are as many in every process, by the sums of all, or by
  /// the largest of each.
  static void replace_by_sums(const P&, std::span<double>) {}
  static void replace_by_largest(const P&, std::span<double>) {}
  /// Throws in all processes if they do not give the same numbers, at most six; `what` names them.
  template <std::size_t N>
  static void require_same(const P&, std::string_view, const std::array<double, N>&) {}
  /// Gives the values of owned particles, of an array with elements for the halo as well, to the
  /// halo; or adds those of the halo to those of the owned particles.
  template <class Values>
  static void share(const P&, Values&) {}
  template <class Values>
  static void add_to_owners(const P&, Values&) {}

  static Process this_one(const P&) { return {}; }
  /// The halo has all particles closer than this to one that is owned [m].
  static double depth_of_halo(const P&) { return std::numeric_limits<double>::infinity(); }
  static double moved_since_halo(const P&) { return 0; }
  template <class I>
  static void update_halo(P&, I&, double, const Largest&) {}
  static void refresh_halo(P&) {}
  static void find_halo_of_changed(P&) {}
  static void finish_step(P&, double, const Largest&) {}
  template <class I>
  static void gather(P&, I&) {}
  template <class I>
  static void keep_own(P&, I&) {}
};

/// Whether these particles are those of one process, for what several cannot do yet.
template <class P>
inline constexpr bool are_of_one_process = !Processes<P>::are_several;

// Short names for calls from other headers.

template <class P, class F>
Largest together(const P& particles, F&& f) {
  return Processes<P>::together(particles, f);
}
template <class P, class F>
void call_alone(P& particles, F&& f) {
  Processes<P>::call_alone(particles, f);
}
template <class P, std::size_t N>
std::array<double, N> largest_of_all(const P& particles, const std::array<double, N>& own) {
  return Processes<P>::largest(particles, own);
}
template <class P>
bool any_of_all(const P& particles, bool own) {
  return largest_of_all(particles, std::array{own ? 1.0 : 0.0})[0] > 0;
}
template <class P, std::size_t N>
std::array<double, N> sum_of_all(const P& particles, const std::array<double, N>& own) {
  return Processes<P>::sum(particles, own);
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
template <class P>
void replace_by_sums(const P& particles, std::span<double> values) {
  Processes<P>::replace_by_sums(particles, values);
}
template <class P>
void replace_by_largest(const P& particles, std::span<double> values) {
  Processes<P>::replace_by_largest(particles, values);
}
template <class P, std::size_t N>
void require_same_in_all(const P& particles, std::string_view what,
                         const std::array<double, N>& own) {
  Processes<P>::require_same(particles, what, own);
}
template <class P, class Values>
void share(const P& particles, Values& values) {
  Processes<P>::share(particles, values);
}
template <class P, class Values>
void add_to_owners(const P& particles, Values& values) {
  Processes<P>::add_to_owners(particles, values);
}
template <class P>
void refresh_halo(P& particles) {
  Processes<P>::refresh_halo(particles);
}

}  // namespace detail

/// Which process this is, of those that share the particles.
template <class P>
Process process_of(const P& particles) {
  return detail::Processes<P>::this_one(particles);
}

/// The halo has all particles closer than this to one that is owned [m].
template <class P>
auto depth_of_halo(const P& particles) {
  return static_cast<typename P::Real>(detail::Processes<P>::depth_of_halo(particles));
}

}  // namespace silt
