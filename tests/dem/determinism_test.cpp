// SPDX-License-Identifier: MIT
// Results are bitwise independent of the threads, the search, the order in memory and the units.
// Only with --all: every kind of grains with every search; trust/threads_test.cpp has one of each.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace silt::test::determinism_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e6,
                             .tangential_stiffness = 5e5,
                             .restitution = 0.6,
                             .friction_angle = 0.5,
                             .cohesion = 0.1};

// State by id, independent of the order in memory.
template <class P>
Bytes by_id(P grains) {
  std::vector<Index> order(grains.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return grains.id(a) < grains.id(b); });
  grains.reorder(order);
  return state_of(grains);
}

template <class P>
auto contacts() {
  return dem::Contacts{law, dem::Plane<P::dimension, typename P::Real>{}};
}
template <class P, class C>
auto with_gravity(const C& contacts) {
  typename P::Vec g = P::Vec::Zero();
  g[P::dimension - 1] = -10;
  return Forces{Gravity{g}, contacts};
}

// One type for all tests with this search, because each takes long to compile.
template <class S, class P>
auto simulation(P grains) {
  return Simulation{std::move(grains), S{}, with_gravity<P>(contacts<P>()),
                    Leapfrog{GlobalDamping{.alpha = 0.2}}};
}

enum class Threads { as_they_are, changing };

template <class S, class P>
P after_steps(P grains, int steps, Threads number = Threads::as_they_are) {
  auto sim = simulation<S>(std::move(grains));
  for (int k = 0; k < steps; ++k) {
    if (number == Threads::changing) use_threads(1 + 3 * k % 4);
    sim.step(2e-5);
  }
  EXPECT_GE(sim.interaction().template part<1>().size(), 10u);
  EXPECT_TRUE(is_finite(sim.interaction().template part<1>().elastic_energy(sim.particles())));
  return sim.snapshot();
}

template <class P>
class Determinism : public ::testing::Test {};
using Kinds = ::testing::Types<dem::Grains<2, double>, dem::Grains<2, float>,
                               dem::Grains<3, double>, dem::Grains<3, float>>;
TYPED_TEST_SUITE(Determinism, Kinds);

TYPED_TEST(Determinism, GivesTheSameBitsForOneToFourThreads) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  const Index along = dim == 2 ? 60 : 15;
  auto start = crowd<dim, Real>(along, 5);
  ASSERT_GT(start.size(), 3000u);
  for (const bool periodic : {false, true}) {
    auto box = cube<dim, Real>(-1, 2);
    box.lower[0] = 0;
    box.upper[0] = Real(along) * Real(0.0205);
    box.periodic[0] = periodic;
    if (periodic) start.set_box(box);
    const auto run = [&] { return state_of(after_steps<UniformGrid<dim, Real>>(start, 25)); };
    const Bytes alone = with_threads(1, run);
    for (const int number : {2, 3, 4}) {
      EXPECT_EQ(with_threads(number, run), alone) << number << " threads";
    }
    EXPECT_EQ(with_threads(1,
                           [&] {
                             return state_of(
                                 after_steps<UniformGrid<dim, Real>>(start, 25, Threads::changing));
                           }),
              alone)
        << "another number in every step";
  }
}

TYPED_TEST(Determinism, GivesTheSameBitsForEverySearchAndOrderInMemory) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  for (const bool periodic : {false, true}) {
    // More than a chunk of grains: pairs across a side then belong to another chunk than the one
    // that found them.
    const Index along = periodic ? (dim == 2 ? 36 : 11) : (dim == 2 ? 12 : 5);
    auto start = crowd<dim, Real>(along, 6);
    if (periodic) {
      ASSERT_GT(start.size(), chunk_size);
      auto box = cube<dim, Real>(0, Real(along) * Real(0.0205));
      box.periodic[0] = true;
      for (int k = 1; k < dim; ++k) {
        box.lower[k] = -1;
        box.upper[k] = 1;
      }
      start.set_box(box);
    }
    const Bytes right = by_id(after_steps<BruteForce<dim, Real>>(start, 100));
    EXPECT_EQ(by_id(after_steps<UniformGrid<dim, Real>>(start, 100)), right);
    EXPECT_EQ(by_id(after_steps<NeighbourList<dim, Real>>(start, 100)), right);

    auto shuffled = start;
    std::vector<Index> order(start.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    shuffled.reorder(order);
    EXPECT_EQ(by_id(after_steps<UniformGrid<dim, Real>>(shuffled, 100)), right);
  }
}

TYPED_TEST(Determinism, KeepsContactHistoryWhenGrainsAreReorderedDuringARun) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  const auto run = [&](bool reorder) {
    auto sim = simulation<UniformGrid<dim, Real>>(crowd<dim, Real>(dim == 2 ? 10 : 5, 7));
    for (int k = 0; k < 60; ++k) {
      if (reorder && k % 10 == 5) sim.particles().reorder(sim.search().order());
      sim.step(2e-5);
    }
    return by_id(sim.particles());
  };
  EXPECT_EQ(run(true), run(false));
}

TYPED_TEST(Determinism, ContinuesWithAHistoryThatWasReadAndSet) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  const auto run = [&](bool interrupt) {
    auto sim = simulation<NeighbourList<dim, Real>>(crowd<dim, Real>(dim == 2 ? 10 : 5, 7));
    for (int k = 0; k < 60; ++k) {
      if (interrupt && k % 10 == 5) {
        const auto& known = sim.interaction().template part<1>();
        const auto history = known.history(sim.particles());
        EXPECT_EQ(history.size(), known.size());
        auto others = for_particles(contacts<TypeParam>(), sim.particles());
        others.set_history(sim.particles(), history);
        sim.interaction() = with_gravity<TypeParam>(others);
      }
      sim.step(2e-5);
    }
    return by_id(sim.particles());
  };
  EXPECT_EQ(run(true), run(false));
}

