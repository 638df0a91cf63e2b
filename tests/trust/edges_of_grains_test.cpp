// SPDX-License-Identifier: MIT
// Grains at the edges of what is defined: at the same point, at exactly the sum of their radii, of
// any size, at a periodic side. A result is finite and antisymmetric, or an error names the grains.
// Only with --all: laws, searches and precisions at their edges.
#include <silt/dem.hpp>
#include <silt/dem/setup/grain_table.hpp>

#include "support/any_law.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::edges_of_grains_test {
namespace {

constexpr double dt = 1e-6;

template <class P, class Law>
auto simulation_of(const P& grains, const Law& law) {
  using S = UniformGrid<P::dimension, typename P::Real>;
  return Simulation{grains, S{}, dem::Contacts{law}.with(without_limits), Leapfrog{}};
}

// The forces on the first two grains are finite and opposite to the bit.
template <class Sim>
void expect_opposite_forces(const Sim& sim, const std::string& what) {
  const auto F = sim.particles()[force];
  EXPECT_TRUE(is_finite(F[0]) && is_finite(F[1])) << what;
  EXPECT_TRUE(F[0] == -F[1]) << what;
}

TEST(CoincidentGrains, AreRefusedByEveryLawWithBothIds) {
  for (const auto& [name, law] : all_laws<3>()) {
    auto grains = two_grains<3>(0.1, Vec<3>(0, 0, 0));
    dem::add_grain(grains, grains[position][1], pebble);
    auto sim = simulation_of(grains, law);
    const Bytes before = state_of(sim.particles());
    EXPECT_TRUE(refuses([&] { sim.step(dt); }, {"grains 1 and 2 coincide", "place them apart"}))
        << name;
    EXPECT_TRUE(state_of(sim.particles()) == before) << name;
  }
}

TEST(CoincidentGrains, AreRefusedAcrossAPeriodicSide) {
  auto box = cube<3, double>(-0.1, 0.3);
  box.periodic[1] = true;
  dem::Grains<3> grains(box);
  dem::add_grain(grains, {0, -0.1, 0}, pebble);
  dem::add_grain(grains, {0, 0.3, 0}, pebble);
  auto sim = simulation_of(grains, dem::CundallStrack{.normal_stiffness = 1e6});
  EXPECT_TRUE(refuses([&] { sim.step(dt); }, {"grains 0 and 1 coincide"}));
}

template <class Real>
class GrainsIn : public ::testing::Test {};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(GrainsIn, Reals);

TYPED_TEST(GrainsIn, AlmostTheSamePointRepelAlongTheLineOfCentresOrAreRefused) {
  using Real = TypeParam;
  const dem::CundallStrack law{.normal_stiffness = 1};
  int refused = 0;
  for (Real r = Real(0.5); r > 0; r /= 2) {
    const Vec<3, Real> apart(r, -r / 2, r / 4);
    dem::Grains<3, Real> grains;
    dem::add_grain(grains, {0, 0, 0}, {.radius = 1, .density = 1});
    dem::add_grain(grains, apart, {.radius = 1, .density = 1});
    auto sim = simulation_of(grains, law);
    try {
      sim.step(dt);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("grains 0 and 1 coincide"), std::string::npos)
          << r << ": " << error.what();
      ++refused;
      continue;
    }
    EXPECT_EQ(refused, 0) << r;
    const auto d = apart.template cast<double>().eval();
    const double distance = d.stableNorm();
    const Vec<3> F = sim.particles()[force][1].template cast<double>();
    EXPECT_LT((F - (2 - distance) * d.stableNormalized()).norm(), 1e-5) << r;
    expect_opposite_forces(sim, "distance " + to_text(double(r)));
  }
  EXPECT_GT(refused, 0);
}

TEST(TouchingGrains, AtExactlyTheSumOfTheirRadiiHaveNoContact) {
  const auto radii = random_points(200, cube<2, double>(0.5, 1.5), 3);
  dem::Grains<3> grains;
  double y = 0;
  for (const auto& pair : radii) {
    y += 10;
    dem::add_grain(grains, {0, y, 0}, {.radius = pair[0], .density = 1});
    dem::add_grain(grains, {pair[0] + pair[1], y, 0}, {.radius = pair[1], .density = 1});
  }
  const dem::CundallStrack law{.normal_stiffness = 1};
  auto sim = simulation_of(grains, law);
  sim.step(dt);
  EXPECT_EQ(sim.interaction().size(), 0u);
  for (const auto& F : sim.particles()[force]) EXPECT_EQ(F.norm(), 0);
}

