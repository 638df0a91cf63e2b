// SPDX-License-Identifier: MIT
// A model of walls that mirrors the fluid: a floor without particles, in this file alone. Images
// enter every operator, so that fluid on the floor is what it would be inside the fluid.
// Only with --all: a model of walls that no scheme has; image_walls_test.cpp mirrors fluid in faces.
#include "support/fluid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::test::images_of_walls_test {
namespace {

/// A floor at x[Dim − 1] = 0 in which the fluid above it is mirrored.
struct MirroredFloor {
  template <int Dim, class Real>
  class InFlow;
};

/// The image of a particle in the floor.
template <int Dim, class Real>
struct ImageInFloor {
  using Vec = silt::Vec<Dim, Real>;
  static constexpr bool is_image = true;

  Index index;  // of the particle
  Vec r_ij;
  Real weight;
  Real weight_over_square;
  Real height;  // of the particle above the floor [m]

  mps::Kind kind(const auto&) const { return mps::Kind::dummy; }
  Vec mirrored(const auto& u) const {
    Vec velocity = u[index];
    velocity[Dim - 1] = -velocity[Dim - 1];
    return velocity;
  }
  // As if it did not change along the vertical.
  bool continues_flow() const { return true; }
  Vec velocity(const auto& u) const { return u[index]; }
  Real rise_along(const auto& u) const { return rise(u[index]); }
  Real rise(const Vec& gradient) const { return -2 * height * gradient[Dim - 1]; }
};

template <int Dim, class RealType>
class MirroredFloor::InFlow {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  explicit InFlow(const MirroredFloor&) {}

  template <class P, class Operators>
  void find(const P& particles, const Operators& operators) {
    const auto& neighbourhood = operators.neighbourhood();
    const auto& stencil = operators.stencil();
    images_.assign(particles.size(), {});
    for_each(particles.size(), [&](Index i) {
      const auto add = [&](Index j) {
        const Vec x_i = neighbourhood.position_of(i), x_j = neighbourhood.position_of(j);
        Vec r_ij = x_j - x_i;
        r_ij[Dim - 1] = -x_j[Dim - 1] - x_i[Dim - 1];
        if (r_ij.norm() < stencil.re) images_[i].push_back({j, r_ij, x_j[Dim - 1]});
      };
      add(i);
      const auto row = neighbourhood[i];
      for (Index k = 0; k < row.size(); ++k) add(row.index[k]);
    });
  }
  template <class T, class F>
  void for_each_image(Index i, const T& stencil, F&& f) const {
    for (const auto& [j, r_ij, height] : images_[i]) {
      const Real r2 = r_ij.squaredNorm();
      const Real w = stencil.weight(std::sqrt(r2));
      f(ImageInFloor<Dim, Real>{j, r_ij, w, w / r2, height});
    }
  }

  template <class View, class U>
  Real divergence(const View& at, const U& u) const {
    return mps::divergence(at.stencil(), Vec(u[at.index()]), at.values_of(u));
  }
  bool is_dry(const auto&) const { return false; }
  bool has_pressure(mps::Kind of_kind, bool) const { return of_kind == mps::Kind::fluid; }

  template <class Pairs, class Model>
  Vec velocity_change(const Pairs& pairs, const Model& collision) const {
    Vec change = Vec::Zero();
    pairs.for_each([&](const auto& pair, Index) { change += collision.velocity_change(pair); });
    return change;
  }

 private:
  struct Place {
    Index index;
    Vec r_ij;
    Real height;
  };
  std::vector<std::vector<Place>> images_;
};

static_assert(mps::WallModel<MirroredFloor>);
static_assert(mps::AddsImages<MirroredFloor::InFlow<2, double>>);
static_assert(!mps::AddsImages<mps::SmoothWalls::InFlow<2, double>>);

struct OnFloor : mps::RecommendedForWallParticles {
  MirroredFloor walls{};
};

constexpr double l0 = 0.02;   // [m]
constexpr int columns = 12, rows = 10;

// A layer of water on the floor, periodic along the others, with the pressure of fluid at rest.
template <int Dim>
mps::Fluid<Dim> layer() {
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) {
    box.lower[k] = k == Dim - 1 ? -1 : 0;
    box.upper[k] = k == Dim - 1 ? 1 : columns * l0;
    box.periodic[static_cast<std::size_t>(k)] = k != Dim - 1;
  }
  mps::Fluid<Dim> fluid(box);
  Vec<Dim> size = Vec<Dim>::Constant(columns * l0);
  size[Dim - 1] = rows * l0;
  for (const auto& x : lattice<Dim>({Vec<Dim>::Zero(), size}, l0)) {
    const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
    fluid[mps::pressure][i] = 1000 * 9.81 * std::max(0.0, (rows - 0.5) * l0 - x[Dim - 1]);
  }
  return fluid;
}

