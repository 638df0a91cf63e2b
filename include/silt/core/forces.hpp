// SPDX-License-Identifier: MIT
// Gravity, and the sum of several interactions.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/tuples.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace silt {

/// The same acceleration for every particle: F = m g.
template <int Dim, class Real = double>
class Gravity {
 public:
  /// g [m/s²]. Throws if it is not finite.
  explicit Gravity(const Vec<Dim, Real>& g) : g_(g) { require_finite("Gravity: acceleration", g); }

  /// g [m/s²].
  const Vec<Dim, Real>& acceleration() const noexcept { return g_; }

  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }

  template <class P>
  bool needs_search(const P&) const {
    return false;
  }

  template <class P, class S>
    requires AddsForces<Gravity, P>
  void accelerate(P& particles, S&, double, const Pass& pass = {}) const {
    accelerate_each(*this, particles, pass);
  }
  template <class P>
    requires HasFields<P, mass_t, force_t> && std::same_as<typename P::Vec, Vec<Dim, Real>>
  void add_forces(P& particles, Index i) const {
    particles[force][i] += std::as_const(particles)[mass][i] * g_;
  }

 private:
  Vec<Dim, Real> g_;
};

template <class Real>
Gravity(const Eigen::Matrix<Real, 2, 1>&) -> Gravity<2, Real>;
template <class Real>
Gravity(const Eigen::Matrix<Real, 3, 1>&) -> Gravity<3, Real>;

/// The sum of several interactions (its parts), evaluated in the given order.
template <class... Parts>
class Forces {
 public:
  /// The parts are moved into the sum.
  explicit Forces(Parts... parts) : parts_(std::move(parts)...) {}

  // See ForParticles in core/concepts.hpp.
  using Description = Forces;
  template <class P>
  using For = Forces<ForParticles<Parts, P>...>;
  /// The sum for particles, from the descriptions of its parts; see ForParticles.
  template <class... Descriptions>
    requires(sizeof...(Descriptions) == sizeof...(Parts) &&
             !std::same_as<Forces<Descriptions...>, Forces> &&
             (std::constructible_from<Parts, Descriptions> && ...))
  Forces(Forces<Descriptions...> described)
      : parts_(std::apply(
            [](auto&... part) {
              return std::tuple<Parts...>(static_cast<Parts>(std::move(part))...);
            },
            described.parts_)) {}

  /// Calls explain() of each part, see core/concepts.hpp.
  template <class P>
  static constexpr void explain() {
    (static_cast<void>(silt::explain<Parts, P>()), ...);
  }

  /// The part of this type, or with this number.
  template <class Part>
  const auto& part() const {
    return part<number_of<Part>()>();
  }
  template <class Part>
  auto& part() {
    return part<number_of<Part>()>();
  }
  template <Index K>
  const auto& part() const {
    return std::get<K>(parts_);
  }
  template <Index K>
  auto& part() {
    return std::get<K>(parts_);
  }

  /// f(part) for each part, in order.
  template <class F>
  void for_each_part(F&& f) const {
    detail::for_each_of(parts_, f);
  }
  template <class F>
  void for_each_part(F&& f) {
    detail::for_each_of(parts_, f);
  }

  /// The largest interaction range of the parts [m]. Throws if that of one is negative or not
  /// finite.
  template <class P>
    requires(HasReach<Parts, P> && ...)
  typename P::Real reach(const P& particles) const {
    typename P::Real maximum = 0;
    Index number = 0;
    for_each_part([&](const auto& part) {
      const auto own = static_cast<typename P::Real>(part.reach(particles));
      if (!(own >= 0 && is_finite(own))) {
        refuse_part(number, "interaction range", double(own), "m must be finite and not negative");
      }
      maximum = std::max(maximum, own);
      ++number;
    });
    return maximum;
  }

  /// Sets the time [s] of the parts that depend on it.
  void set_time(double time) {
    for_each_part([time](auto& part) { silt::set_time(part, time); });
  }
  /// Sets the last time step [s] of the parts that depend on it; 0 before the first step.
  void set_last_time_step(double dt) {
    for_each_part([dt](auto& part) { silt::set_last_time_step(part, dt); });
  }

  template <class P, class S>
    requires(Interaction<Parts, P, S> && ...)
  void accelerate(P& particles, S& search, double dt) {
    for_each_part([&](auto& part) { part.accelerate(particles, search, dt); });
  }