// A vector of which the square of the length is below R², but whose length is rounded to R.
std::optional<Vec<3>> of_rounded_length(double R) {
  const double x = std::nextafter(R, 0.0);
  for (int k = 0; k < 1000; ++k) {
    const double y = R * 1e-10 * k;
    const double squared_length = x * x + y * y;
    if (squared_length < R * R && std::sqrt(squared_length) == R) return Vec<3>(x, y, 0);
  }
  return {};
}

TEST(TouchingGrains, WhoseOverlapIsRoundedToZeroHaveFiniteForces) {
  const auto apart = of_rounded_length(2 * pebble.radius);
  ASSERT_TRUE(apart);
  for (const auto& [name, law] : all_laws<3>()) {
    for (const Vec<3>& v : {Vec<3>(0, 0, 0), Vec<3>(-1, 0.3, 0), Vec<3>(1, 0, -2)}) {
      auto grains = two_grains<3>(0, v);
      grains[position][1] = *apart;
      grains[spin][1] = {20, 30, 40};
      auto sim = simulation_of(grains, law);
      // The first half step does not move grains, so that the forces are those of this point.
      sim.step(dt);
      EXPECT_EQ(sim.interaction().size(), 1u) << name;
      expect_opposite_forces(sim, name);
      for (int k = 0; k < 20; ++k) sim.step(dt);
      expect_opposite_forces(sim, name);
    }
  }
}

TEST(ContactLaws, AreFiniteAtAnyOverlap) {
  const std::vector<double> overlaps{1e-4, 0, 1e-4, 1e-12, 1e-160, 5e-324, 0, 5e-324, 0.01, 0, 0};
  for (const auto& [name, law] : all_laws<3>()) {
    for (const double v : {0.0, 1e-300, 1.0, -1e3}) {
      AnyLaw<3>::History<3, double> history;
      for (const double overlap : overlaps) {
        dem::Contact<3, double> contact{.normal = Vec<3>(0, 0, 1),
                                        .overlap = overlap,
                                        .relative_velocity = Vec<3>(v, -2 * v, -v),
                                        .relative_spin = Vec<3>(3 * v, v, v),
                                        .effective_mass = 5e-3,
                                        .effective_radius = 5e-3,
                                        .time_step = 1e-5};
        const auto load = law.components(contact, history);
        const bool is_force_finite =
            is_finite(load.force(contact.normal)) && is_finite(Vec<3>(load.couple()));
        const bool are_losses_finite =
            is_finite(load.plastic) && is_finite(load.friction) && is_finite(load.rolling_friction);
        const auto stored = law.elastic_energies(contact, history);
        EXPECT_TRUE(is_force_finite && are_losses_finite && is_finite(stored.sum()))
            << name << ", overlap " << overlap << ", " << v << " m/s";
      }
    }
  }
}

TEST(TouchingGrains, HaveOppositeForcesByEveryLaw) {
  for (const auto& [name, law] : all_laws<3>()) {
    for (const double ratio : {1.0, 3.0, 1e3}) {
      dem::Grains<3> grains;
      const double small = 0.01 / ratio;
      dem::add_grain(grains, {0.3, -0.1, 0.2}, {.radius = 0.01, .density = 2500});
      const Vec<3> along = Vec<3>(1, 2, -3).normalized();
      dem::add_grain(grains, Vec<3>(grains[position][0] + (0.01 + 0.99 * small) * along),
                     {.radius = small, .density = 2500});
      grains[velocity][1] = Vec<3>(-0.5, -0.8, 1.3) / ratio;
      grains[spin][0] = {5, -7, 3};
      grains[spin][1] = {-20, 30, 10};
      auto sim = simulation_of(grains, law);
      const double step = sim.time_step() / 4;
      for (int k = 0; k < 200; ++k) {
        sim.step(step);
        expect_opposite_forces(sim, name);
      }
    }
  }
}

