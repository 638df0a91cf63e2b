// SPDX-License-Identifier: MIT
// That grains which are added to a list of contacts get the same contacts and forces as if the list
// were rebuilt, also while they hit others, walls and each other, in copies, after steps that failed,
// and after a restart. No other test adds grains near others without a rebuild.
#include <silt/dem.hpp>
#include <silt/dem/wall/walls.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace silt::test::added_grains_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.5,
                             .friction_angle = 0.4};
constexpr double D = 0.02;  // diameter of most grains [m]

// Some layers of grains on a floor that vibrates, between the periodic sides of a box.
template <int Dim>
auto bed(Index layers = 3) {
  Vec<Dim> upper = Vec<Dim>::Constant(12.4 * D);
  upper[Dim - 1] = double(layers) * D;
  Box<Dim> box;
  box.lower[0] = 0;
  box.upper[0] = 12.4 * D;
  box.periodic[0] = true;
  auto grains = dem::make_grains(lattice<Dim>({Vec<Dim>::Zero(), upper}, 1.01 * D),
                                 {.radius = D / 2, .density = 2500});
  grains.set_box(box);
  dem::Plane<Dim> floor;
  floor.normal = Vec<Dim>::Unit(Dim - 1);
  const dem::Moving shaken{floor, dem::Vibration<Dim>{.amplitude = 1e-4 * Vec<Dim>::Unit(Dim - 1),
                                                      .frequency = 30}};
  return Simulation{grains, NeighbourList<Dim>{},
                    Forces{Gravity<Dim>{-9.81 * Vec<Dim>::Unit(Dim - 1)}, dem::Contacts{law, shaken}},
                    Leapfrog{}};
}

// Adds up to two grains where no other is, of two sizes, some just above the others and some beside
// the periodic side; they fall fast.
template <class Sim>
void rain(Sim& simulation, Index step) {
  using P = std::remove_cvref_t<decltype(simulation.particles())>;
  constexpr int Dim = P::dimension;
  P& grains = simulation.particles();
  Random random{.seed = 5, .id = step};
  for (int k = 0; k < 3; ++k) {
    Vec<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = 12.4 * D * random.uniform();
    if (k == 1) x[0] = 1e-4;
    const double R = k == 2 ? 0.3 * D : D / 2;
    const NearestImage<Dim, double> image(grains.box());
    const auto is_near = [&](Index i) {
      return image(Vec<Dim>(std::as_const(grains)[position][i] - x)).norm() <
             std::as_const(grains)[radius][i] + R;
    };
    if (x[Dim - 1] < R || first_where(grains.size(), is_near) != no_index) continue;
    const Index i = dem::add_grain(grains, x, {.radius = R, .density = 2500});
    grains[velocity][i] = -1.5 * Vec<Dim>::Unit(Dim - 1);
  }
}
// Whatever was found for these grains is found again.
template <class Sim>
void forget(Sim& simulation) {
  const auto box = simulation.particles().box();
  simulation.particles().set_box(box);
}

