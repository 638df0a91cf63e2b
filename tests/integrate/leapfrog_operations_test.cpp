// SPDX-License-Identifier: MIT
// The parts of a leapfrog step that integrators of users are made of; also compiled for the vector
// instructions of this processor, with which two grains are moved at once.
#include <silt/dem/setup/grains.hpp>
#include <silt/integrate/damping.hpp>
#include <silt/integrate/leapfrog.hpp>

#include "support/check.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <utility>

namespace silt::test::leapfrog_operations_test {
namespace {

constexpr double dt = 1e-3;

// Grains of several sizes, each with another velocity, spin, force and torque.
template <int Dim, class Real>
dem::Grains<Dim, Real> some_grains(Index count) {
  using Vec = silt::Vec<Dim, Real>;
  dem::Grains<Dim, Real> grains;
  const auto random = random_points(4 * count, cube<Dim, Real>(-1, 1), 3);
  for (Index i = 0; i < count; ++i) {
    const double radius = 0.01 + 0.001 * double(i % 5);
    dem::add_grain(grains, random[i], {.radius = radius, .density = 2500});
  }
  const auto angular = [](const Vec& v) {
    if constexpr (Dim == 2) {
      return v[0];
    } else {
      return AngularVec<Dim, Real>(v);
    }
  };
  for (Index i = 0; i < count; ++i) {
    grains[velocity][i] = random[count + i];
    grains[force][i] = random[2 * count + i];
    grains[spin][i] = angular(random[3 * count + i]);
    grains[torque][i] = angular(Vec(random[i] * Real(1e-4)));
  }
  return grains;
}

// A single grain has no other beside it. Odd numbers leave one over where two are moved at once.
template <int Dim, class Real>
void expect_the_same_for_each_alone() {
  for (const Index count : {1, 2, 3, 7, 8, 33}) {
    SCOPED_TRACE(count);
    auto all = some_grains<Dim, Real>(count);
    auto alone = all;
    const auto before = all;
    kick(all, GlobalDamping{.alpha = 0.5}, dt);
    drift(all, dt);
    for (Index i = 0; i < count; ++i) {
      auto one = before;
      one.remove_if([&](Index k) { return one.id(k) != before.id(i); });
      kick(one, GlobalDamping{.alpha = 0.5}, dt);
      drift(one, dt);
      one.for_each_field([&](auto, auto field) {
        alone[field][i] = std::as_const(one)[field][0];
      });
    }
    EXPECT_TRUE(state_of(all) == state_of(alone));
    EXPECT_FALSE(state_of(all) == state_of(before));
  }
}

TEST(LeapfrogOperations, MoveEachGrainAsIfItWereAlone) {
  expect_the_same_for_each_alone<2, double>();
  expect_the_same_for_each_alone<3, double>();
  expect_the_same_for_each_alone<2, float>();
  expect_the_same_for_each_alone<3, float>();
}

TEST(LeapfrogOperations, KickByForceAndDriftByVelocity) {
  auto grains = some_grains<3, double>(5);
  const auto before = grains;
  kick(grains, NoDamping{}, dt);
  drift(grains, dt);
  const auto& now = std::as_const(grains);
  for (Index i = 0; i < grains.size(); ++i) {
    const Vec<3> v = before[velocity][i] + dt / before[mass][i] * before[force][i];
    const Vec<3> w = before[spin][i] + dt / before[inertia][i] * before[torque][i];
    EXPECT_LT((now[velocity][i] - v).norm(), 1e-13 * v.norm());
    EXPECT_LT((now[spin][i] - w).norm(), 1e-13 * w.norm());
    EXPECT_LT((now[position][i] - (before[position][i] + dt * v)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace silt::test::leapfrog_operations_test