// The force on two equal grains with overlap δ = R/10 that approach at √(k/m) δ, over k δ: the same
// for any R. Nothing if they are refused.
template <class Real>
std::optional<double> scaled_force(double R) {
  try {
    dem::Grains<3, Real> grains;
    for (const double x : {0.0, 1.9}) {
      dem::add_grain(grains, Vec<3, Real>(Real(x * R), 0, 0), {.radius = R, .density = 1});
    }
    const double m = double(grains[mass][0]);
    grains[velocity][1][0] = Real(-0.1 * R / std::sqrt(m));
    auto sim = simulation_of(grains, dem::CundallStrack{.normal_stiffness = 1, .restitution = 0.5});
    sim.step(0.01 * std::sqrt(m));
    expect_opposite_forces(sim, "radius " + to_text(R));
    return double(sim.particles()[force][1][0]) / (0.1 * R);
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("Grain: ") || (text.starts_with("dem::Contacts: ") &&
                                                text.find("of a grain") != std::string::npos &&
                                                text.find("id 0") != std::string::npos))
        << "radius " << R << ": " << text;
    return {};
  }
}

TYPED_TEST(GrainsIn, AnyUnitsHaveScaledForcesOrAreRefused) {
  constexpr bool is_double = sizeof(TypeParam) == sizeof(double);
  const double usual = *scaled_force<double>(1);
  EXPECT_GT(usual, 1.2) << "with a dashpot";
  for (int exponent = -324; exponent <= 308; ++exponent) {
    const double R = std::pow(10.0, exponent);
    const auto force = scaled_force<TypeParam>(R);
    if (force) {
      EXPECT_NEAR(*force, usual, is_double ? 1e-9 : 1e-4) << "radius " << R;
    }
    if (is_double ? std::abs(exponent) <= 25 : exponent >= -6 && exponent <= 5) {
      EXPECT_TRUE(force) << "radius " << R << " was refused";
    }
  }
}

TYPED_TEST(GrainsIn, WhichNumbersWereSetByHandAreValidOrRefused) {
  using Real = TypeParam;
  using Limits = std::numeric_limits<Real>;
  const std::vector<Real> extremes{Limits::denorm_min(), Limits::min(), 1, Limits::max()};
  int valid = 0;
  for (const Real R : extremes) {
    for (const Real m : extremes) {
      for (const Real I : extremes) {
        dem::Grains<3, Real> grains;
        for (const Real x : {Real(0), Real(1.5) * R}) {
          const Index i = grains.add(Vec<3, Real>(is_finite(x) ? x : R, 0, 0));
          grains[radius][i] = R;
          grains[mass][i] = m;
          grains[inertia][i] = I;
        }
        const std::string what =
            to_text(double(R)) + " m, " + to_text(double(m)) + " kg, " + to_text(double(I));
        try {
          auto sim =
              simulation_of(grains, dem::CundallStrack{.normal_stiffness = 1, .restitution = 0.5});
          sim.step(1e-30);
          expect_opposite_forces(sim, what);
          EXPECT_GT(sim.particles()[force][1][0], 0) << what;
          ++valid;
        } catch (const Error& error) {
          EXPECT_NE(std::string(error.what()).find("id 0"), std::string::npos)
              << what << ": " << error.what();
        }
      }
    }
  }
  EXPECT_GE(valid, 1);
}

TEST(LognormalSizes, WithoutAShareBetweenTheirLimitsAreRefused) {
  // σ√2 overflows.
  const dem::LognormalSizes sizes{
      .median = 1e-100, .deviation = 1.7e308, .min_radius = 1e-100, .max_radius = 1e100};
  EXPECT_TRUE(refuses([&] { sizes.check(); }, {"LognormalSizes", "widen these limits"}));
}

// A grain as a row of a table.
struct OneRow {
  std::map<std::string, double> values;

  Index rows() const { return 1; }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, value] : values) all.push_back(name);
    return all;
  }
  std::vector<double> operator[](const std::string& name) const { return {values.at(name)}; }
  void reject(Index, const std::string& column, const std::string& reason) const {
    fail(column + " " + reason);
  }
};

