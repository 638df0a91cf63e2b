// SPDX-License-Identifier: MIT
// Gravity, and the sum of several interactions.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>

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

  const Vec<Dim, Real>& acceleration() const noexcept { return g_; }

  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }

  template <class P, class S>
    requires HasFields<P, mass_t, force_t> && std::same_as<typename P::Vec, Vec<Dim, Real>>
  void accelerate(P& particles, S& search, double dt) const {
    accelerate_all(*this, particles, search, dt);
  }
  template <class P>
    requires HasFields<P, mass_t, force_t> && std::same_as<typename P::Vec, Vec<Dim, Real>>
  void add_forces(P& particles, Index i) const {
    particles[force][i] += particles[mass][i] * g_;
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
  explicit Forces(Parts... parts) : parts_(std::move(parts)...) {}

  // See ForParticles in core/concepts.hpp.
  using Description = Forces;
  template <class P>
  using For = Forces<ForParticles<Parts, P>...>;
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

  /// The part of this type, or with this number, to read its results.
  template <class Part>
  const auto& part() const {
    constexpr bool is_exact = (std::same_as<Parts, Part> || ...);
    constexpr std::array fits{(is_exact ? std::same_as<Parts, Part>
                                        : std::derived_from<Parts, Part>)...};
    static_assert(std::count(fits.begin(), fits.end(), true) == 1,
                  "silt::Forces: not exactly one part has this type; give its number");
    return part<std::find(fits.begin(), fits.end(), true) - fits.begin()>();
  }
  template <Index K>
  const auto& part() const {
    return std::get<K>(parts_);
  }

  /// f(part) for each part, in order.
  template <class F>
  void for_each_part(F&& f) const {
    std::apply([&](const auto&... part) { (f(part), ...); }, parts_);
  }

  template <class P>
    requires(HasReach<Parts, P> && ...)
  typename P::Real reach(const P& particles) const {
    typename P::Real maximum = 0;
    for_each_part([&](const auto& part) { maximum = std::max(maximum, part.reach(particles)); });
    return maximum;
  }

  /// Sets the time [s] of the parts that depend on it.
  void set_time(double time) {
    for_each_part([time](auto& part) { silt::set_time(part, time); });
  }

  template <class P, class S>
    requires(Interaction<Parts, P, S> && ...)
  void accelerate(P& particles, S& search, double dt) {
    for_each_part([&](auto& part) { part.accelerate(particles, search, dt); });
  }

  template <class P, class S>
  void prepare(P& particles, S& search, double dt) {
    for_each_part([&](auto& part) { silt::prepare(part, particles, search, dt); });
  }
  template <class P>
  void interact(P& particles, Chunk chunk) {
    for_each_part([&](auto& part) { silt::interact(part, particles, chunk); });
  }
  ChunkSpan needs(Chunk chunk) const {
    ChunkSpan all{chunk.number, chunk.number};
    for_each_part([&](const auto& part) {
      const ChunkSpan own = silt::needs(part, chunk);
      all = {std::min(all.first, own.first), std::max(all.last, own.last)};
    });
    return all;
  }
  template <class P>
  void conclude(P& particles, double dt) {
    for_each_part([&](auto& part) { silt::conclude(part, particles, dt); });
  }
  template <class P>
    requires(AddsForces<Parts, P> && ...)
  void add_forces(P& particles, Index i) const {
    for_each_part([&](const auto& part) { part.add_forces(particles, i); });
  }

  template <class P>
    requires(AddsForces<Parts, P> && ...)
  void add_forces(P& particles, Index first, Index last) const {
    for_each_part([&](const auto& part) { add_forces_of(part, particles, first, last); });
  }

  /// The smallest time step [s] of the parts that choose one; infinity if none does.
  template <class P>
  double time_step(const P& particles) {
    double minimum = std::numeric_limits<double>::infinity();
    for_each_part([&](auto& part) {
      if constexpr (ChoosesTimeStep<decltype(part), P>) {
        minimum = std::min(minimum, double(part.time_step(particles)));
      }
    });
    return minimum;
  }

  /// Writes or reads the state of the parts for a checkpoint, see core/transfer.hpp.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    Index number = 0;
    for_each_part([&](auto& part) {
      transfer_part(archive, std::to_string(number++), part, particles);
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

  template <class F>
  void for_each_part(F&& f) {
    std::apply([&](auto&... part) { (f(part), ...); }, parts_);
  }

  std::tuple<Parts...> parts_;
};

}  // namespace silt
