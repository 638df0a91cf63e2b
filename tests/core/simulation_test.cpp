// SPDX-License-Identifier: MIT
// A failed step is rolled back completely, and run() calls its observers at the documented times.
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::simulation_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

// A fault of a user-defined interaction.
struct Fault {
  Id id = 0;
  double push = 0;  // [N]
  bool throws = false;
};
class Saboteur {
 public:
  std::shared_ptr<std::optional<Fault>> fault = std::make_shared<std::optional<Fault>>();

  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) {
    if (!*fault) return;
    if ((*fault)->throws) throw std::runtime_error("user-defined");
    const Index i = particles.index_of((*fault)->id);
    particles[force][i][0] += typename P::Real((*fault)->push);
  }
};

const dem::CundallStrackIncremental law{.normal_stiffness = 1e6,
                                        .tangential_stiffness = 5e5,
                                        .restitution = 0.6,
                                        .friction_angle = 0.5};

template <class S, bool periodic>
struct Setting {
  using Search = S;
  static constexpr int dim = S::Vec::RowsAtCompileTime;

  // Grains that collide, also across periodic sides. Particle 5 was removed, so that ids differ
  // from indices.
  static auto make(Saboteur saboteur) {
    auto grains = crowd<dim, double>(dim == 2 ? 7 : 4, 1);
    grains.remove(5);
    auto box = cube<dim, double>(-0.5, 0.5);
    if (periodic) {
      box = cube<dim, double>(0, dim == 2 ? 7 * 0.0205 : 4 * 0.0205);
      box.periodic.fill(true);
      box.periodic[0] = false;
      box.lower[0] = -0.5;
      box.upper[0] = 0.5;
    }
    grains.set_box(box);
    return Simulation{
        std::move(grains), Search{},
        Forces{saboteur, dem::Contacts{law, dem::Plane<dim>{.point = -Vec<dim>::Unit(0),
                                                            .normal = Vec<dim>::Unit(0)}}
                             .with({.max_displacement = std::numeric_limits<double>::infinity()})},
        Leapfrog{GlobalDamping{.alpha = 0.1}}};
  }
};

// Everything that a step may change: columns, ids, contact histories, time, and results.
template <class Sim>
Bytes everything(const Sim& sim) {
  Bytes bytes = state_of(sim.particles());
  const auto& contacts = sim.interaction().template part<1>();
  contacts.history(sim.particles()).for_each_pair([&](Id a, Id b, const auto& history) {
    append(bytes, std::span<const Id>({a, b}));
    append(bytes, std::span<const double>(history.tangential_force.data(),
                                          static_cast<Index>(history.tangential_force.size())));
    append(bytes, std::span<const double>({history.normal_force}));
  });
  contacts.for_each_contact(sim.particles(),
                            [&](Index i, Index j, const auto& contact, const auto&) {
                              append(bytes, std::span<const Id>({i, j}));
                              append(bytes, std::span<const double>({contact.overlap}));
                            });
  append(bytes, std::span<const double>(
                    {sim.time(), sim.last_time_step(), contacts.elastic_energy(sim.particles())}));
  append(bytes, std::span<const Id>({sim.steps(), sim.particles_lost(), contacts.size()}));
  return bytes;
}

constexpr double dt = 2e-5;

// Provokes a failure after 0, 1, 2, … steps and checks that the run continues as without it.
template <class Setting, class Provoke>
void expect_no_trace(const std::vector<std::string>& words, Provoke&& provoke) {
  Saboteur saboteur;
  auto sim = Setting::make(saboteur);
  Saboteur honest;
  auto undisturbed = Setting::make(honest);
  for (int k = 0; k < 25; ++k) {
    const Bytes before = everything(sim);
    auto fragments = words;
    fragments.push_back("step " + std::to_string(k));
    fragments.push_back("t = " + to_text(sim.time()) + " s");
    ASSERT_TRUE(refuses([&] { provoke(sim, saboteur); }, fragments)) << "step " << k;
    saboteur.fault->reset();
    ASSERT_EQ(everything(sim), before) << "step " << k;
    sim.step(dt);
    undisturbed.step(dt);
    ASSERT_EQ(everything(sim), everything(undisturbed)) << "step " << k;
  }
  EXPECT_GT(sim.interaction().template part<1>().size(), 10u) << "grains were in contact";
}

