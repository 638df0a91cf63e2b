// SPDX-License-Identifier: MIT
// Grains that processes share, against the same simulation in one process. Started by mpirun with
// any number of processes.
#include <silt/io/checkpoint.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/io/file.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mpi.hpp>
#include <silt/silt.hpp>

#include "../support/slow_types.hpp"
#include "processes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>

namespace silt::test::shared_grains_test {
namespace {

// Of the state of all particles of all processes, in any order.
template <class P>
std::uint64_t hash_of(const P& particles, bool is_shared) {
  std::uint64_t sum = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    std::uint64_t hash = 1469598103934665603u;
    const auto add = [&hash](const auto& value) {
      std::array<unsigned char, sizeof(value)> bytes;
      std::memcpy(bytes.data(), &value, sizeof(value));
      for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
    };
    add(particles.id(i));
    for (int k = 0; k < P::dimension; ++k) add(double(particles[position][i][k]));
    for (int k = 0; k < P::dimension; ++k) add(double(particles[velocity][i][k]));
    if constexpr (P::dimension == 2) {
      add(particles[spin][i]);
    } else {
      for (int k = 0; k < 3; ++k) add(particles[spin][i][k]);
    }
    sum += hash;
  }
  return is_shared ? world->sum(sum) : sum;
}

const dem::CundallStrack law{.normal_stiffness = 1e6,
                             .tangential_stiffness = 5e5,
                             .restitution = 0.5,
                             .friction_angle = 0.46};

dem::Grains<2> tower() {
  constexpr double R = 0.02;
  auto grains = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 2 * R),
                                 {.radius = R, .density = 2500});
  dem::add_grain(grains, {0.3 * R, 0.8 + 2 * R}, {.radius = R, .density = 2500});
  return grains;
}
#if SILT_SLOW_TESTS
// Spheres of several sizes that fall into a heap.
dem::Grains<3> heap() {
  dem::Grains<3> grains;
  int k = 0;
  for (const auto& x : lattice<3>({{0, 0, 0}, {0.3, 0.3, 0.36}}, 0.06)) {
    const double R = 0.028 - 0.003 * (k++ % 4);
    dem::add_grain(grains, x, {.radius = R, .density = 2500});
    grains[velocity][grains.size() - 1] = Vec<3>(0.1 * (k % 5), 0.07 * (k % 3), -1);
  }
  return grains;
}
#endif

template <bool is_periodic = false, class P>
auto simulation_of(P particles, auto search) {
  constexpr int Dim = P::dimension;
  Vec<Dim> up = Vec<Dim>::Zero();
  up[Dim - 1] = 1;
  // A floor does not fit into a periodic box.
  if constexpr (is_periodic) {
    return Simulation{std::move(particles), search, Forces{dem::Contacts{law}}, Leapfrog{}};
  } else {
    return Simulation{std::move(particles), search,
                      Forces{Gravity<Dim>{Vec<Dim>(-9.81 * up)},
                             dem::Contacts{law, dem::Plane<Dim>{.normal = up}}},
                      Leapfrog{GlobalDamping{.alpha = 0.5}}};
  }
}

template <bool is_periodic = false, class P, class Search>
void expect_same_bits(const P& grains, const Search& search, int steps) {
  auto serial = simulation_of<is_periodic>(grains, search);
  auto shared = simulation_of<is_periodic>(mpi::distribute(grains, *world), search);
  for (int k = 0; k < steps; ++k) {
    // Every grain may move to another process.
    if (k % 37 == 36) shared.particles().repartition();
    serial.step();
    shared.step();
    ASSERT_EQ(world->sum(std::uint64_t{shared.particles().size()}), grains.size());
    if (k % 100 != 0 && k + 1 != steps) continue;
    ASSERT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true)) << k;
    ASSERT_EQ(hash_of(serial.snapshot(), false), hash_of(shared.snapshot(), true)) << k;
    ASSERT_EQ(serial.time(), shared.time());
  }
}
TEST(SharedGrains, HaveTheBitsOfOneProcess) {
  expect_same_bits(tower(), NeighbourList<2>{}, SILT_SLOW_TESTS ? 800 : 200);
#if SILT_SLOW_TESTS
  expect_same_bits(tower(), UniformGrid<2>{}, 800);
  expect_same_bits(heap(), UniformGrid<3>{}, 400);
  expect_same_bits(heap(), NeighbourList<3>{}, 400);
#endif
}

