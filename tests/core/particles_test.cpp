// SPDX-License-Identifier: MIT
#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/search/ghosts.hpp>

#include "support/check.hpp"
#include "support/points.hpp"
#include "support/warm_particles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace silt::test::particles_test {
namespace {

template <class P>
class AllParticles : public ::testing::Test {};
TYPED_TEST_SUITE(AllParticles, WarmKinds);

TYPED_TEST(AllParticles, AreAddedWithAPositionAndZeros) {
  TypeParam particles;
  EXPECT_TRUE(particles.empty());
  using Vec = typename TypeParam::Vec;
  const Index i = particles.add(Vec::Constant(3));
  EXPECT_EQ(i, 0u);
  EXPECT_EQ(particles.size(), 1u);
  EXPECT_EQ(particles[position][0], Vec(Vec::Constant(3)));
  EXPECT_EQ(particles[velocity][0], Vec(Vec::Zero()));
  EXPECT_EQ(squared_norm(particles[spin][0]), 0);
  EXPECT_EQ(particles[temperature][0], 0);
  EXPECT_EQ(particles[colour][0], (std::array<unsigned char, 3>{}));
}

// The values of a field may be of any type that can be copied.
struct Label {
  std::string text = "none, in memory of its own";
};
inline constexpr struct label_t : field_of<Label> {
} label{};
TEST(Particles, HaveFieldsOfAnyType) {
  Particles<2, double, label_t> particles;
  for (int k = 0; k < 5; ++k) particles.add({k, 0});
  EXPECT_EQ(particles[label][3].text, Label{}.text);
  for (Index i = 0; i < 5; ++i) particles[label][i].text = "that of the particle " + std::to_string(i);
  particles.remove_if([](Index i) { return i == 1; });
  particles.reorder(std::array<Index, 4>{3, 1, 0, 2});
  particles.add_ghost(0, {1, 0});
  EXPECT_EQ(particles.with_ghosts(label).back().text, "that of the particle 4");
  particles.save();
  particles.keep(label);
  const auto copy = particles;
  for (auto& each : particles[label]) each.text = "changed";
  particles.copy_to_ghosts(label);
  EXPECT_EQ(particles.with_ghosts(label).back().text, "changed");
  particles.restore();
  for (const auto& each : {particles, copy}) {
    for (Index i = 0; i < 4; ++i) {
      EXPECT_EQ(each[label][i].text,
                "that of the particle " + std::to_string(int(each[position][i][0])));
    }
  }
  const auto [before, after] = particles.advance(label);
  for (Index i = 0; i < 4; ++i) after[i].text = before[i].text + " after the step";
  particles.finish_advance();
  EXPECT_EQ(particles[label][0].text, "that of the particle 4 after the step");
}

TYPED_TEST(AllParticles, StayInTheirMemoryWhenItIsReserved) {
  TypeParam particles;
  particles.reserve(1000);
  particles.add(TypeParam::Vec::Zero());
  const auto* const first = &particles[temperature][0];
  const auto* const velocity_of_first = &particles[velocity][0];
  while (particles.size() < 1000) particles.add(TypeParam::Vec::Zero());
  EXPECT_EQ(&particles[temperature][0], first);
  EXPECT_EQ(&particles[velocity][0], velocity_of_first);
}

// A checkpoint that keeps the names of the fields, by which another one is refused.
struct NamesInACheckpoint {
  static constexpr bool reads = false;
  std::string fields;