template <class T>
class Transactions : public ::testing::Test {};
using Settings =
    AllOrUsual<::testing::Types<Setting<UniformGrid<2>, true>, Setting<NeighbourList<2>, true>,
                                Setting<NeighbourList<3>, false>, Setting<BruteForce<2>, false>>,
               ::testing::Types<Setting<NeighbourList<2>, true>>>;
TYPED_TEST_SUITE(Transactions, Settings);

TYPED_TEST(Transactions, AForceThatIsNotFiniteLeavesTheSimulationUnchanged) {
  for (const double wrong : {nan, inf}) {
    expect_no_trace<TypeParam>({"force = (" + to_text(wrong), "not finite", "id 11", "particle 10"},
                               [wrong](auto& sim, Saboteur& saboteur) {
                                 *saboteur.fault = {.id = 11, .push = wrong};
                                 sim.step(dt);
                               });
  }
}

// The error names the grain at fault and its velocity, not the resulting force on it or on others.
TYPED_TEST(Transactions, AStateThatWasNotFiniteBeforeTheStepIsNamed) {
  for (const double wrong : {nan, inf}) {
    auto sim = TypeParam::make({});
    for (int k = 0; k < 3; ++k) sim.step(dt);
    double& speed = sim.particles()[velocity][sim.particles().index_of(11)][1];
    const double before = std::exchange(speed, wrong);
    EXPECT_TRUE(refuses([&] { sim.step(dt); }, {"before the step, velocity = (", to_text(wrong),
                                                "set it to a finite value", "id 11", "step 3"}));
    sim.particles()[velocity][sim.particles().index_of(11)][1] = before;
    sim.step(dt);
  }
}

TYPED_TEST(Transactions, AGrainThatLeavesTheBoxLeavesTheSimulationUnchanged) {
  expect_no_trace<TypeParam>({"left the box", "id 11", "x = (", "OnEscape::remove"},
                             [](auto& sim, Saboteur& saboteur) {
                               *saboteur.fault = {.id = 11, .push = 1e12};
                               sim.step(dt);
                             });
}

TYPED_TEST(Transactions, ATimeStepBeyondStabilityLeavesTheSimulationUnchanged) {
  Saboteur saboteur;
  auto sim = TypeParam::make(saboteur);
  auto undisturbed = TypeParam::make({});
  for (int k = 0; k < 10; ++k) {
    sim.step(dt);
    undisturbed.step(dt);
  }
  const Bytes before = everything(sim);
  for (const double wrong : {1.0, 1e-2}) {
    EXPECT_TRUE(refuses([&] { sim.step(wrong); },
                        {"time_step = " + to_text(wrong), "stable", "id ", "step 10"}));
  }
  for (const double wrong : {0.0, -1.0, nan, inf}) {
    EXPECT_TRUE(refuses([&] { sim.step(wrong); }, {"time_step = " + to_text(wrong), "step 10"}));
  }
  EXPECT_EQ(everything(sim), before);
  for (int k = 0; k < 10; ++k) {
    sim.step(dt);
    undisturbed.step(dt);
  }
  EXPECT_EQ(everything(sim), everything(undisturbed));
}

TYPED_TEST(Transactions, AUserDefinedExceptionPassesAndLeavesTheSimulationUnchanged) {
  Saboteur saboteur;
  auto sim = TypeParam::make(saboteur);
  auto undisturbed = TypeParam::make({});
  for (int k = 0; k < 10; ++k) {
    *saboteur.fault = {.throws = true};
    const Bytes before = everything(sim);
    EXPECT_THROW(sim.step(dt), std::runtime_error);
    EXPECT_EQ(everything(sim), before);
    saboteur.fault->reset();
    sim.step(dt);
    undisturbed.step(dt);
  }
  EXPECT_EQ(everything(sim), everything(undisturbed));
}