// --- units ---------------------------------------------------------------------------------------

// Powers of four, so that square roots also change only exponents.
struct Units {
  double length;
  double mass;
  double time;
};

template <int Dim, class Law>
dem::Grains<Dim> in_units(const Units& u, double beta) {
  auto grains = crowd<Dim, double>(Dim == 2 ? 8 : 4, 8);
  for (Index i = 0; i < grains.size(); ++i) {
    grains[position][i] *= u.length;
    grains[velocity][i] *= u.length / u.time;
    grains[spin][i] *= 1 / u.time;
    grains[mass][i] *= u.mass;
    grains[radius][i] *= u.length;
    grains[inertia][i] *= u.mass * u.length * u.length;
  }
  const double stiffness = u.mass / (u.time * u.time);
  const double newton = stiffness * u.length;
  Law scaled{.normal_stiffness = 1e6 * stiffness,
             .tangential_stiffness = 5e5 * stiffness,
             .friction_angle = 0.5,
             .cohesion = 0.1 * newton};
  if (beta > 0) {
    scaled.beta = beta * u.time;
  } else {
    scaled.restitution = 0.6;
  }
  Vec<Dim> g = Vec<Dim>::Zero();
  g[Dim - 1] = -9.81 * u.length / (u.time * u.time);
  Simulation sim{grains, NeighbourList<Dim>{},
                 Forces{Gravity<Dim>{g}, dem::Contacts{scaled, dem::Plane<Dim>{}}},
                 Leapfrog{GlobalDamping{.alpha = 0.3 / u.time}}};
  for (int k = 0; k < 150; ++k) sim.step();
  auto out = sim.snapshot();
  for (Index i = 0; i < out.size(); ++i) {
    out[position][i] /= u.length;
    out[velocity][i] /= u.length / u.time;
    out[spin][i] *= u.time;
    out[mass][i] /= u.mass;
    out[radius][i] /= u.length;
    out[inertia][i] /= u.mass * u.length * u.length;
  }
  return out;
}

template <int Dim, class Law>
void expect_no_units(double beta) {
  const Bytes si = state_of(in_units<Dim, Law>({1, 1, 1}, beta));
  EXPECT_EQ(state_of(in_units<Dim, Law>({4, 1, 1}, beta)), si);
  EXPECT_EQ(state_of(in_units<Dim, Law>({1, 0x1p-20, 1}, beta)), si);
  EXPECT_EQ(state_of(in_units<Dim, Law>({1, 1, 0x1p-12}, beta)), si);
  EXPECT_EQ(state_of(in_units<Dim, Law>({0x1p-10, 0x1p30, 0x1p8}, beta)), si);
}

TEST(Units, DoNotChangeASingleBit) {
  expect_no_units<2, dem::CundallStrack>(0);
  expect_no_units<3, dem::CundallStrack>(0);
  expect_no_units<2, dem::CundallStrack>(1e-5);
  expect_no_units<3, dem::CundallStrackIncremental>(0);
}

template <class Real>
Bytes in_a_periodic_box(double skin_fraction) {
  using Vec3 = Vec<3, Real>;
  Box<3, Real> box{.lower = Vec3(0, 0, -1), .upper = Vec3(Real(0.5), Real(0.5), 9)};
  box.periodic = {true, true, false};
  dem::Grains<3, Real> grains(box);
  std::mt19937 random(5);
  const auto uniform = [&] { return double(random()) / double(std::mt19937::max()); };
  for (const auto& x : lattice<3, Real>({Vec3::Zero(), Vec3::Constant(Real(0.49))}, Real(0.05))) {
    const Index i = dem::add_grain(grains, Vec3(x + Vec3::Constant(Real(0.025))),
                                   {.radius = 0.021 + 0.004 * uniform(), .density = 2500});
    for (int k = 0; k < 3; ++k) grains[velocity][i][k] = Real(16 * uniform() - 8);
  }
  Simulation sim{grains, NeighbourList<3, Real>{{.skin_fraction = Real(skin_fraction)}},
                 with_gravity<dem::Grains<3, Real>>(contacts<dem::Grains<3, Real>>()), Leapfrog{}};
  Index crossings = 0;
  for (int k = 0; k < 1500; ++k) {
    const auto before = sim.particles();
    sim.step(2e-5);
    for (Index i = 0; i < before.size(); ++i) {
      const Index now = sim.particles().index_of(before.id(i));
      crossings +=
          std::abs(before[position][i][0] - std::as_const(sim).particles()[position][now][0]) > 0.2;
    }
  }
  EXPECT_GT(crossings, 20u);
  EXPECT_GT(sim.interaction().template part<1>().size(), 20u);
  return by_id(sim.particles());
}

TEST(GrainsInAPeriodicBox, HaveTheSameBitsForAnySkin) {
  EXPECT_EQ(in_a_periodic_box<double>(0.05), in_a_periodic_box<double>(0.3));
  EXPECT_EQ(in_a_periodic_box<float>(0.05), in_a_periodic_box<float>(0.3));
}

}  // namespace
}  // namespace silt::test::determinism_test
