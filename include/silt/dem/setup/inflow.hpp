// SPDX-License-Identifier: MIT
// Observers that add grains during a run, at a given rate or as fast as there is space, and that
// remove those in a region.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/dem/setup/placement_limits.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/dem/setup/region.hpp>
#include <silt/dem/setup/size_distribution.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

namespace silt::dem {

namespace detail {
/// Decides in which steps an observer acts.
struct Schedule {
  Index number = 0;  ///< times it was due so far

  struct Clock {
    double since = 0;  ///< time since the beginning [s]
    double every = 0;  ///< interval [s]; 0: every step
  };
  /// True once per interval, the first time at the beginning.
  bool is_due(const Clock& clock) {
    if (!(clock.every > 0)) return true;
    const Index due = 1 + completed_intervals(clock.since / clock.every);
    if (due <= number) return false;
    number = due;
    return true;
  }
};

/// Whether a grain at x [m] with this radius [m] would touch a wall of the interaction, which may
/// have several parts, at a time [s].
template <class I, class Vec, class Real>
bool would_touch_wall(const I& interaction, const Vec& x, Real radius, double time) {
  bool touches = false;
  if constexpr (requires { interaction.would_touch_wall(x, radius, time); }) {
    touches = interaction.would_touch_wall(x, radius, time);
  } else if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
    interaction.for_each_part(
        [&](const auto& part) { touches = touches || would_touch_wall(part, x, radius, time); });
  }
  return touches;
}
}  // namespace detail

/// Observer that adds grains, or clumps of a ClumpBlend, to a region before a step, where they
/// touch no other grain and no wall of the simulation's contacts. The k-th grain uses the random
/// numbers of the stream (seed, k), which do not depend on the course of the run. If there is no
/// free position for a grain, it and all following grains are added later, so that the size
/// distribution is kept.
///
/// At the first attempt to add a grain, throws silt::Error if other grains are not the reason that
/// there is none: if it has no room in the region, or the first grain none beside the walls. Other
/// grains may move away: see positions_tried(). `Sizes` is that of a Blend, or a ClumpBlend.
template <class R, class Sizes>
class Inflow {
  using Source = typename detail::BlendFor<Sizes>::type;
  static_assert(DrawsGrains<Source>,
                "silt::dem::Inflow: the second argument is neither a Blend nor a ClumpBlend (see "
                "DrawsGrains in silt/dem/setup/size_distribution.hpp)");

 public:
  /// The bounding Box of the region.
  using Bounds = std::remove_cvref_t<decltype(std::declval<const R&>().bounds())>;
  using Vec = decltype(Bounds::lower);
  using Real = typename Vec::Scalar;

  struct Settings {
    Index number = 0;                 ///< total number of grains
    std::optional<double> rate = {};  ///< [1/s]; not set: as many as there is space for
    double from = 0;                  ///< time of the first grain [s]
    Vec velocity = Vec::Zero();       ///< initial velocity of the grains [m/s]
    double every = 0;                 ///< time between two attempts [s]; 0: every step
    Index tries = 100;                ///< positions to try for a grain in one attempt; 1 to 1e7
    std::uint64_t seed = 0;           ///< of the random numbers
  };

  /// Throws if the region, the blend or a setting is out of range, and if more than 1e8 grains
  /// would be added at once.
  Inflow(R region, Source blend, const Settings& settings)
      : region_(std::move(region)),
        blend_(std::move(blend)),
        settings_(settings),
        near_(region_.bounds(), blend_.largest()) {
    region_.check();
    blend_.check();
    if (settings_.rate) require_positive("Inflow: rate", *settings_.rate);
    require_finite("Inflow: from", settings_.from);
    require_finite("Inflow: velocity", settings_.velocity);
    require_not_negative("Inflow: every", settings_.every);
    detail::check_tries("Inflow", settings_.tries);
    detail::check_bounds(Bounds(region_.bounds()));
    if (!settings_.rate) check_number(settings_.number);
  }

  /// Grains added so far.
  Index number() const noexcept { return added_; }
  /// Positions tried so far for the next grain. It grows as long as there is none for it.
  std::uint64_t positions_tried() const noexcept { return tried_ / dimension; }
  /// Whether all grains have been added.
  bool is_done() const noexcept { return added_ == settings_.number; }

  template <class Sim>
  void before_step(Sim& simulation) {
    static_assert(silt::detail::are_of_one_process<std::remove_cvref_t<decltype(simulation.particles())>>,
                  "silt::dem::Inflow: grains cannot be added to those that processes share; add "
                  "them before mpi::distribute");
    const double since = simulation.time() - settings_.from;
    if (since < 0 || added_ >= due(since)) return;
    if (!schedule_.is_due({.since = since, .every = settings_.every})) return;
    add_grains(simulation, due(since), [&](const Vec& x, Real radius) {
      return detail::would_touch_wall(simulation.interaction(), x, radius, simulation.time());
    });
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("added", added_);
    archive("tried", tried_);
    archive("checks", schedule_.number);
  }

 private:
  Index due(double since) const {
    if (!settings_.rate) return settings_.number;
    const double expected = std::min(*settings_.rate * since, double(settings_.number));
    return std::min(settings_.number, 1 + completed_intervals(expected));
  }

  // Throws if so many grains, of which as many are added as there is space for, are too many.
  void check_number(Index number) const {
    constexpr int Dim = Vec::RowsAtCompileTime;
    if (double(number) <= detail::max_placed) return;
    const double room = detail::number_in<Dim>(region_.volume(), blend_, settings_.seed);
    if (room <= detail::max_placed) return;
    fail({"Inflow: number = ", double(number),
          " grains at once, of which the region has room for up to ", room,
          ", are more than 1e8; add fewer or larger grains, or set a lower rate"});
  }