// Its second update in a step is that after a particle was removed.
struct UpdatesOnce : BruteForce<2> {
  template <class P>
  void update(P& particles) {
    if (updates_left == 0) throw std::runtime_error("no more updates");
    --updates_left;
    BruteForce<2>::update(particles);
  }
  static inline int updates_left = 1000;
};
TEST(EscapedParticles, AreRestoredIfTheSearchThenThrows) {
  auto grains = dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0.5, 0.9999}}, pebble);
  grains.set_box({.lower = {-1, -1}, .upper = {1, 1}, .on_escape = OnEscape::remove});
  grains[velocity][1] = {0, 1};
  Simulation sim{grains, UpdatesOnce{}, dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e4}},
                 Leapfrog{}};
  sim.step(1e-5);
  const auto before = state_of(sim.particles());
  UpdatesOnce::updates_left = 1;
  EXPECT_THROW(sim.step(2e-4), std::runtime_error);
  EXPECT_EQ(state_of(sim.particles()), before);
  EXPECT_EQ(sim.particles_lost(), 0u);
  EXPECT_EQ(sim.steps(), 1u);
  UpdatesOnce::updates_left = 1000;
  sim.step(2e-4);
  EXPECT_EQ(sim.particles_lost(), 1u);
  EXPECT_EQ(sim.steps(), 2u);
}

TYPED_TEST(Transactions, ASnapshotLeavesTheSimulationUnchanged) {
  auto sim = TypeParam::make({});
  auto undisturbed = TypeParam::make({});
  for (int k = 0; k < 20; ++k) {
    const auto snapshot = sim.snapshot();
    EXPECT_EQ(snapshot.size(), sim.particles().size());
    sim.step(dt);
    undisturbed.step(dt);
    ASSERT_EQ(everything(sim), everything(undisturbed)) << k;
  }
}

// Contacts with a floor at this height; one type for all tests, which saves compile time.
auto on_a_floor(double height) { return dem::Contacts{law, dem::Plane<2>{.point = {0, height}}}; }
constexpr double far_below = -10;

TEST(Simulation, ReportsCoincidentGrainsAndIsRolledBack) {
  auto grains = two_grains<2>(0.1, Vec<2>(0, 0));
  dem::add_grain(grains, {0.5, 0.5}, pebble);
  Simulation sim{grains, UniformGrid<2>{}, on_a_floor(far_below), Leapfrog{}};
  sim.step(dt);
  sim.particles()[position][2] = sim.particles()[position][1];
  const Bytes before = state_of(sim.particles());
  EXPECT_TRUE(
      refuses([&] { sim.step(dt); }, {"grains 1 and 2 coincide", "id 1", "step 1", "t = 2e-05 s"}));
  EXPECT_EQ(state_of(sim.particles()), before);
  EXPECT_EQ(sim.steps(), 1u);
}

TEST(Simulation, RemovesAndCountsEscapedParticlesIfTheBoxIsSetToRemove) {
  auto grains = one_grain<2>({0.5, 0.5}, {1, 0});
  dem::add_grain(grains, {0.5, 0.2}, pebble);
  auto box = cube<2, double>(0, 1);
  box.on_escape = OnEscape::remove;
  grains.set_box(box);
  Simulation sim{grains, UniformGrid<2>{}, on_a_floor(0), Leapfrog{}};
  sim.run({.until = 0.4, .time_step = 1e-3});
  EXPECT_EQ(sim.particles().size(), 2u);
  EXPECT_EQ(sim.particles_lost(), 0u);
  sim.run({.until = 0.6, .time_step = 1e-3});
  ASSERT_EQ(sim.particles().size(), 1u);
  EXPECT_EQ(sim.particles().id(0), 1u);
  EXPECT_EQ(sim.particles_lost(), 1u);
}

