// SPDX-License-Identifier: MIT
// The neighbour list of a flow: the neighbours found by the search, with the weights of the
// stencil.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

namespace silt::test::neighbourhood_test {
namespace {

using mps::Kind;

template <class S>
class Neighbourhoods : public ::testing::Test {};
TYPED_TEST_SUITE(Neighbourhoods, Spaces);

// A disordered periodic box in which every fifth particle is a wall and every seventh a dummy.
template <class T>
auto mixed_box() {
  using Real = typename T::Real;
  auto fluid = full_box<T::dimension, Real>(T::dimension == 2 ? 40 : 12, Real(0.1), Real(0.2));
  for (Index i = 0; i < fluid.size(); ++i) {
    if (i % 5 == 0) fluid[mps::kind][i] = Kind::wall;
    if (i % 7 == 0) fluid[mps::kind][i] = Kind::dummy;
  }
  return fluid;
}

template <class T>
using StencilOf = mps::Stencil<T::dimension, typename T::Real, mps::CubicKernel>;

template <class T, class Search>
void expect_neighbours_of_search(Search search) {
  using Real = typename T::Real;
  auto fluid = mixed_box<T>();
  const StencilOf<T> stencil({.spacing = Real(0.1), .radius = 3.1});
  search.set_radius(Real(1.1) * stencil.re);  // larger than the stencil
  search.update(fluid);
  mps::Neighbourhood<T::dimension, Real> around;
  around.find(fluid, search, stencil);
  for (Index i = 0; i < fluid.size(); ++i) {
    struct Weights {
      Real w;
      Real w_r2;
    };
    std::map<Index, Weights> expected;
    Real density = 0;
    if (fluid[mps::kind][i] != Kind::dummy) {
      mps::for_each_weighted(search, i, stencil, [&](Index j, const auto&, Real w, Real w_r2) {
        expected[j] = {w, w_r2};
        density += w;
      });
    }
    EXPECT_EQ(around[i].size(), expected.size());
    EXPECT_NEAR(around.density(i), density, T::rounding * density);
    mps::for_each_weighted(around, i, stencil, [&](Index j, const auto& r_ij, Real w, Real w_r2) {
      ASSERT_TRUE(expected.contains(j));
      EXPECT_NEAR(w, expected[j].w, 1e-6);
      EXPECT_NEAR(w_r2, expected[j].w_r2, 1e-6 / squared(stencil.spacing));
      EXPECT_NEAR((fluid.with_ghosts(position)[j] - fluid[position][i] - r_ij).norm(), 0, 1e-12);
    });
  }
}

TYPED_TEST(Neighbourhoods, ContainTheNeighboursOfTheSearchWithinTheStencil) {
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  expect_neighbours_of_search<TypeParam>(UniformGrid<dim, Real>{});
  expect_neighbours_of_search<TypeParam>(BruteForce<dim, Real>{});
}

TYPED_TEST(Neighbourhoods, HaveBitwiseEqualWeightsForBothParticlesOfAPair) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  auto fluid = blob<dim, Real>(dim == 2 ? 30 : 10, Real(0.1), Real(0.2));
  const StencilOf<TypeParam> stencil({.spacing = Real(0.1), .radius = 2.1});
  UniformGrid<dim, Real> search({.radius = stencil.re});
  search.update(fluid);
  mps::Neighbourhood<dim, Real> around;
  around.find(fluid, search, stencil);
  std::map<std::pair<Index, Index>, float> weights;
  for (Index i = 0; i < fluid.size(); ++i) {
    const auto row = around[i];
    for (Index k = 0; k < row.size(); ++k) weights[{i, Index(row.index[k])}] = row.weight[k];
  }
  ASSERT_GT(weights.size(), fluid.size());
  for (const auto& [pair, weight] : weights) {
    EXPECT_EQ((weights[{pair.second, pair.first}]), weight);
  }
}

TYPED_TEST(Neighbourhoods, IterateOverCloserNeighbours) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  auto fluid = mixed_box<TypeParam>();
  const StencilOf<TypeParam> stencil({.spacing = Real(0.1), .radius = 3.1});
  UniformGrid<dim, Real> search({.radius = stencil.re});
  search.update(fluid);
  mps::Neighbourhood<dim, Real> around;
  around.find(fluid, search, stencil);
  const Real reach = Real(0.12);
  const auto min_weight = static_cast<float>(stencil.weight(reach)) - 1e-4f;
  for (Index i = 0; i < fluid.size(); ++i) {
    std::set<Index> expected;
    const auto row = around[i];
    for (Index k = 0; k < row.size(); ++k) {
      const Index j = row.index[k];
      const Real r = (fluid.with_ghosts(position)[j] - fluid[position][i]).norm();
      if (r < reach) expected.insert(j);
    }
    std::set<Index> found;
    around.for_each_closer(i, reach, min_weight, [&](Index j, const auto&, Real r) {
      EXPECT_LT(r, reach * (1 + TypeParam::rounding));
      found.insert(j);
    });
    EXPECT_EQ(found, expected);
  }
}

TEST(Neighbourhood, IsCurrentUntilParticlesMoveOrAreAdded) {
  auto fluid = blob<2, double>(10, 0.1);
  const mps::Stencil<2, double, mps::CubicKernel> stencil({.spacing = 0.1, .radius = 3.1});
  UniformGrid<2> search({.radius = stencil.re});
  mps::Neighbourhood<2, double> around;
  search.update(fluid);
  around.find(fluid, search, stencil);
  EXPECT_TRUE(around.is_current(fluid));
  fluid[velocity][3] = {1, 2};
  EXPECT_TRUE(around.is_current(fluid));
  fluid[position][3][0] += 1e-15;
  EXPECT_FALSE(around.is_current(fluid));
  search.update(fluid);
  around.find(fluid, search, stencil);
  EXPECT_TRUE(around.is_current(fluid));
  mps::add_particle(fluid, {5, 5}, Kind::fluid);
  EXPECT_FALSE(around.is_current(fluid));
}

TEST(Neighbourhood, RejectsCoincidentParticles) {
  auto fluid = fluid_at<2, double>({{0, 0}, {0.1, 0}, {0.1, 0}});
  const mps::Stencil<2, double, mps::CubicKernel> stencil({.spacing = 0.1, .radius = 3.1});
  UniformGrid<2> search({.radius = stencil.re});
  search.update(fluid);
  mps::Neighbourhood<2, double> around;
  EXPECT_TRUE(refuses([&] { around.find(fluid, search, stencil); },
                      {"two particles have the same position", "particle 1"}));
}

}  // namespace
}  // namespace silt::test::neighbourhood_test
