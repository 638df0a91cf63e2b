// SPDX-License-Identifier: MIT
// The criterion for the free surface that looks for fluid in a cone.
#include <silt/mps/policy/cone_surface.hpp>

#include <silt/core/types.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace silt::test::cone_surface_test {
namespace {

// The neighbours of a particle at the origin, with the weight 1/r.
struct Around {
  static constexpr int dimension = 2;
  using Real = double;

  std::vector<Vec<2>> neighbours;
  bool covers = true;  // those above
  double n0 = 0;
  double spacing = 1;

  template <class F>
  void for_each(F&& f) const {
    for (const auto& r : neighbours) f(r, 1 / r.norm(), covers || r[1] <= 0);
  }
};

// Those within 2.1 spacings in a lattice, without the rows beyond `highest`.
Around in_lattice(int highest) {
  Around around;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      const Vec<2> r(x, y);
      if (r.norm() == 0 || r.norm() > 2.1) continue;
      around.n0 += 1 / r.norm();
      if (y <= highest) around.neighbours.push_back(r);
    }
  }
  return around;
}

bool is_on_surface(const Around& around) { return mps::ConeSurface{}.is_on_surface(around); }

TEST(ConeSurface, IsTheHighestRow) {
  EXPECT_TRUE(is_on_surface(in_lattice(0)));
  EXPECT_FALSE(is_on_surface(in_lattice(1)));
  EXPECT_FALSE(is_on_surface(in_lattice(2)));
}

TEST(ConeSurface, IsCoveredByAParticleWithinTheCone) {
  Around around = in_lattice(0);
  const auto with_one_at = [&](const Vec<2>& r) {
    Around more = around;
    more.neighbours.push_back(r);
    return more;
  };
  EXPECT_FALSE(is_on_surface(with_one_at({0, 1.5})));
  EXPECT_FALSE(is_on_surface(with_one_at({0.6, 1.2}))) << "within 45 degrees";
  EXPECT_TRUE(is_on_surface(with_one_at({1.5, 0.6}))) << "beside the cone";
  EXPECT_TRUE(is_on_surface(with_one_at({0, 2.2}))) << "beyond its length";
  around = with_one_at({0, 1.5});
  around.covers = false;
  EXPECT_TRUE(is_on_surface(around)) << "a wall does not cover";
}

TEST(ConeSurface, IncludesSpray) {
  Around around = in_lattice(0);
  around.neighbours = {{0, 1}};
  EXPECT_TRUE(is_on_surface(around));
}

}  // namespace
}  // namespace silt::test::cone_surface_test