// The state by id, and all contacts by the ids of the grains with their forces.
template <class Sim>
auto state_of(const Sim& simulation) {
  const auto& p = simulation.particles();
  std::vector<std::tuple<Id, Id, std::vector<double>>> all;
  const auto numbers = [](const auto& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
  for (Index i = 0; i < p.size(); ++i) {
    all.push_back({p.id(i), 0, numbers(Eigen::VectorXd(p[position][i]))});
    all.push_back({p.id(i), 1, numbers(Eigen::VectorXd(p[velocity][i]))});
  }
  simulation.interaction().template part<1>().for_each_contact(
      p, [&](Index i, Index j, const auto&, const auto& force) {
        all.push_back({p.id(i), j == no_index ? wall_id(0) : 2 + p.id(j),
                       numbers(Eigen::VectorXd(force))});
      });
  std::ranges::sort(all);
  return all;
}

template <int Dim>
void expect_same_as_with_rebuilds(bool observes) {
  auto simulation = bed<Dim>();
  auto rebuilt = bed<Dim>();
  const double dt = simulation.time_step();
  const auto before = simulation.search().rebuilds();
  const auto before_rebuilt = rebuilt.search().rebuilds();
  Index contacts = 0;
  for (Index step = 0; step < 400; ++step) {
    if (step % 3 == 0) {
      rain(simulation, step);
      rain(rebuilt, step);
      forget(rebuilt);
    }
    with_threads(1 + static_cast<int>(step % 3), [&] { simulation.step(dt); });
    rebuilt.step(dt);
    if (observes || step % 50 == 49) {
      ASSERT_EQ(state_of(simulation), state_of(rebuilt)) << "step " << step;
    }
    contacts = std::max(contacts, simulation.interaction().template part<1>().size());
  }
  EXPECT_EQ(simulation.particles().size(), rebuilt.particles().size());
  EXPECT_GT(simulation.particles().size(), bed<Dim>().particles().size() + 50);
  EXPECT_GT(contacts, 20u);
  EXPECT_LT(2 * (simulation.search().rebuilds() - before), rebuilt.search().rebuilds() - before_rebuilt);
}

TEST(AddedGrains, HaveTheContactsAndForcesOfARebuiltListIn2D) { expect_same_as_with_rebuilds<2>(true); }
TEST(AddedGrains, HaveTheContactsAndForcesOfARebuiltListIn3D) { expect_same_as_with_rebuilds<3>(true); }
TEST(AddedGrains, HaveThemWithoutObservers) { expect_same_as_with_rebuilds<2>(false); }

// The list of grains that fly together is valid only relative to their mean displacement.
TEST(AddedGrains, TouchGrainsThatHaveFlownFar) {
  auto grains = dem::make_grains(lattice<2>({{0, 0}, {5 * D, 5 * D}}, 1.01 * D),
                                 {.radius = D / 2, .density = 2500});
  for (auto& v : grains[velocity]) v = Vec<2>(1, 0);
  Simulation simulation{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  for (int step = 0; step < 300; ++step) simulation.step(1e-4);
  auto& now = simulation.particles();
  const Vec<2> x = std::as_const(now)[position][now.index_of(0)] - Vec<2>(0.99 * D, 0);
  dem::add_grain(now, x, {.radius = D / 2, .density = 2500});
  simulation.step(1e-4);
  EXPECT_EQ(simulation.interaction().size(), 1u);
}

TEST(AddedGrains, AreThereAfterAStepThatFailed) {
  auto simulation = bed<2>();
  auto undisturbed = bed<2>();
  const double dt = simulation.time_step();
  for (Index step = 0; step < 200; ++step) {
    const auto last = step == 0 ? decltype(state_of(simulation)){} : state_of(simulation);
    rain(simulation, step);
    rain(undisturbed, step);
    EXPECT_THROW(simulation.step(1e3), Error);
    if (step > 0) {
      auto now = state_of(simulation);
      // But for the added grains, it is that of the last step, with its contacts.
      std::erase_if(now, [&](const auto& each) { return !std::ranges::binary_search(last, each); });
      ASSERT_EQ(now, last);
    }
    simulation.step(dt);
    undisturbed.step(dt);
    ASSERT_EQ(state_of(simulation), state_of(undisturbed)) << "step " << step;
  }
}

TEST(AddedGrains, AreNotSharedWithCopies) {
  auto simulation = bed<2>();
  const double dt = simulation.time_step();
  for (Index step = 0; step < 50; ++step) {
    rain(simulation, step);
    simulation.step(dt);
  }
  auto copy = simulation;
  auto other = simulation;
  forget(other);
  for (Index step = 50; step < 120; ++step) {
    rain(simulation, step);  // not in the copy
    rain(copy, 1000 + step);
    rain(other, 1000 + step);
    simulation.step(dt);
    copy.step(dt);
    other.step(dt);
    ASSERT_EQ(state_of(copy), state_of(other)) << "step " << step;
  }
  // A container with other grains in the same rows.
  simulation.particles() = copy.particles();
  forget(copy);
  simulation.step(dt);
  copy.step(dt);
  EXPECT_EQ(simulation.particles()[position][0], copy.particles()[position][0]);
}

// More grains at once than are added to a list, larger ones than all others, and invalid ones.
TEST(AddedGrains, AreRefusedOrFoundByARebuild) {
  auto simulation = bed<2>();
  const double dt = simulation.time_step();
  simulation.step(dt);
  auto& grains = simulation.particles();
  auto rebuilds = [&, last = simulation.search().rebuilds()]() mutable {
    const auto before = std::exchange(last, simulation.search().rebuilds());
    return last - before;
  };
  for (int k = 0; k < 100; ++k) {
    dem::add_grain(grains, {(k % 10 + 1) * 0.02, 0.1 + 0.02 * (k / 10)}, {.radius = 0.001, .density = 2500});
  }
  simulation.step(dt);
  EXPECT_EQ(rebuilds(), 1u);
  dem::add_grain(grains, {0.1, 2.5}, {.radius = D, .density = 2500});
  simulation.step(dt);
  EXPECT_EQ(rebuilds(), 1u) << "larger than the others";
  dem::add_grain(grains, {0.1, 3}, {.radius = D / 2, .density = 2500});
  simulation.step(dt);
  EXPECT_EQ(rebuilds(), 0u);
  const Index i = grains.add({0.1, 3.1}, Initial{radius, D / 2}, Initial{mass, 1.0});
  EXPECT_TRUE(refuses([&] { simulation.step(dt); }, {"inertia = 0"}));
  grains.remove(grains.id(i));
  dem::add_grain(grains, {0.1, 4}, {.radius = D / 2, .density = 2500, .material = 1});
  EXPECT_TRUE(refuses([&] { simulation.step(dt); }, {"material"}));
}

// Checkpoints are written when grains were added, but their contacts not yet found.
struct RainAfterSteps {
  template <class Sim>
  void after_step(Sim& simulation) {
    rain(simulation, simulation.steps());
  }
  void transfer(auto&) {}
};

TEST(AddedGrains, AreTheSameAfterARestart) {
  expect_the_same_bits_after_restarts(
      path_of_test(), {.steps = 150, .number = 25}, [] { return RunWith{bed<2>(), RainAfterSteps{}}; },
      [](const auto& run) {
        const auto& contacts = run.simulation.interaction().template part<1>();
        return std::vector<double>{contacts.elastic_energy(run.simulation.particles()),
                                   double(run.simulation.search().rebuilds())};
      });
}

}  // namespace
}  // namespace silt::test::added_grains_test
