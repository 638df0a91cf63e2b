// SPDX-License-Identifier: MIT
// Properties of the operators: on a full lattice they are exact for low-order polynomials; for any
// arrangement, gradient (18) conserves momentum, and (4) is zero for uniform pressure.
#include <silt/mps/operator/velocity_gradient.hpp>
#include <silt/mps/wall/divergence_with_images.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test::operators_test {
namespace {

using mps::ConservingGradient;
using mps::CubicKernel;
using mps::GaussianKernel;
using mps::InverseKernel;
using mps::MinimumGradient;

static_assert(mps::Gradient<MinimumGradient, 2> && mps::Gradient<MinimumGradient, 3, float>);
static_assert(mps::Gradient<ConservingGradient, 3> && mps::Gradient<ConservingGradient, 2, float>);
static_assert(!mps::Gradient<CubicKernel, 2> && !mps::Gradient<int, 3>);
struct ScalarGradient {
  template <class T, class Real, class Neighbours>
  static const char* evaluate(const T&, Real, Neighbours&&) {
    return "";
  }
};
static_assert(!mps::Gradient<ScalarGradient, 2>);

// Helpers for one dimension and precision.
template <class S>
struct Setting {
  static constexpr int dim = S::dimension;
  using Real = typename S::Real;
  using Vec = typename S::Vec;

  template <class K>
  using Stencil = mps::Stencil<dim, Real, K>;

  static constexpr Real l0 = Real(0.1);

  template <class K>
  static Stencil<K> stencil(double radius, Real spacing = l0) {
    return Stencil<K>({.spacing = spacing, .radius = radius});
  }

  // Values of a function of space at owned and ghost particles.
  template <class P, class F>
  static auto values(const P& particles, F&& f) {
    using Value = std::remove_cvref_t<decltype(f(Vec()))>;
    std::vector<Value> all;
    for (const auto& x : particles.with_ghosts(position)) all.push_back(f(x));
    return all;
  }

  template <class G, class T, class Search, class Phi>
  static Vec gradient(const Search& search, const T& stencil, Index i, const Phi& phi) {
    return G::evaluate(stencil, phi[i], [&](auto&& f) {
      mps::for_each_weighted(search, i, stencil, [&](Index j, const Vec& r_ij, Real w, Real w_r2) {
        f(phi[j], r_ij, w, w_r2);
      });
    });
  }

  static Vec slope() {
    Vec a;
    for (int k = 0; k < dim; ++k) a[k] = Real(1) / Real(k + 2) - Real(0.4);
    return a;
  }