#if SILT_SLOW_TESTS
// Every process has a part of a periodic side.
template <int Dim>
dem::Grains<Dim> gas() {
  Box<Dim> box;
  box.lower = Vec<Dim>::Zero();
  box.upper = Vec<Dim>::Constant(0.5);
  box.periodic.fill(true);
  dem::Grains<Dim> grains;
  grains.set_box(box);
  int k = 0;
  for (const auto& x : lattice<Dim>({box.lower, box.upper}, 0.05)) {
    dem::add_grain(grains, x, {.radius = 0.016 + 0.002 * (k % 4), .density = 2500});
    for (int axis = 0; axis < Dim; ++axis) {
      grains[velocity][grains.size() - 1][axis] = 0.5 * ((k * (7 - 2 * axis)) % 11 - 5);
    }
    ++k;
  }
  return grains;
}
TEST(SharedGrains, HaveTheBitsOfOneProcessInAPeriodicBox) {
  expect_same_bits<true>(gas<2>(), UniformGrid<2>{}, 800);
  expect_same_bits<true>(gas<2>(), NeighbourList<2>{}, 800);
  expect_same_bits<true>(gas<3>(), NeighbourList<3>{}, 300);
}
#endif

// Grains of one size fly into those of another, of other material. Of two processes, each owns one kind,
// whose grains move alike: only those of the halo show that the contacts near them are out of date.
TEST(SharedGrains, OfTwoKindsHaveTheBitsOfOneProcess) {
  const auto meet = [](double small_radius, double gap, const auto& search) {
    dem::Grains<2> grains;
    constexpr double R = 0.02;
    for (int k = 0; k < 16; ++k) {
      const double y = 2.5 * R * (k % 4);
      const double further = 2.5 * R * (k / 4);
      dem::add_grain(grains, {-small_radius - gap / 2 - further, y},
                     {.radius = small_radius, .density = 2500});
      dem::add_grain(grains, {R + gap / 2 + further, y},
                     {.radius = R, .density = 2000, .material = 1});
      grains[velocity][grains.size() - 2] = {1, 0.1};
      grains[velocity][grains.size() - 1] = {-1, 0};
    }
    const auto law_of = [](double stiffness) {
      return dem::CundallStrack{.normal_stiffness = stiffness,
                                .tangential_stiffness = stiffness / 2,
                                .restitution = 0.5,
                                .friction_angle = 0.46};
    };
    const dem::Materials<dem::CundallStrack> materials{law_of(1e5), law_of(1e6)};
    const auto bed_of = [&](auto own) {
      return Simulation{std::move(own), search, dem::Contacts{materials}, Leapfrog{}};
    };
    auto serial = bed_of(grains);
    auto shared = bed_of(mpi::distribute(grains, *world));
    ASSERT_EQ(serial.time_step(), shared.time_step());
    for (int k = 0; k < 120; ++k) {
      serial.step();
      shared.step();
      ASSERT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true))
          << k << " radius " << small_radius << " gap " << gap;
    }
  };
#if SILT_SLOW_TESTS
  const std::vector<double> gaps{0.0004, 0.0024, 0.0028, 0.0032};
  const std::vector<double> radii{0.018, 0.012, 0.005};
#else
  const std::vector<double> gaps{0.0004, 0.0028};
  const std::vector<double> radii{0.005};
#endif
  for (const double gap : gaps) {
    for (const double small_radius : radii) {
      meet(small_radius, gap, NeighbourList<2>{});
#if SILT_SLOW_TESTS
      meet(small_radius, gap, UniformGrid<2>{});
      meet(small_radius, gap, LevelGrid<2>{});
      meet(small_radius, gap, NeighbourList<2, double, LevelGrid<2>>{});
#endif
    }
  }
}

// A control: with contacts that begin anew the bits are others.
TEST(SharedGrains, HaveOtherBitsIfContactsAreForgotten) {
  auto serial = simulation_of(tower(), NeighbourList<2>{});
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  for (int k = 0; k < 300; ++k) {
    serial.step();
    if (k == 200) {
      auto& contacts = shared.interaction().template part<1>();
      using History = std::remove_cvref_t<decltype(contacts.history(shared.particles()))>;
      contacts.set_history(shared.particles(), History{});
    }
    shared.step();
  }
  EXPECT_NE(hash_of(serial.particles(), false), hash_of(shared.particles(), true));
}