  /// The parts with add_forces() act within the pass of the part before or after them, so that the
  /// particles are read once.
  template <Index K = 0, class P, class S>
    requires((AddsForces<Parts, P> || AcceleratesInPass<Parts, P, S>) && ...)
  void accelerate(P& particles, S& search, double dt, const Pass& pass) {
    // The next part that does not act on single particles; those of them around it act in its pass.
    constexpr Index shared = next_shared<K, P>();
    const auto before = [&](Index first, Index last) {
      pass.before(first, last);
      add_forces_of<K, shared>(particles, first, last);
    };
    if constexpr (shared == sizeof...(Parts)) {
      for_each_range(particles.size(), [&](Index first, Index last) {
        before(first, last);
        pass.after(first, last);
      });
    } else if constexpr (next_shared<shared + 1, P>() == sizeof...(Parts)) {
      const auto after = [&](Index first, Index last) {
        add_forces_of<shared + 1, sizeof...(Parts)>(particles, first, last);
        pass.after(first, last);
      };
      part<shared>().accelerate(particles, search, dt, {before, after});
    } else {
      part<shared>().accelerate(particles, search, dt, {before, do_nothing});
      accelerate<shared + 1>(particles, search, dt, {do_nothing, pass.after});
    }
  }

  template <class P>
  bool needs_search(const P& particles) const {
    bool needed = false;
    for_each_part([&](const auto& part) { needed |= silt::needs_search(part, particles); });
    return needed;
  }

  /// The smallest time step [s] of the parts that choose one; infinity if none does. Throws if that
  /// of one is not positive.
  template <class P>
  double time_step(const P& particles) {
    double minimum = std::numeric_limits<double>::infinity();
    Index number = 0;
    for_each_part([&](auto& part) {
      if constexpr (ChoosesTimeStep<decltype(part), P>) {
        const double own = part.time_step(particles);
        if (!(own > 0)) {  // also NaN
          refuse_part(number, "time_step", own, "s must be positive, or infinite for no limit");
        }
        minimum = std::min(minimum, own);
      }
      ++number;
    });
    return minimum;
  }

  /// What limits the time step of the part with the smallest; empty if it does not tell.
  template <class P>
  [[gnu::cold]] std::string limit_of_time_step(const P& particles) const {
    double minimum = std::numeric_limits<double>::infinity();
    std::string limit;
    for_each_part([&]<class Part>(Part part) {  // a copy, because time_step() may change it
      if constexpr (ChoosesTimeStep<Part, P>) {
        const double own = part.time_step(particles);
        if (!(own < minimum)) return;
        minimum = own;
        limit.clear();
        if constexpr (LimitsTimeStep<Part, P>) limit = part.limit_of_time_step(particles);
      }
    });
    return limit;
  }

  /// Checks of the parts after a step, see core/watch.hpp. Throws as they do.
  template <class P>
  void check_step(const P& particles, const FinishedStep& step) const {
    for_each_part([&](const auto& part) { detail::check_step(part, particles, step); });
  }
  template <class P>
  void check_energy(const P& particles, const FinishedStep& step) const {
    for_each_part([&](const auto& part) { detail::check_energy(part, particles, step); });
  }

  /// Writes or reads the state of the parts for a checkpoint, see core/transfer.hpp.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    Index number = 0;
    for_each_part([&](auto& part) {
      detail::transfer_part(archive, std::to_string(number++), part, particles);
    });
  }

  void save() {
    for_each_part([](auto& part) {
      if constexpr (Transactional<decltype(part)>) part.save();
    });
  }
  void restore() noexcept {
    for_each_part([](auto& part) {
      if constexpr (Transactional<decltype(part)>) part.restore();
    });
  }

 private:
  template <class...>
  friend class Forces;

  [[noreturn]] static void refuse_part(Index number, const char* name, double value,
                                       const char* unit_and_rule) {
    fail({"Forces: ", name, " = ", value, " ", unit_and_rule, "; correct part ", number});
  }

  template <class Part>
  static constexpr Index number_of() {
    constexpr bool is_exact = (std::same_as<Parts, Part> || ...);
    constexpr std::array fits{
        (is_exact ? std::same_as<Parts, Part> : std::derived_from<Parts, Part>)...};
    static_assert(std::count(fits.begin(), fits.end(), true) == 1,
                  "silt::Forces: not exactly one part has this type; give its number");
    return Index(std::find(fits.begin(), fits.end(), true) - fits.begin());
  }

  template <Index K, class P>
  static constexpr bool is_of_particle =
      AddsForces<std::tuple_element_t<K, std::tuple<Parts...>>, P>;

  // Number of the first part from K on that is not evaluated for one particle alone.
  template <Index K, class P>
  static constexpr Index next_shared() {
    if constexpr (K < sizeof...(Parts)) {
      if constexpr (is_of_particle<K, P>) return next_shared<K + 1, P>();
    }
    return K;
  }
  // Adds the forces of the parts [K, L), which are evaluated for one particle alone.
  template <Index K, Index L, class P>
  void add_forces_of(P& particles, Index first, Index last) const {
    if constexpr (K < L) {
      for (Index i = first; i < last; ++i) part<K>().add_forces(particles, i);
      add_forces_of<K + 1, L>(particles, first, last);
    }
  }

  std::tuple<Parts...> parts_;
};

}  // namespace silt