  // f(particles, search, stencil) on full periodic lattices, with every kernel and the usual radii.
  template <class F>
  static void on_full_lattices(F&& f) {
    for (const double radius : {1.5, 2.1, 3.1}) {
      auto particles = full_box<dim, Real>(8, l0);
      UniformGrid<dim, Real> search({.radius = Real(radius) * l0});
      search.update(particles);
      f(particles, search, stencil<InverseKernel>(radius));
      f(particles, search, stencil<GaussianKernel>(radius));
      f(particles, search, stencil<CubicKernel>(radius));
    }
  }
};

template <class S>
class Operators : public ::testing::Test {};
TYPED_TEST_SUITE(Operators, Spaces);

TYPED_TEST(Operators, BothGradientsAreExactForALinearFieldOnAFullLattice) {
  using On = Setting<TypeParam>;
  using Real = typename TypeParam::Real;
  On::on_full_lattices([&](const auto& particles, const auto& search, const auto& stencil) {
    const auto a = On::slope();
    const auto phi = On::values(particles, [&](const auto& x) { return a.dot(x) + Real(0.3); });
    for (Index i = 0; i < particles.size(); i += 7) {
      const auto by4 = On::template gradient<MinimumGradient>(search, stencil, i, phi);
      const auto by18 = On::template gradient<ConservingGradient>(search, stencil, i, phi);
      EXPECT_LE((by4 - a).norm(), TypeParam::rounding);
      EXPECT_LE((by18 - a).norm(), TypeParam::rounding * 10);  // φ_j + φ_i is large over l0
    }
  });
}

TYPED_TEST(Operators, DivergenceIsExactForALinearVelocityOnAFullLattice) {
  using On = Setting<TypeParam>;
  using Vec = typename TypeParam::Vec;
  constexpr int dim = TypeParam::dimension;
  using Real = typename TypeParam::Real;
  Eigen::Matrix<Real, dim, dim> m;
  for (int r = 0; r < dim; ++r) {
    for (int c = 0; c < dim; ++c) m(r, c) = Real(r + 1) / Real(c + 2);
  }
  On::on_full_lattices([&](const auto& particles, const auto& search, const auto& stencil) {
    const auto u = On::values(particles, [&](const auto& x) { return Vec(m * x); });
    for (Index i = 0; i < particles.size(); i += 7) {
      EXPECT_NEAR(mps::divergence(search, stencil, i, u), m.trace(), TypeParam::rounding);
    }
  });
}

TYPED_TEST(Operators, DivergenceOfARigidRotationIsZero) {
  using On = Setting<TypeParam>;
  // For any arrangement: u_j − u_i is perpendicular to r_ij.
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  constexpr int dim = TypeParam::dimension;
  auto particles = blob<dim, Real>(6, On::l0, Real(0.3));
  UniformGrid<dim, Real> search({.radius = Real(3.1) * On::l0});
  search.update(particles);
  const auto u = On::values(particles, [&](const auto& x) {
    Vec rotation = Vec::Zero();
    rotation[0] = -x[1];
    rotation[1] = x[0];
    return rotation;
  });
  const auto stencil = On::template stencil<CubicKernel>(3.1);
  for (Index i = 0; i < particles.size(); ++i) {
    EXPECT_NEAR(mps::divergence(search, stencil, i, u), 0, TypeParam::rounding);
  }
}

TYPED_TEST(Operators, LaplacianIsExactForAQuadraticFieldOnAFullLattice) {
  using On = Setting<TypeParam>;
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  Eigen::Matrix<Real, dim, dim> m;
  for (int r = 0; r < dim; ++r) {
    for (int c = 0; c < dim; ++c) m(r, c) = Real(1 + r * c) / Real(r + c + 1);
  }
  On::on_full_lattices([&](const auto& particles, const auto& search, const auto& stencil) {
    const auto a = On::slope();
    const auto phi = On::values(
        particles, [&](const auto& x) { return Real(x.dot(m * x)) + a.dot(x) - Real(0.2); });
    for (Index i = 0; i < particles.size(); i += 7) {
      // Round-off of φ over l0².
      EXPECT_NEAR(mps::laplacian(search, stencil, i, phi), 2 * m.trace(),
                  TypeParam::rounding / squared(On::l0));
    }
  });
}

TYPED_TEST(Operators, LaplacianOfAVectorIsThatOfItsComponents) {
  using On = Setting<TypeParam>;
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  constexpr int dim = TypeParam::dimension;
  auto particles = blob<dim, Real>(6, On::l0, Real(0.2));
  UniformGrid<dim, Real> search({.radius = Real(3.1) * On::l0});
  search.update(particles);
  give_random_velocities(particles, Real(1), 5);
  const auto u = particles[velocity];
  const auto stencil = On::template stencil<CubicKernel>(3.1);
  for (Index i = 0; i < particles.size(); i += 5) {
    const Vec whole = mps::laplacian(search, stencil, i, u);
    for (int k = 0; k < dim; ++k) {
      std::vector<Real> component;
      for (const auto& v : u) component.push_back(v[k]);
      EXPECT_NEAR(whole[k], mps::laplacian(search, stencil, i, component),
                  TypeParam::rounding * whole.norm());
    }
  }
}

TYPED_TEST(Operators, OnlyTheConservingGradientConservesMomentum) {
  using On = Setting<TypeParam>;
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  constexpr int dim = TypeParam::dimension;
  auto particles = blob<dim, Real>(6, On::l0, Real(0.3));
  UniformGrid<dim, Real> search({.radius = Real(3.1) * On::l0});
  search.update(particles);
  const auto stencil = On::template stencil<CubicKernel>(3.1);
  std::vector<Real> phi;
  for (const auto& x : random_points(particles.size(), cube<dim, Real>(0, 1), 3)) {
    phi.push_back(x[0]);
  }
  Vec by4 = Vec::Zero();
  Vec by18 = Vec::Zero();
  Real size = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    const Vec each = On::template gradient<ConservingGradient>(search, stencil, i, phi);
    by4 += On::template gradient<MinimumGradient>(search, stencil, i, phi);
    by18 += each;
    size += each.norm();
  }
  EXPECT_LE(by18.norm(), TypeParam::rounding * size);
  EXPECT_GT(by4.norm(), Real(1e-3) * size);
}

TYPED_TEST(Operators, OnlyTheConservingGradientIsNotZeroForUniformPressure) {
  using On = Setting<TypeParam>;
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  auto particles = blob<dim, Real>(6, On::l0, Real(0.1));
  UniformGrid<dim, Real> search({.radius = Real(3.1) * On::l0});
  search.update(particles);
  const std::vector<Real> phi(particles.size(), 1000);
  const auto stencil = On::template stencil<CubicKernel>(3.1);
  const auto centre = TypeParam::Vec::Constant(3 * On::l0).eval();
  for (Index i = 0; i < particles.size(); ++i) {
    EXPECT_EQ((On::template gradient<MinimumGradient>(search, stencil, i, phi).norm()), 0);
  }
  // The force −∇P on a corner particle points outwards.
  const auto corner = On::template gradient<ConservingGradient>(search, stencil, 0, phi);
  EXPECT_LT(-corner.dot(centre - particles[position][0]), 0);
}