TEST(Simulation, DropsTheContactsOfARemovedGrain) {
  // The last of a row of touching grains is pushed out of the box; only the others have contacts.
  auto grains = two_grains<2>(-1e-4, Vec<2>(0, 0));
  dem::add_grain(grains, {0.0399, 0.01}, pebble);
  auto box = cube<2, double>(-1, 1);
  box.upper[0] = 0.03995;
  box.on_escape = OnEscape::remove;
  grains.set_box(box);
  Simulation sim{grains, UniformGrid<2>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
  const auto energy = [&] { return sim.interaction().elastic_energy(sim.particles()); };
  sim.step(1e-5);
  const double pair_energy = 1e5 * 1e-4 * 1e-4 / 2;
  EXPECT_EQ(sim.interaction().size(), 1u);
  EXPECT_NEAR(energy(), pair_energy, 1e-3 * pair_energy);
  while (sim.particles_lost() == 0) sim.step(1e-5);
  Index seen = 0;
  sim.interaction().for_each_contact(sim.particles(),
                                     [&](Index i, Index j, const auto&, const auto&) {
                                       ++seen;
                                       EXPECT_LT(i, sim.particles().size());
                                       EXPECT_LT(j, sim.particles().size());
                                     });
  EXPECT_LE(seen, 1u);
  EXPECT_TRUE(is_finite(energy()));
}

TEST(Simulation, CallsObserversAtTheStartAtOutputsAndAtTheEnd) {
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                 Leapfrog{}};
  std::vector<double> times;
  const auto note = [&](const auto& s) { times.push_back(s.time()); };
  sim.run({.until = 1.05, .output_every = 0.25, .time_step = 0.0625}, note);
  EXPECT_EQ(times, (std::vector<double>{0, 0.25, 0.5, 0.75, 1.0, 1.0625}));

  times.clear();
  sim.run({.until = 2, .time_step = 0.0625}, note);
  EXPECT_EQ(times, (std::vector<double>{1.0625, 2}));

  times.clear();
  sim.run({.until = 1, .time_step = 0.0625}, note);
  EXPECT_EQ(times, (std::vector<double>{2})) << "the end has been reached";
}

TEST(Simulation, CallsObserversOnceAtAnOutputThatIsTheEnd) {
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                 Leapfrog{}};
  int calls = 0;
  // Steps of 0.1 and their sums are rounded; the number of outputs is exact.
  sim.run({.until = 3, .output_every = 0.1, .time_step = 0.1}, [&](const auto&) { ++calls; });
  EXPECT_EQ(sim.steps(), 30u);
  EXPECT_EQ(calls, 31);
}

auto falling_grain() {
  return Simulation{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                    Leapfrog{}};
}

TEST(Simulation, EndsExactlyAtUntilIfRequested) {
  for (const double until : {1.0, 0.7, 0.1 + 0.2, 1.0 / 3, 1e-3}) {
    for (const double time_step : {0.1, 0.07, 0.03, 1.0 / 3, 5.0}) {
      auto sim = falling_grain();
      double shortest = inf, longest = 0, before = 0;
      std::vector<double> outputs;
      const auto note = [&](const auto& s) {
        if (s.steps() == 0) return;
        shortest = std::min(shortest, s.last_time_step());
        longest = std::max(longest, s.last_time_step());
        EXPECT_GT(s.time(), before);
        before = s.time();
      };
      EXPECT_TRUE(sim.run(
          {.until = until, .output_every = 1e-9, .time_step = time_step, .end_exactly = true},
          note));
      EXPECT_EQ(sim.time(), until) << time_step;
      EXPECT_LE(longest, time_step) << "which may be the longest that is stable";
      EXPECT_GE(shortest, std::min(time_step, until) / 2 * (1 - 1e-9)) << until << " " << time_step;
      // Its place is that of the fall, whose steps may differ.
      EXPECT_NEAR(sim.particles()[position][0][1], 1 - 9.81 * until * until / 2,
                  9.81 * until * longest);
      const auto steps = sim.steps();
      sim.run({.until = until, .time_step = time_step, .end_exactly = true});
      EXPECT_EQ(sim.steps(), steps) << "there is nothing left to do";
    }
  }
}

TEST(Simulation, EndsWithinRoundOffOfUntil) {
  auto sim = falling_grain();
  sim.run({.until = 1, .time_step = 0.1});
  EXPECT_EQ(sim.steps(), 10u);
  EXPECT_LT(sim.time(), 1) << "by rounding";
  sim.run({.until = 1, .time_step = 0.1, .end_exactly = true});
  EXPECT_EQ(sim.steps(), 10u);
  EXPECT_EQ(sim.time(), 1);

  auto exact = falling_grain();
  exact.run({.until = 1, .time_step = 0.1, .end_exactly = true});
  EXPECT_EQ(exact.steps(), 10u) << "no step is left for the rounding";
  EXPECT_EQ(exact.time(), 1);
}

struct StopsAfter {
  int steps;
  std::string& calls;
  void operator()(const auto&) const { calls += 'o'; }
  void after_step(const auto&, const Run&) {
    calls += 'a';
    --steps;
  }
  void between_steps(const auto&) const { calls += 'b'; }
  bool stop_requested() const { return steps <= 0; }
};