  void same(std::string_view name, const std::string& text) {
    if (name == "fields") fields = text;
  }
  template <class F>
  void within(std::string_view, F&& f) {
    f();
  }
  template <class F>
  void finite(F&& f) {
    f();
  }
  template <class... Values>
  void operator()(Values&&...) {}
};
TEST(Particles, AreDescribedByTheirFieldsInACheckpoint) {
  NamesInACheckpoint archive;
  Particles<2, double, velocity_t, mass_t>{}.transfer(archive);
  EXPECT_EQ(archive.fields, "position velocity mass");
}

// Particle k at (k, k, …).
template <class P>
P five_in_a_row() {
  P particles;
  for (int k = 0; k < 5; ++k) particles.add(P::Vec::Constant(static_cast<typename P::Real>(k)));
  return particles;
}

TYPED_TEST(AllParticles, AreUnchangedIfTheChoiceOfThoseToRemoveThrows) {
  auto particles = five_in_a_row<TypeParam>();
  const Bytes before = state_of(particles);
  const auto revision = particles.owned_revision();
  EXPECT_TRUE(refuses(
      [&] {
        particles.remove_if([](Index i) {
          if (i == 3) fail("three");
          return i < 2;
        });
      },
      {"three"}));
  EXPECT_EQ(state_of(particles), before);
  EXPECT_EQ(particles.owned_revision(), revision);
  for (Index i = 0; i < particles.size(); ++i) EXPECT_EQ(particles.index_of(particles.id(i)), i);
}

TYPED_TEST(AllParticles, AreAllThereWhileThoseToRemoveAreChosen) {
  auto particles = five_in_a_row<TypeParam>();
  const Index removed = particles.remove_if(
      [&](Index i) { return i == 0 || (i == 2 && particles.id(0) == 0); });
  EXPECT_EQ(removed, 2u);
  EXPECT_EQ(particles.index_of(2), no_index);
}

TYPED_TEST(AllParticles, AreReorderedAsGiven) {
  using Vec = typename TypeParam::Vec;
  using Real = typename TypeParam::Real;
  TypeParam particles;
  for (int k = 0; k < 3; ++k) particles.add(Vec::Constant(Real(k)));
  const std::vector<Index> order{2, 0, 1};
  particles.reorder(order);
  EXPECT_EQ(particles[position][0][0], Real(2));
  EXPECT_EQ(particles[position][1][0], Real(0));
  EXPECT_EQ(particles.id(0), 2u);
  EXPECT_EQ(particles.index_of(1), 2u);
}

TYPED_TEST(AllParticles, HaveGhostsThatAreShiftedCopies) {
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  constexpr int dim = TypeParam::dimension;
  auto box = cube<dim, Real>(0, 1);
  box.periodic.fill(true);
  TypeParam particles(box);
  particles.add(Vec::Constant(Real(0.5)));     // centre: no ghost
  particles.add(Vec::Constant(Real(0.0625)));  // corner: one ghost for every other corner
  particles[temperature][1] = 20;
  make_ghosts(particles, Real(0.125));
  EXPECT_EQ(particles.size(), 2u);
  ASSERT_EQ(particles.total(), 2u + (1u << dim) - 1u);
  for (Index g = particles.size(); g < particles.total(); ++g) {
    EXPECT_EQ(particles.owner(g), 1u);
    EXPECT_EQ(particles.id(g), particles.id(1));
    EXPECT_EQ(particles.with_ghosts(temperature)[g], Real(20));
    int shifted = 0;
    for (int k = 0; k < dim; ++k) {
      const Real x = particles.with_ghosts(position)[g][k];
      EXPECT_TRUE(x == Real(0.0625) || x == Real(1.0625));
      shifted += x > 1;
    }
    EXPECT_GE(shifted, 1);
  }

  // Ghosts have the values of the last refresh.
  particles[temperature][1] = 30;
  EXPECT_EQ(particles.with_ghosts(temperature)[2], Real(20));
  particles.refresh_ghosts(temperature);
  EXPECT_EQ(particles.with_ghosts(temperature)[2], Real(30));
  const Vec before = particles.with_ghosts(position)[particles.total() - 1];
  particles[position][1] += Vec::Constant(Real(0.03125));
  particles.refresh_ghosts(position);
  EXPECT_EQ(particles.with_ghosts(position)[particles.total() - 1],
            Vec(before + Vec::Constant(Real(0.03125))));

  // Adding, removing and reordering remove the ghosts.
  particles.add(Vec::Zero());
  EXPECT_EQ(particles.total(), 3u);
  EXPECT_EQ(particles[temperature][1], Real(30));
}

TYPED_TEST(AllParticles, AreRestoredToTheSavedState) {
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  auto particles = five_in_a_row<TypeParam>();
  particles[temperature][3] = 7;
  const Bytes before = state_of(particles);
  particles.save();
  particles.keep(position);
  particles.keep(temperature);
  particles.keep(velocity);
  for (auto& x : particles[position]) x *= 2;
  particles[temperature][3] = std::numeric_limits<Real>::quiet_NaN();
  particles[velocity][0] = Vec::Ones();
  EXPECT_NE(state_of(particles), before);
  particles.restore();
  EXPECT_EQ(state_of(particles), before);
}

TYPED_TEST(AllParticles, AreRestoredAfterAnAdvance) {
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  auto particles = five_in_a_row<TypeParam>();
  particles.add_ghost(1, Vec::Constant(Real(10)));
  const Bytes before = state_of(particles);
  particles.save();
  for (int twice = 0; twice < 2; ++twice) {
    const auto [old, now] = particles.advance(position);
    for (Index i = 0; i < now.size(); ++i) now[i] = old[i] + Vec::Ones();
    particles.finish_advance();
  }
  EXPECT_EQ(particles[position][2], Vec(Vec::Constant(Real(4))));
  EXPECT_EQ(particles.with_ghosts(position)[5], Vec(Vec::Constant(Real(11))));
  particles.restore();
  EXPECT_EQ(state_of(particles), before);
}

TYPED_TEST(AllParticles, AreUnchangedUntilAnAdvanceIsFinished) {
  using Vec = typename TypeParam::Vec;
  auto particles = five_in_a_row<TypeParam>();
  const Bytes before = state_of(particles);
  particles.save();
  const auto next = particles.advance(position).after;
  for (auto& x : next) x = Vec::Ones();
  EXPECT_EQ(state_of(particles), before);
  particles.restore();
  particles.finish_advance();
  EXPECT_EQ(state_of(particles), before);
}

TYPED_TEST(AllParticles, KeepTheirGhostsInSteps) {
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  auto particles = five_in_a_row<TypeParam>();
  // Shared, so that a step writes to further memory.
  std::vector<TypeParam> copies;
  const auto step = [&] {
    particles.save();
    const auto [old, now] = particles.advance(position);
    for (Index i = 0; i < now.size(); ++i) now[i] = old[i] + Vec::Ones();
    particles.finish_advance();
    copies.push_back(particles);
  };
  const auto ghost = [&](Index k) {
    return Vec(particles.with_ghosts(position)[particles.size() + k]);
  };
  const Vec shift = Vec::Constant(Real(10));
  particles.add_ghost(1, shift);
  const Vec first = ghost(0);
  for (int k = 0; k < 4; ++k) {
    step();
    EXPECT_EQ(ghost(0), first);
  }
  particles.refresh_ghosts(position);
  EXPECT_EQ(ghost(0), Vec(first + Vec::Constant(Real(4))));
  for (int k = 0; k < 4; ++k) {
    step();
    EXPECT_EQ(ghost(0), Vec(first + Vec::Constant(Real(4))));
  }
  particles.clear_ghosts();
  particles.add_ghost(2, shift);
  const Vec second = ghost(0);
  for (int k = 0; k < 4; ++k) {
    step();
    EXPECT_EQ(ghost(0), second);
  }
  particles = copies[3];
  for (int k = 0; k < 4; ++k) {
    step();
    EXPECT_EQ(ghost(0), first);
  }
}

TYPED_TEST(AllParticles, KnowHowFarStepsHaveMovedThem) {
  auto particles = five_in_a_row<TypeParam>();
  const auto& fixed = particles;
  const auto moves_by = [&](double distance) {
    const auto [old, now] = particles.advance(position);
    std::copy(old.begin(), old.end(), now.begin());
    particles.save();
    particles.advance(position);
    particles.finish_advance(distance);
  };
  const Travel begin = particles.travel();
  EXPECT_TRUE(particles.travel().is_within(0, begin));
  moves_by(0.5);
  moves_by(0.25);
  static_cast<void>(fixed[position][0]);
  EXPECT_TRUE(particles.travel().is_within(0.75, begin));
  EXPECT_FALSE(particles.travel().is_within(0.74, begin));

  static_cast<void>(particles[position][0]);  // may have been changed
  EXPECT_FALSE(particles.travel().is_within(1e9, begin));
  const Travel later = particles.travel();
  const TypeParam copy = particles;
  EXPECT_FALSE(copy.travel().is_within(1e9, later));
  EXPECT_TRUE(particles.travel().is_within(0, later));
  particles.finish_advance();
  EXPECT_FALSE(particles.travel().is_within(1e9, later));
}

TYPED_TEST(AllParticles, NoteAccessToConstantFields) {
  auto particles = five_in_a_row<TypeParam>();
  const auto& fixed = particles;
  particles.save();
  const auto first = particles.constants_revision();
  static_cast<void>(fixed[colour][0]);
  static_cast<void>(particles[temperature][0]);
  EXPECT_EQ(particles.constants_revision(), first);
  static_cast<void>(particles[colour][0]);
  const auto second = particles.constants_revision();
  EXPECT_NE(second, first);
  EXPECT_NE(particles.constants_revision(), second) << "the view is valid until the next step";
  particles.save();
  const auto third = particles.constants_revision();
  EXPECT_NE(third, second);
  EXPECT_EQ(particles.constants_revision(), third);
  particles.remove(0);
  EXPECT_NE(particles.constants_revision(), third);
}

TEST(Bundle, StoresFieldsSideBySide) {
  WarmInRows<3, double> particles;
  for (int k = 0; k < 3; ++k) particles.add(Vec<3>(k, 0, 0));
  particles[temperature][1] = 7;
  const WarmInRows<3, double>& fixed = particles;
  EXPECT_EQ(fixed.storage(position).rows()[10 + 6], 7);
  EXPECT_EQ(&fixed[velocity][1][0] - &fixed[position][1][0], 3);
  EXPECT_EQ(&fixed[spin][2][0] - &fixed[spin][1][0], 10);
  const auto x = fixed[position];
  EXPECT_EQ(x.size(), 3u);
  EXPECT_EQ(x.back()[0], 2);
  EXPECT_EQ(std::count_if(x.begin(), x.end(), [](const auto& each) { return each[0] > 0; }), 2);
  EXPECT_EQ(*(x.end() - 1), x[2]);
}

TYPED_TEST(AllParticles, RejectAPositionThatIsNotFinite) {
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  TypeParam particles;
  Vec x = Vec::Zero();
  x[1] = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_TRUE(refuses([&] { particles.add(x); }, {"Particles::add: position", "nan"}));
  x[1] = std::numeric_limits<Real>::infinity();
  EXPECT_TRUE(refuses([&] { particles.add(x); }, {"Particles::add: position", "inf"}));
  EXPECT_TRUE(particles.empty());
}

TYPED_TEST(AllParticles, RejectRemovingAnUnknownId) {
  using Vec = typename TypeParam::Vec;
  TypeParam particles;
  particles.add(Vec::Zero());
  EXPECT_TRUE(refuses([&] { particles.remove(12); }, {"Particles::remove", "id 12"}));
  particles.remove(0);
  EXPECT_TRUE(refuses([&] { particles.remove(0); }, {"Particles::remove", "id 0"}));
}

TYPED_TEST(AllParticles, RejectAnOrderThatIsNotAPermutation) {
  using Vec = typename TypeParam::Vec;
  TypeParam particles;
  for (int k = 0; k < 3; ++k) particles.add(Vec::Zero());
  const Bytes before = state_of(particles);
  for (const std::vector<Index>& wrong :
       {std::vector<Index>{0, 1}, {0, 1, 1}, {0, 1, 3}, {0, 1, 2, 2}, {}}) {
    EXPECT_TRUE(refuses([&] { particles.reorder(wrong); }, {"Particles::reorder", "3"}));
    EXPECT_EQ(state_of(particles), before);
  }
}

TEST(Fields, HaveTheNameInTheSource) {
  EXPECT_EQ(name_of<position_t>(), "position");
  EXPECT_EQ(name_of<temperature_t>(), "temperature");
}

TEST(Fields, HaveARoleInAStep) {
  EXPECT_EQ(role_of<position_t>(), Role::state);
  EXPECT_EQ(role_of<temperature_t>(), Role::state);
  EXPECT_EQ(role_of<colour_t>(), Role::constant);
  EXPECT_EQ(role_of<heat_t>(), Role::derived);
}

TEST(Fields, AreVisitedOnceEachWithPositionFirst) {
  std::vector<std::string> names;
  Warm<2, double> particles;
  particles.for_each_field([&]<class F>(auto, F) { names.emplace_back(name_of<F>()); });
  EXPECT_EQ(names, (std::vector<std::string>{"position", "velocity", "spin", "temperature",
                                             "colour", "heat"}));
}

}  // namespace
}  // namespace silt::test::particles_test