TEST(SharedGrains, MayBeChangedBetweenSteps) {
  auto serial = simulation_of(tower(), NeighbourList<2>{});
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  const auto kick = [](auto& simulation) {
    auto& grains = simulation.particles();
    for (Index i = 0; i < grains.size(); ++i) {
      if (grains.id(i) % 3 == 0) grains[velocity][i][0] += 0.2;
    }
  };
  const auto shift = [](auto& simulation) {
    for (auto& x : simulation.particles()[position]) x[1] += 1;
  };
  const auto grow = [](auto& simulation) {
    auto& grains = simulation.particles();
    for (Index i = 0; i < grains.size(); ++i) {
      if (grains.id(i) % 4 == 0) grains[radius][i] *= 1.01;
    }
  };
  const auto remove = [](auto& simulation) {
    auto& grains = simulation.particles();
    grains.remove_if([&](Index i) { return grains.id(i) % 7 == 1; });
  };
  for (int k = 0; k < 200; ++k) {
    if (k == 50) kick(serial), kick(shared);
    if (k == 90) shift(serial), shift(shared);
    if (k == 120) grow(serial), grow(shared);
    if (k == 150) remove(serial), remove(shared);
    serial.step();
    shared.step();
    ASSERT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true)) << k;
  }
}

// Fails in one process, in turn, in some of the steps, in each phase of them in turn.
struct Refuses {
  const int* step;
  int every;

  enum Phase { in_time_step, in_search, in_forces, at_end, at_end_of_all, phases };
  void refuse_in(Phase phase) const {
    const int number = *step / every;
    if (*step % every != 0 || number / world->size() % phases != phase) return;
    if (number % world->size() == world->rank()) fail("refused in step " + std::to_string(*step));
  }

  template <class P>
  typename P::Real reach(const P&) const {
    if (world != nullptr) refuse_in(in_time_step);
    return 0;
  }
  template <class P>
  bool needs_search(const P&) const {
    refuse_in(in_search);
    return false;
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {
    refuse_in(in_forces);
  }
  template <class P>
  void check_step(const P&, const FinishedStep&) const {
    refuse_in(at_end);
  }
  template <class P>
  void check_energy(const P&, const FinishedStep&) const {
    refuse_in(at_end_of_all);
  }
};

TEST(SharedGrains, AreAsBeforeInAllProcessesIfOneRefusesAStep) {
  auto serial = simulation_of(tower(), NeighbourList<2>{});
  int attempt = 2 * world->size() * Refuses::at_end;  // the first one is refused there
  const dem::Plane<2> floor{.normal = {0, 1}};
  Simulation shared{mpi::distribute(tower(), *world), NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, floor}, Refuses{&attempt, 2}},
                    Leapfrog{GlobalDamping{.alpha = 0.5}}};
  int refused = 0;
  for (int k = 0; k < 200; ++k) {
    serial.step();
    bool is_done = false;
    while (!is_done) {
      try {
        shared.step(serial.last_time_step());
        is_done = true;
      } catch (const Error& error) {
        ++refused;
        const std::string message = error.what();
        EXPECT_NE(message.find("refused in step " + std::to_string(attempt)), std::string::npos)
            << message;
        const int by = attempt / 2 % world->size();
        const auto process = "process " + std::to_string(by);
        EXPECT_EQ(message.find(process) != std::string::npos, by != world->rank()) << message;
      }
      ++attempt;
    }
  }
  EXPECT_GE(refused, 199);
  EXPECT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true));
}

TEST(SharedGrains, EndARunInAllProcessesIfAnObserverFailsInOne) {
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  const auto fails = [](const auto& simulation) {
    if (simulation.steps() > 10 && world->rank() == world->size() - 1) fail("the disc is full");
  };
  try {
    shared.run({.until = 0.1, .output_every = 0.01}, fails);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the disc is full"), std::string::npos);
  }
}