template <int Dim>
auto at_rest() {
  return Simulation{layer<Dim>(), UniformGrid<Dim>{},
                    mps::Flow<OnFloor, Dim>{{.spacing = l0, .speed_scale = 1.4}}, SemiImplicit<>{}};
}

template <int Dim>
void expect_full_density_at_the_floor() {
  auto sim = at_rest<Dim>();
  sim.step();
  const auto& water = sim.particles();
  const double n0 = sim.interaction().stencil().n0;
  for (Index i = 0; i < water.size(); ++i) {
    if (water[position][i][Dim - 1] > 5 * l0) continue;
    EXPECT_NEAR(water[mps::number_density][i] / n0, 1, 1e-12);
    EXPECT_FALSE(water[mps::surface][i]);
  }
}
TEST(ImagesOfWalls, CompleteTheDensityOfTheLattice) {
  expect_full_density_at_the_floor<2>();
  expect_full_density_at_the_floor<3>();
}

// Images count as neighbours: only the upper rows are on the surface.
TEST(ImagesOfWalls, AreCountedAsNeighbours) {
  struct ByCount : OnFloor {
    mps::CountSurface surface{.beta = 0.9};
  };
  Simulation sim{layer<2>(), UniformGrid<2>{},
                 mps::Flow<ByCount>{{.spacing = l0, .speed_scale = 1.4}}, SemiImplicit<>{}};
  sim.step();
  for (Index i = 0; i < sim.particles().size(); ++i) {
    if (sim.particles()[position][i][1] > (rows - 2) * l0) continue;
    EXPECT_FALSE(sim.particles()[mps::surface][i]);
  }
}

template <int Dim>
void expect_rest() {
  auto sim = at_rest<Dim>();
  for (int k = 0; k < 50; ++k) sim.step();
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    const double depth = (rows - 0.5) * l0 - water[position][i][Dim - 1];
    EXPECT_LT(water[velocity][i].norm(), 1e-5);
    EXPECT_NEAR(water[mps::pressure][i], 1000 * 9.81 * depth, 1e-2);
  }
}
TEST(ImagesOfWalls, KeepFluidAtRestWithThePressureOfItsDepth) {
  expect_rest<2>();
  expect_rest<3>();
}

// The rows that do not see the surface.
TEST(ImagesOfWalls, StopFluidThatFallsOnTheFloorInOneStep) {
  auto water = layer<2>();
  for (Index i = 0; i < water.size(); ++i) {
    water[velocity][i] = {0, -1};
    water[mps::pressure][i] = 0;
  }
  Simulation sim{water, UniformGrid<2>{},
                 mps::Flow<OnFloor>{{.spacing = l0, .gravity = {0, 0}, .speed_scale = 1}},
                 SemiImplicit<>{}};
  sim.step();
  const auto& after = sim.particles();
  for (Index i = 0; i < after.size(); ++i) {
    const double y = after[position][i][1] / l0;
    if (y > 7) continue;
    EXPECT_LT(std::abs(after[velocity][i][1]), 1e-3);
  }
}

TEST(ImagesOfWalls, LetFluidSlipAlongTheFloor) {
  auto water = layer<2>();
  for (Index i = 0; i < water.size(); ++i) water[velocity][i] = {1, 0};
  Simulation sim{water, UniformGrid<2>{},
                 mps::Flow<OnFloor>{{.spacing = l0, .speed_scale = 1.4}}, SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step();
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_LT((sim.particles()[velocity][i] - Vec<2>(1, 0)).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace silt::test::images_of_walls_test
