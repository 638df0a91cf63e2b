// SPDX-License-Identifier: MIT
// Wrappers that measure the wall-clock time spent in a search or an interaction.
#pragma once

#include <silt/core/concepts.hpp>

#include <chrono>
#include <concepts>
#include <utility>

namespace silt {

/// Sum of the wall-clock time of all spans; a span lasts from start() until the returned object is
/// destroyed.
class Stopwatch {
 public:
  /// Adds the time of its own life to the sum.
  class Span {
   public:
    /// `seconds` is the sum [s].
    explicit Span(double& seconds) : seconds_(seconds), begin_(Clock::now()) {}
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;
    ~Span() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }

   private:
    using Clock = std::chrono::steady_clock;
    double& seconds_;
    Clock::time_point begin_;
  };

  [[nodiscard]] Span start() { return Span(seconds_); }
  /// Sum of the times of all spans that have ended [s].
  double seconds() const noexcept { return seconds_; }

 private:
  double seconds_ = 0;
};

/// A neighbour search that measures the time of update(): TimedSearch{UniformGrid<2>{}}.
template <class S>
class TimedSearch : public S {
 public:
  /// The search is moved into it.
  explicit TimedSearch(S search) : S(std::move(search)) {}

  template <class P>
  void update(P& particles) {
    const auto span = watch_.start();
    S::update(particles);
  }

  /// Time spent in update() so far [s].
  double seconds() const noexcept { return watch_.seconds(); }

 private:
  Stopwatch watch_;
};

/// An interaction that measures the time of accelerate(): TimedInteraction{dem::Contacts{law}}.
template <class I>
class TimedInteraction : public I {
 public:
  /// The interaction is moved into it.
  explicit TimedInteraction(I interaction) : I(std::move(interaction)) {}

  // See ForParticles in core/concepts.hpp.
  using Description = TimedInteraction;
  template <class P>
  using For = TimedInteraction<ForParticles<I, P>>;
  /// For particles, from the same of a description; see ForParticles.
  template <class Described>
    requires(!std::same_as<Described, I> && std::constructible_from<I, Described>)
  TimedInteraction(TimedInteraction<Described> described)
      : I(static_cast<Described&&>(described)) {}

  template <class P, class S>
    requires requires(I& i, P& p, S& s) { i.accelerate(p, s, 0.0); }
  void accelerate(P& particles, S& search, double dt) {
    const auto span = watch_.start();
    I::accelerate(particles, search, dt);
  }

  // Deleted, so that accelerate() is called instead: calls for single particles cannot be timed.
  void add_forces() = delete;

  /// Time spent in accelerate() so far [s].
  double seconds() const noexcept { return watch_.seconds(); }

 private:
  Stopwatch watch_;
};

}  // namespace silt
