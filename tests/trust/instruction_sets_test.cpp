// SPDX-License-Identifier: MIT
// The same bits with every instruction set of one program, also in single precision, of a law one
// by one, and after a step that failed; portability.hashes_* compare two runs only. Compiled
// without SILT_NO_DISPATCH, unlike the other unit tests.
#include <silt/core/instruction_set.hpp>
#include <silt/linear/window_rows.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"

#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::instruction_sets_test {
namespace {

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> all;
  for (const InstructionSet set : {InstructionSet::portable, InstructionSet::sse2,
                                   InstructionSet::avx2, InstructionSet::avx512}) {
    if (silt::detail::has_processor(set)) all.push_back(set);
  }
  return all;
}

// Calls f with each instruction set, and expects the same result.
template <class F>
void expect_same_with_each(F&& f) {
  struct Restore {
    InstructionSet before = instruction_set();
    ~Restore() { silt::detail::used_instruction_set() = before; }
  } restore;
  std::optional<decltype(f())> first;
  for (const InstructionSet set : instruction_sets()) {
    silt::detail::used_instruction_set() = set;
    const auto found = f();
    if (!first) first = found;
    EXPECT_TRUE(found == *first) << silt::detail::instruction_set_names[int(set)];
  }
}

// Grains that fall through a periodic box onto a vibrating floor.
template <int Dim>
auto shaken(const auto& law) {
  constexpr Index along_each_axis = Dim == 2 ? 40 : 12;
  auto grains = crowd<Dim, double>(along_each_axis, 1);
  auto box = cube<Dim, double>(0, double(along_each_axis) * 0.0205);
  box.lower[Dim - 1] = -0.5;
  box.upper[Dim - 1] = 10;
  for (std::size_t k = 0; k + 1 < Dim; ++k) box.periodic[k] = true;
  grains.set_box(box);
  const Vec<Dim> up = Vec<Dim>::Unit(Dim - 1);
  const dem::Moving floor{dem::Plane<Dim>{.point = -0.02 * up, .normal = up},
                          dem::Vibration<Dim>{.amplitude = 1e-3 * up, .frequency = 50}};
  return Simulation{std::move(grains), NeighbourList<Dim>{},
                    Forces{Gravity<Dim>{-9.81 * up}, dem::Contacts{law, floor}},
                    Leapfrog{GlobalDamping{.alpha = 0.1}}};
}

const dem::CundallStrack springs{.normal_stiffness = 1e6,
                                 .tangential_stiffness = 5e5,
                                 .restitution = 0.6,
                                 .friction_angle = 0.5};

template <class Start>
void expect_same_bits_of(Start&& start) {
  expect_same_with_each([&] {
    auto simulation = start();
    for (int k = 0; k < 60; ++k) simulation.step(1e-5);
    return state_of(simulation.particles());
  });
}

TEST(InstructionSets, GiveTheSameBitsOfSpheres) {
  expect_same_bits_of([] { return shaken<3>(springs); });
}
TEST(InstructionSets, GiveTheSameBitsOfDiscs) {
  expect_same_bits_of([] { return shaken<2>(springs); });
}

const dem::Elastic glass{.young_modulus = 1e7, .poisson_ratio = 0.25};
const dem::Law rolling{dem::Hertz{.elastic = glass, .restitution = 0.6},
                       dem::Mindlin{.elastic = glass, .friction_angle = 0.3},
                       dem::RollingResistance{.rolling_friction = 0.1}};

// A law that is not written for lanes.
struct OwnSpring {
  Vec<3> force(const dem::Contact<3, double>& contact) const {
    return 1e6 * contact.overlap * contact.normal - 5 * contact.relative_velocity;
  }
};

TEST(InstructionSets, GiveTheSameBitsOfSpheresThatRoll) {
  expect_same_bits_of([] { return shaken<3>(rolling); });
}
TEST(InstructionSets, GiveTheSameBitsOfAnOwnLaw) {
  expect_same_bits_of([] { return shaken<3>(OwnSpring{}); });
}
TEST(InstructionSets, GiveTheSameBitsInSinglePrecision) {
  expect_same_bits_of([] {
    return Simulation{crowd<3, float>(12, 1), UniformGrid<3, float>{}, dem::Contacts{springs},
                      Leapfrog{}};
  });
}
TEST(InstructionSets, GiveTheSameForcesToObservers) {
  expect_same_with_each([] {
    auto simulation = shaken<3>(springs);
    for (int k = 0; k < 5; ++k) simulation.step();
    const auto [grains, interaction] = simulation.state();
    std::vector<double> forces;
    interaction.template part<1>().for_each_contact(
        grains, [&](Index, Index, const auto&, const auto& force) {
          forces.insert(forces.end(), force.begin(), force.end());
        });
    return forces;
  });
}