  template <class Sim, class TouchesWall>
  void add_grains(Sim& simulation, Index target, TouchesWall&& touches_wall) {
    check_number(target - added_);
    auto& grains = simulation.particles();
    detail::Placement<R, int(dimension), Real> placement(std::as_const(grains), region_,
                                                         near_.find(std::as_const(grains)));
    while (added_ < target) {
      Random random{.seed = settings_.seed, .id = added_};
      const auto grain = blend_.draw(random);
      random.counter += tried_;
      const auto drawn = random.counter;
      detail::check_fits("Inflow", Bounds(region_.bounds()), grain.radius);
      const auto ball = placement.find(random, Real(grain.radius), settings_.tries, touches_wall);
      const bool is_first_attempt = tried_ == 0;
      tried_ += random.counter - drawn;
      if (!ball) {
        if (is_first_attempt) {
          require_room(placement, Real(grain.radius), simulation.time(), touches_wall);
        }
        return;
      }
      if constexpr (SizeDistribution<Sizes>) {
        const Index i = add_grain(grains, ball->centre, grain);
        grains[velocity][i] = settings_.velocity;
      } else {
        blend_.add(grains, simulation.integrator().clumps(), ball->centre, grain,
                   settings_.velocity);
      }
      ++added_;
      tried_ = 0;
    }
  }

  // Throws if other grains are not the reason that there was no position for the next one. Walls
  // may move: they are asked once, at the beginning.
  template <class Placement, class TouchesWall>
  void require_room(const Placement& placement, Real radius, double time,
                    TouchesWall&& touches_wall) const {
    const Random random{.seed = settings_.seed, .id = added_, .counter = std::uint64_t{1} << 32};
    const auto touches_none = [](const Vec&, Real) { return false; };
    if (!placement.has_room(random, radius, detail::tries_for_room, touches_none)) {
      detail::fail_for_room("Inflow", double(radius));
    }
    if (added_ > 0 || placement.has_room(random, radius, detail::tries_for_room, touches_wall)) {
      return;
    }
    detail::fail_for_walls("Inflow", double(radius), time);
  }

  // A position takes as many random numbers.
  static constexpr std::uint64_t dimension = Vec::RowsAtCompileTime;

  R region_;
  Source blend_;
  Settings settings_;
  Index added_ = 0;
  std::uint64_t tried_ = 0;  // random numbers used so far for the next grain
  detail::Schedule schedule_;
  detail::GrainsNear<Vec::RowsAtCompileTime, Real> near_;
};

template <class R, class Sizes>
Inflow(R, Blend<Sizes>, typename Inflow<R, Sizes>::Settings) -> Inflow<R, Sizes>;
template <class R, class B>
Inflow(R, B, typename Inflow<R, B>::Settings) -> Inflow<R, B>;

/// Observer that removes, before a step, the grains whose centres are in a region, and counts them,
/// those of all processes that share the grains; of a clump all spheres, if its centre of mass is
/// there. The region may be unbounded, e.g. a Box with a single finite side.
template <class R>
class Outflow {
 public:
  struct Settings {
    double every = 0;  ///< time between two checks [s]; 0: every step
  };

  /// Throws if the region is invalid or the time is negative.
  explicit Outflow(R region) : Outflow(std::move(region), {}) {}
  Outflow(R region, Settings settings) : region_(std::move(region)), settings_(settings) {
    region_.check();
    require_not_negative("Outflow: every", settings_.every);
  }

  Index number() const noexcept { return number_; }  ///< of grains and clumps removed so far
  double mass() const noexcept { return mass_; }     ///< of the removed grains [kg]

  template <class Sim>
  void before_step(Sim& simulation) {
    if (!schedule_.is_due({.since = simulation.time(), .every = settings_.every})) return;
    const auto& grains = std::as_const(simulation.particles());  // only removal changes them
    remove_clumps(simulation);
    const auto is_in = [&](Index i) {
      return !is_of_clump(grains, i) && region_.clearance(grains[position][i]) >= 0;
    };
    double own_number = 0;
    double own_mass = 0;
    silt::detail::together(grains, [&] {
      if (first_where(grains.size(), is_in) != no_index) {
        for (Index i = 0; i < grains.size(); ++i) {
          if (is_in(i)) own_mass += double(grains[silt::mass][i]);
        }
        own_number = double(simulation.particles().remove_if(is_in));
      }
      return Largest{};
    });
    const auto [number, mass] =
        silt::detail::sum_of_all(grains, std::array{own_number, own_mass});
    number_ += Index(number);
    mass_ += mass;
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number_);
    archive("mass", mass_);
    archive("checks", schedule_.number);
  }

 private:
  template <class P>
  static bool is_of_clump([[maybe_unused]] const P& grains, [[maybe_unused]] Index i) {
    if constexpr (HasFields<P, clump_t>) {
      return grains[clump][i] != 0;
    } else {
      return false;
    }
  }
  template <class Sim>
  void remove_clumps([[maybe_unused]] Sim& simulation) {
    if constexpr (requires { simulation.integrator().clumps(); }) {
      auto& clumps = simulation.integrator().clumps();
      using Position = std::remove_cvref_t<decltype(simulation.particles()[position][0])>;
      number_ += clumps.remove_if(simulation.particles(), [&](Index k) {
        const Position at = clumps.state(k).position.template cast<typename Position::Scalar>();
        if (!(region_.clearance(at) >= 0)) return false;
        mass_ += clumps.mass_of(k);
        return true;
      });
    }
  }

  R region_;
  Settings settings_;
  detail::Schedule schedule_;
  Index number_ = 0;
  double mass_ = 0;
};

template <class R>
Outflow(R, typename Outflow<R>::Settings) -> Outflow<R>;

}  // namespace silt::dem