// One process fails in an observer of its own while the others are in one that all do together.
TEST(SharedGrains, EndARunInAllProcessesIfAnObserverFailsBeforeAnotherMeasures) {
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  const auto fails = [](const auto&) {
    if (world->is_first()) fail("the disc is full");
  };
  double energy = 0;
  const auto measures = [&](const auto& simulation) {
    energy = kinetic_energy(simulation.snapshot());
  };
  try {
    shared.run({.until = 0.1, .output_every = 0.01}, fails, measures);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the disc is full"), std::string::npos);
  }
  EXPECT_EQ(kinetic_energy(shared.snapshot()), 0);  // the run may go on
}

// f() throws in all processes, with these words.
template <class F>
void expect_error_in_all(const std::string& words, const F& f) {
  try {
    f();
    ADD_FAILURE() << "nothing was thrown; expected: " << words;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
}

TEST(SharedGrains, EndARunInAllProcessesIfAnObserverFailsBeforeAnotherFormsASum) {
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  const auto fails = [](const auto&) {
    if (world->is_first()) fail("the disc is full");
  };
  const auto sums = [](const auto& simulation) {
    world->sum(double(simulation.particles().size()));
  };
  expect_error_in_all("the disc is full", [&] {
    shared.run({.until = 0.1, .output_every = 0.01}, fails, sums);
  });
}

// An exception that all processes caught is not taken for a later one of one process.
TEST(SharedGrains, EndARunInAllProcessesIfAnObserverFailsAfterAllHaveFailed) {
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  const auto catches = [](const auto& simulation) {
    try {
      write_checkpoint("no_such_folder/a.silt", simulation);
    } catch (const Error&) {
    }
  };
  const auto fails = [](const auto&) {
    if (world->is_first()) fail("the disc is full");
  };
  expect_error_in_all("the disc is full", [&] {
    shared.run({.until = 0.1, .output_every = 0.01}, catches, fails);
  });
}

TEST(SharedGrains, RefuseWhatProcessesDoNotGiveAlike) {
  if (world->size() == 1) return;
  const bool is_other = world->rank() == world->size() - 1;
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  shared.step();
  const auto before = hash_of(shared.particles(), true);
  expect_error_in_all("time_step is 1e-05 s in one process and 2e-05 s in another",
                      [&] { shared.step(is_other ? 2e-5 : 1e-5); });
  expect_error_in_all("is 0.1 in one process and 0.2 in another",
                      [&] { shared.run({.until = is_other ? 0.2 : 0.1}); });
  expect_error_in_all("output_every", [&] {
    shared.run({.until = 0.1, .output_every = is_other ? -1.0 : 0.01});
  });
  expect_error_in_all("call step(), run(), snapshot() and measures in all processes", [&] {
    if (is_other) {
      kinetic_energy(shared.particles());
    } else {
      shared.step(1e-5);
    }
  });
  expect_error_in_all("call step(), run(), snapshot() and measures in all processes", [&] {
    if (is_other) {
      shared.snapshot();
    } else {
      shared.step(1e-5);
    }
  });
  EXPECT_EQ(shared.steps(), 1u);
  EXPECT_EQ(hash_of(shared.particles(), true), before);

  auto grains = tower();
  if (is_other) grains[position][3][0] += 1e-9;
  expect_error_in_all("hash of ids and positions", [&] { mpi::distribute(grains, *world); });
  if (is_other) dem::add_grain(grains, {1, 1}, {.radius = 0.02, .density = 2500});
  expect_error_in_all("number of particles", [&] { mpi::distribute(grains, *world); });
  auto boxed = tower();
  boxed.set_box({.lower = {-1, -1}, .upper = {is_other ? 3.0 : 2.0, 3}});
  expect_error_in_all("a side of the box", [&] { mpi::distribute(boxed, *world); });
}

TEST(SharedGrains, UseTheTimeStepOfAll) {
  auto grains = tower();
  grains[mass][17] /= 4;
  auto serial = simulation_of(grains, NeighbourList<2>{});
  auto shared = simulation_of(mpi::distribute(grains, *world), NeighbourList<2>{});
  EXPECT_EQ(serial.time_step(), shared.time_step());
}

TEST(SharedGrains, AreFewerThanProcesses) {
  for (const Index n : {Index(0), Index(1), Index(2)}) {
    dem::Grains<2> grains;
    for (Index i = 0; i < n; ++i) {
      dem::add_grain(grains, {0.0399 * double(i), 0.02}, {.radius = 0.02, .density = 2500});
    }
    auto serial = simulation_of(grains, NeighbourList<2>{});
    auto shared = simulation_of(mpi::distribute(grains, *world), NeighbourList<2>{});
    for (int k = 0; k < 50; ++k) {
      serial.step(1e-5);
      shared.step(1e-5);
    }
    EXPECT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true)) << n;
  }
}