TEST(Simulation, EndsARunIfAnObserverRequestsIt) {
  const silt::Run run{.until = 1, .output_every = 0.25, .time_step = 0.125};
  auto sim = falling_grain();
  std::string calls;
  EXPECT_FALSE(sim.run(run, StopsAfter{3, calls}));
  EXPECT_EQ(sim.steps(), 3u);
  EXPECT_EQ(calls, "oabaobab") << "no output where it was stopped";
  calls.clear();
  EXPECT_TRUE(sim.run(run, StopsAfter{100, calls}));
  EXPECT_EQ(calls, "aobabaobabaob") << "the run goes on";
  calls.clear();
  EXPECT_TRUE(sim.run({.until = 1}, StopsAfter{0, calls}));
  EXPECT_EQ(calls, "o") << "the next one begins";
}

TEST(Simulation, BeginsANewRunAfterOneThatThrew) {
  Saboteur saboteur;
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Forces{saboteur}, Leapfrog{}};
  int calls = 0;
  const auto count = [&](const auto&) { ++calls; };
  saboteur.fault->emplace().push = nan;
  EXPECT_THROW(sim.run({.until = 1, .time_step = 0.5}, count), Error);
  EXPECT_EQ(calls, 1);
  saboteur.fault->reset();
  EXPECT_TRUE(sim.run({.until = 1, .time_step = 0.5}, count));
  EXPECT_EQ(calls, 3);
}

struct CountsSteps {
  std::shared_ptr<int> steps = std::make_shared<int>(0);
  template <class Sim>
  void operator()(const Sim&) const {}
  template <class Sim>
  void after_step(const Sim&, const Run& run) const {
    EXPECT_EQ(run.until, 0.5);
    ++*steps;
  }
};

TEST(Simulation, CallsAfterStepAfterEveryStep) {
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                 Leapfrog{}};
  const CountsSteps counter;
  sim.run({.until = 0.5, .time_step = 0.125}, counter);
  EXPECT_EQ(*counter.steps, 4);
}

// A force along x that grows with time; records the times at which it was evaluated.
class Rising {
 public:
  std::shared_ptr<std::vector<double>> times = std::make_shared<std::vector<double>>();

  void set_time(double time) { time_ = time; }
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    times->push_back(time_);
    for (Index i = 0; i < particles.size(); ++i) {
      particles[force][i][0] += particles[mass][i] * time_;
    }
  }

 private:
  double time_ = nan;
};
static_assert(DependsOnTime<Rising> && !DependsOnTime<Gravity<2>>);

// No force; records for how long the particles had moved before each evaluation.
class RecordsMotion {
 public:
  std::shared_ptr<std::vector<double>> time_steps = std::make_shared<std::vector<double>>();

  void set_last_time_step(double time_step) { last_ = time_step; }
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P&, const S&, double) const {
    time_steps->push_back(last_);
  }

 private:
  double last_ = nan;
};
static_assert(DependsOnLastTimeStep<RecordsMotion> && !DependsOnLastTimeStep<Rising>);

// No force, and a time step that decreases with time.
class EverShorter {
 public:
  void set_time(double time) { time_ = time; }
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P&, const S&, double) const {}
  template <class P>
  double time_step(const P&) const {
    return 0.25 / (1 + time_);
  }

 private:
  double time_ = nan;
};

TEST(Simulation, ChoosesATimeStepForTheTimeOfThePositions) {
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, EverShorter{}, Leapfrog{}};
  EXPECT_EQ(sim.time_step(), 0.25);
  sim.step();
  EXPECT_EQ(sim.time(), 0.25);
  EXPECT_EQ(sim.time_step(), 0.25 / 1.25);
}

TEST(Simulation, SetsTheTimeOfAnInteractionToThatOfThePositions) {
  const Rising rising;
  Saboteur saboteur;
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Forces{rising, saboteur},
                 Leapfrog{}};
  for (int k = 0; k < 3; ++k) sim.step(0.125);
  // The first step also evaluates the forces at time 0, for v^{−½}.
  EXPECT_EQ(*rising.times, (std::vector<double>{0, 0, 0.125, 0.25}));
  EXPECT_EQ(sim.snapshot()[velocity][0][0], 0.375 * 0.375 / 2);
  EXPECT_EQ(rising.times->back(), 0.375);

  saboteur.fault->emplace().push = nan;
  EXPECT_THROW(sim.step(0.125), Error);
  saboteur.fault->reset();
  sim.step(0.125);
  EXPECT_EQ(rising.times->back(), 0.375) << "a failed step does not advance the time";
}