TEST(GrainTable, RejectsAMassWhoseMomentOfInertiaUnderflowsOrOverflows) {
  const auto grain = [](double R, double m) {
    return dem::grains_from<3>(OneRow{{{"x", 0}, {"y", 0}, {"z", 0}, {"radius", R}, {"mass", m}}});
  };
  EXPECT_NEAR(grain(1e10, 1e100)[inertia][0], 4e119, 1e106);
  for (const auto& [R, m] : {std::pair(1e10, 1e300), std::pair(1e-10, 1e-310)}) {
    EXPECT_TRUE(refuses([&] { grain(R, m); }, {"mass "}));
  }
  EXPECT_THROW(grain(1, std::numeric_limits<double>::infinity()), Error);
}

TEST(PeriodicBox, WhoseLengthOverflowsIsRefused) {
  auto box = cube<3, double>(-1.7e308, 1.7e308);
  box.periodic[2] = true;
  EXPECT_TRUE(refuses([&] { dem::Grains<3> grains(box); }, {"Box: axis 2", "upper - lower = inf"}));
}

TEST(NearestImage, IsAntisymmetricAlsoAtHalfAPeriod) {
  for (const double side : {0.1, 0.3, 1.0, 3.0, 7.1e-5}) {
    auto box = cube<2, double>(-0.4 * side, 0.6 * side);
    box.periodic.fill(true);
    const NearestImage<2, double> image(box);
    const double period = box.upper[0] - box.lower[0];
    for (const double periods : {0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 17.5}) {
      for (const double ulp : {-1.0, 0.0, 1.0}) {
        const double x = period * periods * (1 + ulp * 2.3e-16);
        const Vec<2> there = image(Vec<2>(x, -x));
        const Vec<2> back = image(Vec<2>(-x, x));
        EXPECT_TRUE(there == -back) << side << ", " << periods << " periods";
        EXPECT_LE(std::abs(there[0]), period / 2 * (1 + 1e-14));
      }
    }
  }
}

// Grains in pairs across every side, edge and corner of a periodic box, as in open space.
TEST(GrainsAtAPeriodicSide, HaveTheForcesOfOpenSpace) {
  auto box = cube<3, double>(-1, 1);
  box.periodic.fill(true);
  const dem::CundallStrack law{
      .normal_stiffness = 1, .tangential_stiffness = 0.5, .friction_angle = 0.4};
  const auto force_on_second = [&](const Box<3>& of, const Vec<3>& first, const Vec<3>& second) {
    dem::Grains<3> grains(of);
    dem::add_grain(grains, first, {.radius = 0.1, .density = 1});
    dem::add_grain(grains, second, {.radius = 0.1, .density = 1});
    grains[velocity][1] = {0.1, 0.2, -0.3};
    auto sim = simulation_of(grains, law);
    sim.step(dt);
    expect_opposite_forces(sim, "at a side");
    return Vec<3>(sim.particles()[force][1]);
  };
  for (const Vec<3>& towards :
       {Vec<3>(1, 0, 0), Vec<3>(0, -1, 0), Vec<3>(1, 0, -1), Vec<3>(-1, 1, 1), Vec<3>(1, 1, 1)}) {
    const Vec<3> along = 0.19 * towards.normalized();
    // The first grain is exactly on the upper or lower sides, the second beyond them.
    const Vec<3> across = force_on_second(box, towards, towards + along);
    const Vec<3> wrapped = force_on_second(box, towards, box.wrap(towards + along));
    const Vec<3> open = force_on_second({}, {0, 0, 0}, along);
    EXPECT_LT((across - open).norm(), 1e-13);
    EXPECT_LT((wrapped - open).norm(), 1e-13);
    EXPECT_GT(open.norm(), 0.009);
  }
}

TEST(GrainsAtHalfAPeriod, HaveTheirContactsOnBothSides) {
  // The smallest box that a search accepts: a row of two grains that touch on both sides.
  auto box = cube<3, double>(0, 4);
  box.periodic[0] = true;
  const dem::CundallStrack law{.normal_stiffness = 1};
  for (const double gap : {0.0, 1e-15, -1e-15}) {
    dem::Grains<3> grains(box);
    dem::add_grain(grains, {0, 1, 1}, {.radius = 1, .density = 1});
    dem::add_grain(grains, {2 + gap, 1, 1}, {.radius = 1, .density = 1});
    auto sim = simulation_of(grains, law);
    sim.step(dt);
    expect_opposite_forces(sim, "half a period");
    EXPECT_LE(sim.particles()[force][0].norm(), 4e-15);
  }
}

}  // namespace
}  // namespace silt::test::edges_of_grains_test