// Of three grains in a row, the one in the middle has the highest id: where space is cut beside it,
// another process owns the first grain of one of its contacts.
TEST(SharedGrains, RefuseTheStepsThatOneProcessFindsUnstable) {
  constexpr double R = 0.02;
  dem::Grains<2> grains;
  for (const double k : {-1, 1, 0}) {
    dem::add_grain(grains, {1.99 * R * k, 1}, {.radius = R, .density = 2500});
  }
  const auto is_refused = [](auto simulation, double dt) {
    try {
      simulation.step(dt);
      return false;
    } catch (const Error& error) {
      return error.stable_time_step().has_value();
    }
  };
  const auto serial = simulation_of(grains, NeighbourList<2>{});
  double stable = 1e-7, unstable = 1e-3;
  for (int k = 0; k < 30; ++k) {
    const double dt = (stable + unstable) / 2;
    (is_refused(serial, dt) ? unstable : stable) = dt;
  }
  const auto shared = simulation_of(mpi::distribute(grains, *world), NeighbourList<2>{});
  EXPECT_FALSE(is_refused(shared, 0.99 * stable)) << stable;
  EXPECT_TRUE(is_refused(shared, 1.01 * unstable)) << unstable;
}

struct NoInteraction {};

// Every process sees every pair of which it owns a grain, once.
template <int Dim>
void expect_all_pairs(const std::vector<Vec<Dim>>& points, const Box<Dim>& box, double radius) {
  Particles<Dim, double> all;
  all.set_box(box);
  for (const auto& x : points) all.add(x);
  auto shared = mpi::distribute(all, *world);
  NoInteraction none;
  // Also after all have moved by less than the halo allows for.
  for (const double moved : {std::numeric_limits<double>::infinity(), 0.2 * radius}) {
    shared.together([] { return Largest{}; });
    shared.update_halo(none, radius, moved);
    UniformGrid<Dim> search;
    search.set_radius(radius);
    search.update(shared);
    const NearestImage<Dim, double> image(box);
    for (Index i = 0; i < shared.size(); ++i) {
      std::vector<Id> found, expected;
      search.for_each_neighbour(i, [&](Index j, const auto&, auto) {
        found.push_back(shared.id(shared.owner(j)));
      });
      for (Index j = 0; j < all.size(); ++j) {
        if (all.id(j) == shared.id(i)) continue;
        const Vec<Dim> r = image(Vec<Dim>(all[position][j] - std::as_const(shared)[position][i]));
        if (r.norm() < radius) expected.push_back(all.id(j));
      }
      std::ranges::sort(found);
      std::ranges::sort(expected);
      ASSERT_EQ(found, expected) << i;
    }
    EXPECT_EQ(shared.halos_found(), 1u);
    // The same move everywhere, by an own rule for each.
    std::vector<Vec<Dim>> now;
    for (Index i = 0; i < all.size(); ++i) {
      const double angle = double(all.id(i) * 7 % 13);
      Vec<Dim> by = Vec<Dim>::Zero();
      by[0] = 0.19 * radius * std::cos(angle);
      by[1] = 0.19 * radius * std::sin(angle);
      now.push_back(all[position][i] + by);
    }
    for (Index i = 0; i < all.size(); ++i) all[position][i] = now[i];
    for (Index i = 0; i < shared.size(); ++i) {
      shared[position][i] = now[all.index_of(shared.id(i))];
    }
  }
}
TEST(SharedGrains, SeeAllPairsOnce) {
  std::mt19937 random(5);
  const auto in = [&](double length) {
    return std::uniform_real_distribution<double>(0, length)(random);
  };
  for (const bool periodic : {false, true}) {
    Box<2> plane;
    Box<3> space;
    if (periodic) {
      plane = {.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, true}};
      space = {.lower = {0, 0, 0}, .upper = {1, 1, 1}, .periodic = {true, false, true}};
    }
    std::vector<Vec<2>> even, cluster, line, few;
    std::vector<Vec<3>> in_space;
    for (int k = 0; k < 300; ++k) {
      even.push_back({in(1), in(1)});
      cluster.push_back(k < 290 ? Vec<2>(0.5 + in(0.001), 0.5 + in(0.001)) : Vec<2>(in(1), in(1)));
      line.push_back({in(1), 0.5});
      in_space.push_back({in(1), in(1), in(1)});
    }
    for (int k = 0; k < 2; ++k) few.push_back({in(1), in(1)});
    expect_all_pairs<2>(even, plane, 0.1);
    expect_all_pairs<2>(even, plane, 0.3);  // thicker than what a process owns
    expect_all_pairs<2>(cluster, plane, 0.05);
    expect_all_pairs<2>(line, plane, 0.05);
    expect_all_pairs<2>(few, plane, 0.3);
    expect_all_pairs<3>(in_space, space, 0.2);
  }
}