TEST(Simulation, TellsAnInteractionForHowLongTheParticlesHaveMoved) {
  const RecordsMotion records;
  Saboteur saboteur;
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Forces{records, saboteur},
                 Leapfrog{}};
  sim.snapshot();
  sim.step(0.25);
  sim.snapshot();
  saboteur.fault->emplace().push = nan;
  EXPECT_THROW(sim.step(0.5), Error);
  saboteur.fault->reset();
  sim.step(0.125);
  sim.step(1);
  // The first step evaluates the forces at time 0 twice.
  EXPECT_EQ(*records.time_steps, (std::vector<double>{0, 0, 0, 0.25, 0.25, 0.25, 0.125}));
}

struct DropsOne {
  std::vector<double> times;
  template <class Sim>
  void before_step(Sim& simulation) {
    times.push_back(simulation.time());
    dem::add_grain(simulation.particles(), {double(times.size()), 1}, pebble);
  }
};

TEST(Simulation, CanBeChangedByAnObserverBeforeEveryStep) {
  Simulation sim{dem::Grains<2>{}, UniformGrid<2>{}, Gravity<2>{{0, -9.81}}, Leapfrog{}};
  DropsOne drops;
  std::vector<Index> seen;
  const auto see = [&](const auto& s) { seen.push_back(s.particles().size()); };
  sim.run({.until = 0.5, .output_every = 0.25, .time_step = 0.125}, see, drops);
  EXPECT_EQ(drops.times, (std::vector<double>{0, 0.125, 0.25, 0.375}));
  EXPECT_EQ(seen, (std::vector<Index>{0, 2, 4}));
  EXPECT_LT(sim.particles()[position][0][1], sim.particles()[position][3][1]);
}

TEST(Simulation, RejectsInvalidRuns) {
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, -9.81}},
                 Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.run({.until = nan}); }, {"Run: until = nan"}));
  EXPECT_TRUE(refuses([&] { sim.run({.until = inf}); }, {"Run: until = inf"}));
  EXPECT_TRUE(
      refuses([&] { sim.run({.until = 1, .output_every = -1}); }, {"Run: output_every = -1"}));
  EXPECT_TRUE(refuses([&] { sim.run({.until = 1, .time_step = 0.0}); }, {"Run: time_step = 0"}));
  EXPECT_TRUE(refuses([&] { sim.run({.until = 1}); }, {"chooses no time step"}));
  EXPECT_TRUE(refuses([&] { sim.run({.until = 1, .time_step = 1e-300}); },
                      {"Run: time_step = 1e-300 s: 1e+300 steps are ahead, more than 1e+12"}));
  EXPECT_TRUE(refuses([&] { sim.run({.until = 1, .output_every = 1e-300, .time_step = 0.1}); },
                      {"Run: output_every = 1e-300 s: 1e+300 outputs are ahead"}));
  EXPECT_EQ(sim.steps(), 0u);
  EXPECT_TRUE(refuses([&] { sim.step(); }, {"chooses no time step"}));
  EXPECT_EQ(sim.steps(), 0u);
  sim.step(1);
  EXPECT_TRUE(refuses([&] { sim.step(1e-17); }, {"1e-17 s does not change the time"}));
}

TEST(Simulation, RejectsASearchRadiusBelowTheInteractionRange) {
  EXPECT_TRUE(refuses(
      [] {
        Simulation{two_grains<2>(0, Vec<2>(0, 0)), UniformGrid<2>({.radius = 0.015}),
                   on_a_floor(far_below), Leapfrog{}};
      },
      {"search radius 0.015", "0.02"}));
}

TEST(Simulation, AcceptsASearchRadiusEqualToTheInteractionRange) {
  Simulation sim{two_grains<2>(0, Vec<2>(0, 0)), UniformGrid<2>({.radius = 0.02}),
                 on_a_floor(far_below), Leapfrog{}};
  EXPECT_NO_THROW(sim.step(dt));
}