TYPED_TEST(Operators, MinimumGradientIsNeverAttractive) {
  using On = Setting<TypeParam>;
  // Every term is repulsive because φ_j ≥ φ̂: −∇φ·r_ij ≤ 0 for a single neighbour.
  using Real = typename TypeParam::Real;
  using Vec = typename TypeParam::Vec;
  auto two = fluid_at<TypeParam::dimension, Real>({Vec(Vec::Zero()), Vec(On::l0 * Vec::Unit(0))});
  UniformGrid<TypeParam::dimension, Real> search({.radius = Real(3.1) * On::l0});
  search.update(two);
  const auto stencil = On::template stencil<CubicKernel>(3.1);
  for (const auto& phi : {std::array<Real, 2>{-3, 7}, std::array<Real, 2>{7, -3}}) {
    EXPECT_GE((On::template gradient<MinimumGradient>(search, stencil, 0, phi)[0]), 0);
    EXPECT_LE((On::template gradient<MinimumGradient>(search, stencil, 1, phi)[0]), 0);
  }
}

// Maximum errors of gradient, divergence and Laplacian in a periodic box of side 1, for a sine
// along each axis.
template <int Dim>
std::array<double, 3> errors_on_a_sine(int along) {
  const double k = 2 * std::numbers::pi;
  auto particles = full_box<Dim, double>(along, 1.0 / along);
  UniformGrid<Dim> search({.radius = 3.1 / along});
  search.update(particles);
  const mps::Stencil<Dim, double, CubicKernel> stencil({.spacing = 1.0 / along, .radius = 3.1});
  std::vector<double> phi;
  std::vector<Vec<Dim>> u;
  for (const auto& x : particles.with_ghosts(position)) {
    phi.push_back(0);
    u.push_back(Vec<Dim>::Zero());
    for (int d = 0; d < Dim; ++d) {
      phi.back() += std::sin(k * x[d]);
      u.back()[d] = std::sin(k * x[d]);
    }
  }
  std::array<double, 3> error{};
  for (Index i = 0; i < particles.size(); ++i) {
    const Vec<Dim>& x = particles[position][i];
    const Vec<Dim> slope = k * (k * x).array().cos();
    const Vec<Dim> gradient = ConservingGradient::evaluate(stencil, phi[i], [&](auto&& f) {
      mps::for_each_weighted(search, i, stencil, [&](Index j, const Vec<Dim>& r_ij, double w,
                                                     double w_r2) { f(phi[j], r_ij, w, w_r2); });
    });
    error[0] = std::max(error[0], (gradient - slope).norm());
    error[1] = std::max(error[1], std::abs(mps::divergence(search, stencil, i, u) - slope.sum()));
    error[2] = std::max(error[2],
                        std::abs(mps::laplacian(search, stencil, i, phi) + k * k * phi[i]));
  }
  return error;
}

template <int Dim>
void expect_second_order(int coarse) {
  const auto error = errors_on_a_sine<Dim>(coarse);
  const auto error_of_half = errors_on_a_sine<Dim>(2 * coarse);
  for (const Index k : {0u, 1u, 2u}) {
    EXPECT_NEAR(std::log2(error[k] / error_of_half[k]), 2, 0.1) << "operator " << k;
  }
}

TEST(OperatorsOnSmoothFields, ConvergeToSecondOrderInTheSpacing) {
  expect_second_order<2>(20);
  expect_second_order<3>(16);
}

// Faces hide a part of every particle, and show no images.
struct HalfSeen {
  static bool sees_all(Index) { return false; }
  static double visible_share(Index, Index) { return 0.5; }
  static void for_each_image(Index, const auto&, const auto&) {}
};

// Of the first particle.
struct OfFirst {
  static constexpr bool have_equal_volumes = true;
  mps::Stencil<2, double, CubicKernel> of_flow;
  mps::Neighbourhood<2, double> found = {};

  static Index index() { return 0; }
  const auto& stencil() const { return of_flow; }
  const auto& neighbourhood() const { return found; }
};

// That a neighbour of which a part is hidden counts by that part up to the effective radius. Cut
// off before it, the source of the pressure jumps as particles pass, by round-off.
TEST(DivergenceWithImages, HasTheShareThatIsSeenUpToTheEffectiveRadius) {
  constexpr double spacing = 0.1;
  OfFirst at{mps::Stencil<2, double, CubicKernel>({.spacing = spacing, .radius = 3.1})};
  const double re = at.stencil().re;
  for (const double short_of_it : {0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const double r = re * (1 - short_of_it);
    mps::Fluid<2> fluid;
    mps::add_particle(fluid, {0, 0}, mps::Kind::fluid);
    mps::add_particle(fluid, {r, 0}, mps::Kind::fluid);
    UniformGrid<2> grid;
    grid.set_radius(re);
    grid.update(fluid);
    at.found.find(fluid, grid, at.stencil(), HalfSeen{});
    struct {
      bool misses_neighbours = false;
      mps::VelocityGradient<2, double> gradient = {};
    } flow;
    const std::vector<Vec<2>> u{{0, 0}, {2, 0}};
    const double of_whole = -at.stencil().slope(r) / at.stencil().slope_sum * 2;
    EXPECT_NEAR((mps::divergence_with_images<2, double>(at, HalfSeen{}, flow, u)), of_whole / 2,
                1e-6 * of_whole)
        << r / re;
  }
}

}  // namespace
}  // namespace silt::test::operators_test