// A control of that test: what it finds if the halo is not as deep as the search radius.
TEST(SharedGrains, MissPairsIfTheHaloIsTooThin) {
  Particles<2, double> all;
  for (const auto& x : lattice<2>({{0, 0}, {1, 1}}, 0.05)) all.add(x);
  auto shared = mpi::distribute(all, *world);
  NoInteraction none;
  shared.together([] { return Largest{}; });
  shared.update_halo(none, 0.1, std::numeric_limits<double>::infinity());
  const double radius = 1.5 * shared.depth_of_halo();
  UniformGrid<2> search;
  search.set_radius(radius);
  search.update(shared);
  std::uint64_t missed = 0;
  for (Index i = 0; i < shared.size(); ++i) {
    for (Index j = 0; j < all.size(); ++j) {
      const auto r = all[position][j] - std::as_const(shared)[position][i];
      missed += all.id(j) != shared.id(i) && r.norm() < radius;
    }
    search.for_each_neighbour(i, [&](Index, const auto&, auto) { --missed; });
  }
  EXPECT_EQ(world->sum(missed) > 0, world->size() > 1);
}

#if SILT_SLOW_TESTS
// A spring whose force has an error of units.
struct WrongSpring {
  template <class C>
  dem::NormalForce<C> normal_force(const C& contact) const {
    return {.spring = typename C::Real(1e8) * contact.overlap};
  }
  template <class C>
  double elastic_energy(const C& contact) const {
    return 1e4 * double(contact.overlap) * double(contact.overlap) / 2;
  }
  template <class C>
  dem::Stiffness stiffness(const C&) const {
    return {.normal = 1e4};
  }
};

// Of all processes together: where space is cut within a pair, no process has both grains.
TEST(SharedGrains, AreRefusedTheEnergyThatNoSpringHolds) {
  constexpr double R = 0.01;
  dem::Grains<3> grains;
  for (int k = 0; k < 3; ++k) {
    dem::add_grain(grains, {0.1 * k, 0, 0}, {.radius = R, .density = 2500});
    dem::add_grain(grains, {0.1 * k + 2 * R + 1e-5, 0, 0}, {.radius = R, .density = 2500});
    grains[velocity][grains.size() - 1] = {-0.1, 0, 0};
  }
  const auto text_of_failure = [](auto simulation) {
    try {
      for (int k = 0; k < 10; ++k) simulation.step(4e-5);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const dem::Contacts contacts{dem::Law{WrongSpring{}}};
  const auto serial =
      text_of_failure(Simulation{grains, UniformGrid<3>{}, contacts, Leapfrog{}});
  const auto shared = text_of_failure(
      Simulation{mpi::distribute(grains, *world), UniformGrid<3>{}, contacts, Leapfrog{}});
  const std::string reason = "J in the springs of contacts";
  const auto numbers = [](const std::string& text) {
    const auto begin = text.find("the kinetic energy rose");
    return text.substr(begin, text.find("; of all grains") - begin);
  };
  ASSERT_NE(serial.find(reason), std::string::npos) << serial;
  ASSERT_NE(shared.find(reason), std::string::npos) << shared;
  EXPECT_EQ(numbers(serial), numbers(shared));
}

// Some leave the box while a process refuses the step.
TEST(SharedGrains, ComeBackIfTheStepInWhichTheyEscapedIsRefused) {
  const auto with_box = [] {
    auto grains = tower();
    Box<2> box;
    box.lower = {-0.1, -1};
    box.upper = {0.1, 2};
    box.on_escape = OnEscape::remove;
    grains.set_box(box);
    for (Index i = 0; i < grains.size(); ++i) {
      if (grains.id(i) % 5 == 0) grains[velocity][i] = {grains.id(i) % 2 == 0 ? 4.0 : -4.0, 3};
    }
    return grains;
  };
  auto serial = simulation_of(with_box(), NeighbourList<2>{});
  int attempt = 1;
  Simulation shared{mpi::distribute(with_box(), *world), NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}},
                           dem::Contacts{law, dem::Plane<2>{.normal = {0, 1}}},
                           Refuses{&attempt, 2}},
                    Leapfrog{GlobalDamping{.alpha = 0.5}}};
  for (int k = 0; k < 300; ++k) {
    serial.step();
    for (bool is_done = false; !is_done; ++attempt) {
      try {
        shared.step(serial.last_time_step());
        is_done = true;
      } catch (const Error&) {
      }
    }
    ASSERT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true)) << k;
  }
  EXPECT_GT(serial.particles_lost(), 5u);
  EXPECT_EQ(serial.particles_lost(), shared.particles_lost());
}
#endif