TEST(Simulation, IncreasesTheSearchRadiusWhenALargerGrainIsAdded) {
  Simulation sim{two_grains<2>(0.1, Vec<2>(0, 0)), UniformGrid<2>{}, on_a_floor(far_below),
                 Leapfrog{}};
  sim.step(dt);
  EXPECT_EQ(sim.search().radius(), 0.02);
  dem::add_grain(sim.particles(), {0, 0.1}, {.radius = 0.095, .density = 2500});
  sim.step(dt);
  EXPECT_EQ(sim.search().radius(), 0.19);
  EXPECT_EQ(sim.interaction().size(), 1u) << "it touches the grain at the origin";
}

TEST(Gravity, RejectsAnAccelerationThatIsNotFinite) {
  EXPECT_TRUE(refuses([] { Gravity<2>({0, nan}); }, {"Gravity: acceleration", "nan"}));
  EXPECT_TRUE(refuses([] { Gravity<3>({0, 0, inf}); }, {"Gravity: acceleration", "inf"}));
}

// Adds no forces; its interaction range is negative.
struct Repelled {
  template <class P>
  double reach(const P&) const {
    return -1;
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {}
};

TEST(Simulation, RejectsANegativeInteractionRange) {
  EXPECT_TRUE(refuses(
      [] { Simulation(one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{}, Repelled{}, Leapfrog{}); },
      {"Simulation: interaction range = -1"}));
}

// Forces and torques that are not finite, as a law has them with a force that is not.
struct Broken {
  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    particles[force][0][1] = nan;
    particles[torque][0] = inf;
  }
};

TEST(Simulation, ReportsAForceBeforeTheTorqueThatFollowsFromIt) {
  Simulation grain{one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{}, Broken{}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { grain.step(dt); }, {"after the step, force = (0, nan)", "id 0"}));

  Particles<2, double, torque_t, force_t, velocity_t, spin_t, mass_t, inertia_t> particles;
  particles.add({0, 0});
  particles[mass][0] = particles[inertia][0] = 1;
  Simulation sim{particles, UniformGrid<2>{}, Broken{}, Leapfrog{}};
  EXPECT_TRUE(refuses([&] { sim.step(dt); }, {"after the step, force = (0, nan)"}));
}

// Adds no forces; with this interaction range and time step.
struct Limits {
  double range = 0;
  double dt = 1;
  template <class P>
  typename P::Real reach(const P&) const {
    return typename P::Real(range);
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {}
  template <class P>
  double time_step(const P&) const {
    return dt;
  }
};

TEST(Forces, RefusesAnInteractionRangeOfAPartThatIsNotPossible) {
  for (const double wrong : {nan, -1.0, inf}) {
    const std::string text = "Forces: interaction range = " + to_text(wrong);
    EXPECT_TRUE(refuses(
        [&] {
          Simulation(one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{},
                     Forces{Limits{.range = 0.1}, Limits{.range = wrong}}, Leapfrog{});
        },
        {text, "part 1"}));
    EXPECT_TRUE(refuses(
        [&] {
          Simulation(one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{},
                     Forces{Limits{.range = wrong}, Limits{.range = 0.1}}, Leapfrog{});
        },
        {text, "part 0"}));
  }
}

TEST(Forces, RefusesATimeStepOfAPartThatIsNotPossible) {
  for (const double wrong : {nan, -1.0, 0.0, -inf}) {
    for (const bool first : {false, true}) {
      const Limits bad{.dt = wrong};
      Simulation sim{one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{},
                     Forces{first ? bad : Limits{}, first ? Limits{} : bad}, Leapfrog{}};
      const std::vector<std::string> words{"Forces: time_step = " + to_text(wrong),
                                           first ? "part 0" : "part 1"};
      EXPECT_TRUE(refuses([&] { sim.time_step(); }, words));
      EXPECT_TRUE(refuses([&] { sim.step(); }, words));
      EXPECT_EQ(sim.steps(), 0u);
    }
  }
}

TEST(Forces, AcceptsPartsThatLimitNoTimeStep) {
  Simulation sim{one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{},
                 Forces{Limits{.dt = inf}, Limits{.dt = 0.5}}, Leapfrog{}};
  EXPECT_EQ(sim.time_step(), 0.5);
}

}  // namespace
}  // namespace silt::test::simulation_test