// A column of water that collapses in its tank: walls of faces, and what an own policy adds.
struct OwnShifting {
  void check() const {}
  template <class View>
  typename View::Vec displacement(const View& at) const {
    typename View::Vec sum = View::Vec::Zero();
    at.for_each([&](const auto& j) { sum += j.weight * j.r_ij; });
    return -1e-3 * sum;
  }
};
struct OwnScheme : mps::Recommended {
  OwnShifting shifting{};
};
template <class Scheme, int Dim>
auto collapsing(double spacing) {
  auto tank = mps::make_tank<Scheme, Dim>({.column = {0.2, 0.4},
                                           .size = {.length = 0.6, .height = 0.6, .depth = 0.2},
                                           .spacing = spacing});
  const mps::Flow<Scheme, Dim> water{
      {.spacing = spacing, .viscosity = 1e-3, .speed_scale = 2, .walls = tank.walls}};
  return Simulation{std::move(tank.particles), UniformGrid<Dim>{}, water, SemiImplicit<>{}};
}
template <class Start>
void expect_same_bits_of_flow(Start&& start) {
  expect_same_with_each([&] {
    auto dam = start();
    for (int k = 0; k < 5; ++k) dam.step();
    return state_of(dam.particles());
  });
}

TEST(InstructionSets, GiveTheSameBitsOfAFlowWithAnOwnPolicy) {
  expect_same_bits_of_flow([] { return collapsing<OwnScheme, 2>(0.02); });
}
TEST(InstructionSets, GiveTheSameBitsOfAFlowIn3D) {
  expect_same_bits_of_flow([] { return collapsing<mps::Recommended, 3>(0.04); });
}
TEST(InstructionSets, GiveTheSameBitsOfAFlowWithWallParticles) {
  expect_same_bits_of_flow([] { return collapsing<mps::Case10, 2>(0.02); });
}

// Steps between the columns of a row that fluid rarely has: repeated columns, a window of which the
// first column comes second, and windows at the last column; in rows of up to 90 entries.
TEST(InstructionSets, GiveTheSameWindowsOfRows) {
  constexpr Index columns = 300;
  expect_same_with_each([] {
    WindowRows rows;
    rows.build(2000, columns, [](Index i, auto&& add) {
      std::mt19937 random(static_cast<unsigned>(i));
      const Index most_steps = i % 5 == 0 ? 5 : 20;  // few: runs of consecutive columns
      Index column = random() % columns;
      for (Index k = random() % 91; k > 0; --k) {
        add(column, double(random() % 1000) / 64 - 5);
        const Index step = random() % most_steps;
        column = std::min(columns - 1, column + (step < 3 ? step : 1));
        if (step == 4 && i % 2 == 0) column -= std::min<Index>(column, 2);
      }
    });
    std::vector<std::pair<Index, double>> entries;
    for (Index i = 0; i < rows.size(); ++i) {
      rows.for_each_entry(i,
                          [&](Index column, double value) { entries.emplace_back(column, value); });
    }
    return entries;
  });
}

TEST(InstructionSets, UndoAStepThatFails) {
  expect_same_with_each([] {
    auto simulation = shaken<3>(springs);
    for (int k = 0; k < 5; ++k) simulation.step();
    const Bytes before = state_of(simulation.particles());
    auto broken = simulation;
    broken.particles()[velocity][100][0] = std::numeric_limits<double>::quiet_NaN();
    const Bytes changed = state_of(broken.particles());
    EXPECT_THROW(broken.step(), Error);
    EXPECT_TRUE(state_of(broken.particles()) == changed);
    simulation.step();
    return state_of(simulation.particles());
  });
}

// The sums of the pressure solver, of which portability.hashes_* compare two runs in two sets only.
template <int Dim>
void expect_same_bits_of_water(double spacing) {
  expect_same_with_each([&] {
    Simulation dam{mps::make_tank<Dim>({.column = {0.2, 0.2},
                                        .size = {.length = 0.4, .height = 0.3, .depth = 0.2},
                                        .spacing = spacing}),
                   UniformGrid<Dim>{},
                   mps::Flow<mps::Case10, Dim>{{.spacing = spacing, .speed_scale = 2}},
                   SemiImplicit<>{}};
    for (int k = 0; k < 3; ++k) dam.step();
    return state_of(dam.particles());
  });
}
TEST(InstructionSets, GiveTheSameBitsOfWater) {
  expect_same_bits_of_water<2>(0.005);
  expect_same_bits_of_water<3>(0.02);
}

TEST(InstructionSets, AreChosenByTheEnvironment) {
  const char* const given = std::getenv("SILT_ISA");
  const std::string before = given != nullptr ? given : "";
  for (const InstructionSet set : instruction_sets()) {
    ::setenv("SILT_ISA", std::string(silt::detail::instruction_set_names[int(set)]).c_str(), 1);
    EXPECT_EQ(silt::detail::choose_instruction_set(), set);
  }
  for (const char* const unknown : {"avx1024", "AVX2", "portable sse2"}) {
    ::setenv("SILT_ISA", unknown, 1);
    try {
      silt::detail::choose_instruction_set();
      ADD_FAILURE() << unknown;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("SILT_ISA"), std::string::npos) << text;
      EXPECT_NE(text.find(unknown), std::string::npos) << text;
    }
  }
  ::setenv("SILT_ISA", before.c_str(), 1);
}

}  // namespace
}  // namespace silt::test::instruction_sets_test