// The first n processes; others get nothing.
std::unique_ptr<const mpi::World> first_processes(int n) {
  MPI_Comm some = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, world->rank() < n ? 0 : MPI_UNDEFINED, world->rank(), &some);
  if (some == MPI_COMM_NULL) return nullptr;
  auto first = std::make_unique<const mpi::World>(some);
  MPI_Comm_free(&some);
  return first;
}

TEST(SharedGrains, ContinueOnAnyNumberOfProcesses) {
  const std::filesystem::path file = "shared_grains_" + std::to_string(world->size()) + ".silt";
  const auto run = [](auto& simulation, Index steps) {
    while (simulation.steps() < steps) simulation.step();
  };
  const auto check = [&](const auto& grains, const auto& search) {
    auto serial = simulation_of(grains, search);
    Index steps = 0;
    for (const int processes : {4, 0, 2, 3, 1, 0, 4}) {
      steps += 60;
      // 0: a simulation of particles that are not shared.
      const auto some = first_processes(processes);
      if (processes == 0 && world->is_first()) {
        auto one = simulation_of(grains, search);
        read_checkpoint(file, one);
        run(one, steps);
        write_checkpoint(file, one);
      } else if (some != nullptr) {
        auto shared = simulation_of(mpi::distribute(grains, *some), search);
        if (steps > 60) read_checkpoint(file, shared);
        run(shared, steps);
        write_checkpoint(file, shared);
      }
      world->sum(0.0);  // until the file is there
      run(serial, steps);
      auto read = simulation_of(grains, search);
      read_checkpoint(file, read);
      ASSERT_EQ(hash_of(serial.particles(), false), hash_of(read.particles(), false)) << steps;
      ASSERT_EQ(serial.time(), read.time());
      world->sum(0.0);  // until all have read it
    }
  };
  check(tower(), NeighbourList<2>{});
#if SILT_SLOW_TESTS
  check(heap(), NeighbourList<3>{});
#endif
  if (world->is_first()) std::filesystem::remove(file);
}

TEST(SharedGrains, ThrowInAllProcessesIfACheckpointCannotBeWrittenOrRead) {
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  for (int k = 0; k < 10; ++k) shared.step();
  const auto before = hash_of(shared.particles(), true);
  const auto expect_error = [](const auto& f) {
    try {
      f();
      ADD_FAILURE();
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("no_such_folder"), std::string::npos) << message;
    }
  };
  expect_error([&] { write_checkpoint("no_such_folder/a.silt", shared); });
  // In one process only.
  const bool fails = world->rank() == world->size() - 1;
  const std::filesystem::path file = "shared_grains_" + std::to_string(world->size()) + ".silt";
  write_checkpoint(file, shared);
  expect_error([&] { read_checkpoint(fails ? "no_such_folder/a.silt" : file, shared); });
  EXPECT_EQ(hash_of(shared.particles(), true), before);
  auto serial = simulation_of(tower(), NeighbourList<2>{});
  for (int k = 0; k < 20; ++k) serial.step();
  for (int k = 0; k < 10; ++k) shared.step();
  EXPECT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true));
  world->sum(0.0);
  if (world->is_first()) std::filesystem::remove(file);
}

// While it exists, no file of this process gets longer: as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(bool is_here) {
    if (!is_here) return;
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit few{100, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &few);
    is_here_ = true;
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    if (!is_here_) return;
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  bool is_here_ = false;
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

TEST(SharedGrains, ThrowInAllProcessesIfTheDiskOfOneIsFull) {
  const std::string name = "full_disk_" + std::to_string(world->size());
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  for (int k = 0; k < 10; ++k) shared.step();
  const auto before = hash_of(shared.particles(), true);
  write_checkpoint(name + ".silt", shared);
  const auto expect_error = [](int process, const auto& f) {
    const FullDisk full(world->rank() == process);
    try {
      f();
      ADD_FAILURE();
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    }
  };
  expect_error(0, [&] { write_checkpoint(name + ".silt", shared); });
  EXPECT_EQ(hash_of(shared.particles(), true), before);
  world->sum(0.0);
  // The checkpoint before is whole.
  auto read = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  read_checkpoint(name + ".silt", read);
  EXPECT_EQ(hash_of(read.particles(), true), before);
  for (int process = 0; process < world->size(); ++process) {
    expect_error(process, [&] {
      read.run({.until = read.time() + 0.002, .output_every = 0.001}, VtkSeries{name});
    });
  }
  world->sum(0.0);
  if (!world->is_first()) return;
  std::filesystem::remove(name + ".silt");
  std::filesystem::remove_all(name);
  std::filesystem::remove(name + ".pvd");
}

TEST(SharedGrains, WriteCheckpointsDuringARun) {
  const std::filesystem::path file = "shared_grains_" + std::to_string(world->size()) + ".silt";
  auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
  Checkpoints checkpoints(file, {.every = 1e-3});
  shared.run({.until = 0.01}, checkpoints);
  EXPECT_TRUE(checkpoints.exist());
  checkpoints.write(shared);
  auto serial = simulation_of(tower(), NeighbourList<2>{});
  read_checkpoint(file, serial);
  EXPECT_EQ(hash_of(serial.particles(), false), hash_of(shared.particles(), true));
  world->sum(0.0);
  if (world->is_first()) std::filesystem::remove(file);
}

TEST(SharedGrains, WriteFramesThatHaveEachOnce) {
  const std::string folder = "shared_grains_" + std::to_string(world->size());
  {
    auto shared = simulation_of(mpi::distribute(tower(), *world), NeighbourList<2>{});
    shared.run({.until = 0.01, .output_every = 0.005}, VtkSeries{folder});
  }
  world->sum(0.0);  // until all files are there
  if (world->is_first() && world->size() > 1) {
    const std::string list = file::read("test", folder + ".pvd");
    EXPECT_NE(list.find("_000002.pvtu"), std::string::npos) << list;
    const std::string command = "python3 " SILT_TESTS_DIR "/io/read_frame.py vtk " + folder + "/" +
                                folder + "_000002.pvtu";
    std::FILE* const pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::array<char, 64> line{};
    const bool is_read = std::fgets(line.data(), int(line.size()), pipe) != nullptr;
    const int status = pclose(pipe);
    if (WEXITSTATUS(status) != 77 && WEXITSTATUS(status) != 127) {
      EXPECT_TRUE(is_read);
      EXPECT_EQ(std::string(line.data()), "101 101\n");
    }
    // Continued by one process.
    auto serial = simulation_of(tower(), NeighbourList<2>{});
    VtkSeries frames{folder};
    serial.run({.until = 0.006, .output_every = 0.005}, frames);
    const std::string again = file::read("test", folder + ".pvd");
    EXPECT_NE(again.find("_000001.vtu"), std::string::npos) << again;
    EXPECT_EQ(again.find(".pvtu"), std::string::npos) << again;
  }
  if (!world->is_first()) return;
  std::filesystem::remove_all(folder);
  std::filesystem::remove(folder + ".pvd");
}

}  // namespace
}  // namespace silt::test::shared_grains_test
