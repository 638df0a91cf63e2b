// SPDX-License-Identifier: MIT
// The simulations of the live page: those of programs/, made from the numbers of the sliders,
// behind one interface. test_node.mjs compares their bits with those of the programs.
#pragma once

#include <silt/core/rotation.hpp>
#include <silt/coupled.hpp>
#include <silt/dem.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "../../tests/portability/hash.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace live {

using namespace silt;

inline constexpr double g = 9.81;  // [m/s²]

// What the colours show.
enum class Quantity { speed, pressure, spin };

// Of the curves: energies [J/m], with those of a body; the pressure at the right wall [Pa], if the
// scene has a gauge there.
struct Curves {
  double kinetic = 0;
  double potential = 0;
  double pressure = 0;
};

struct Line {
  Vec<2> from, to;  // [m]
};

// A simulation whose type the page need not know.
class Scene {
 public:
  virtual ~Scene() = default;

  // Steps while time() < until [s], at most `most` of them; returns their number.
  virtual int step_until(double until, int most) = 0;
  virtual double time() const = 0;  // [s]
  virtual double time_step() = 0;   // the last one, or the first before it [s]
  virtual Index size() const = 0;
  // Turns gravity by an angle [rad], against the clock.
  virtual void tilt(double angle) = 0;
  virtual std::uint64_t hash() const = 0;

  // Takes the state at time() for the functions below.
  virtual void observe(Quantity quantity) = 0;
  // x, y, radius [m], quantity, angle [rad], and 1 of a grain, 0 of fluid, of each particle.
  const std::vector<float>& picture() const { return picture_; }
  // x, y of both ends of each line [m].
  const std::vector<float>& walls() const { return walls_; }
  const Curves& curves() const { return curves_; }

 protected:
  template <class P, class RadiusOf>
  void add_to_picture(const P& particles, Quantity quantity, RadiusOf&& radius_of) {
    for (Index i = 0; i < particles.size(); ++i) {
      const Vec<2> x = particles[position][i];
      for (const double number :
           {x[0], x[1], radius_of(particles, i), value(particles, i, quantity),
            angle_of(particles, i), P::template has<spin_t> ? 1.0 : 0.0}) {
        picture_.push_back(float(number));
      }
    }
  }
  void show_walls(const std::vector<Line>& lines) {
    walls_.clear();
    for (const Line& line : lines) {
      for (const double number : {line.from[0], line.from[1], line.to[0], line.to[1]}) {
        walls_.push_back(float(number));
      }
    }
  }

  std::vector<float> picture_;
  std::vector<float> walls_;
  Curves curves_;

 private:
  template <class P>
  static double value(const P& particles, Index i, Quantity quantity) {
    if constexpr (P::template has<spin_t>) {
      if (quantity == Quantity::spin) return std::abs(particles[spin][i]);
    } else {
      if (quantity == Quantity::pressure) return particles[mps::pressure][i];
    }
    return particles[velocity][i].norm();
  }
  template <class P>
  static double angle_of(const P& particles, Index i) {
    if constexpr (P::template has<angle_t>) {
      return std::remainder(particles[silt::angle][i], 2 * std::numbers::pi);
    }
    return 0;
  }
};

// The gravity of a scene that is turned by an angle [rad], against the clock.
inline Vec<2> turned_gravity(double angle) {
  // Exactly that of the program.
  if (angle == 0) return {0, -g};
  return {g * std::sin(angle), -g * std::cos(angle)};
}

// Run::until is reached within this, see core/run.hpp: the scene then makes the same steps.
inline double almost(double until) { return until * (1 - 1e-12); }

// `Setup` has simulation(), lines(simulation) [m], tilt(simulation, gravity),
// before_step(simulation) and curves(simulation, particles, gravity), with those of a snapshot; it
// is kept as long as its simulation.
template <class Setup>
class SceneOf final : public Scene {
 public:
  explicit SceneOf(Setup setup) : setup_(std::move(setup)), simulation_(setup_.simulation()) {}

  int step_until(double until, int most) override {
    int steps = 0;
    for (; steps < most && time() < almost(until); ++steps) {
      setup_.before_step(simulation_);
      simulation_.step();
    }
    return steps;
  }
  double time() const override { return simulation_.time(); }
  double time_step() override {
    return simulation_.steps() > 0 ? simulation_.last_time_step() : simulation_.time_step();
  }
  Index size() const override { return simulation_.particles().size(); }
  std::uint64_t hash() const override { return portability::hash_of(simulation_); }

  void tilt(double angle) override {
    gravity_ = turned_gravity(angle);
    setup_.tilt(simulation_, gravity_);
  }

  void observe(Quantity quantity) override {
    const auto particles = simulation_.snapshot();
    picture_.clear();
    add_to_picture(particles, quantity,
                   [&](const auto& all, Index i) { return setup_.radius(all, i); });
    show_walls(setup_.lines(simulation_));
    curves_ = setup_.curves(simulation_, particles, gravity_);
  }

 private:
  Setup setup_;
  decltype(std::declval<Setup&>().simulation()) simulation_;
  Vec<2> gravity_{0, -g};
};

inline std::vector<Line> polygon(const std::vector<Vec<2>>& points) {
  std::vector<Line> lines;
  for (Index k = 1; k < points.size(); ++k) lines.push_back({points[k - 1], points[k]});
  return lines;
}
inline std::vector<Line> lines_of(const Box<2>& box) {
  return polygon({box.lower, {box.upper[0], box.lower[1]}, box.upper,
                  {box.lower[0], box.upper[1]}, box.lower});
}

// --- flows ---------------------------------------------------------------------------------------

// All are of one type, so that the module has the code for one type of simulation.
struct OfWater {
  mps::TankOf<mps::Recommended, 2> tank;
  double spacing;      // [m]
  double speed_scale;  // [m/s]
  double viscosity = 1e-6;
  bool has_gauge = false;
  // Settings of a flow do not change while it runs; the body force reads this. Without tilt it adds
  // zero, which changes no bit.
  std::shared_ptr<Vec<2>> added_gravity = std::make_shared<Vec<2>>(Vec<2>::Zero());

  auto simulation() const {
    const mps::Flow<mps::Recommended> water{
        {.spacing = spacing,
         .density = 1000,
         .viscosity = viscosity,
         .speed_scale = speed_scale,
         .walls = tank.walls,
         .body_force = [added = added_gravity](const Vec<2>&, double) { return *added; }}};
    return Simulation{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  }
  template <class Sim>
  static void before_step(Sim&) {}
  template <class Sim>
  void tilt(Sim&, const Vec<2>& gravity) const {
    *added_gravity = gravity - Vec<2>{0, -g};
  }
  template <class P>
  double radius(const P&, Index) const {
    return spacing / 2;
  }
  // Where walls and bodies are now.
  template <class Sim>
  std::vector<Line> lines(const Sim& simulation) const {
    std::vector<Line> lines;
    simulation.interaction().walls().for_each_face(
        [&](const Face<2>& face, std::uint32_t, const Vec<2>&) {
          lines.push_back({face.corners[0], face.corners[1]});
        });
    return lines;
  }
  template <class Sim, class P>
  Curves curves(const Sim& simulation, const P& water, const Vec<2>& gravity) const {
    const double mass = 1000 * spacing * spacing;
    Curves curves;
    for (Index i = 0; i < water.size(); ++i) {
      curves.kinetic += mass * water[velocity][i].squaredNorm() / 2;
      curves.potential -= mass * gravity.dot(water[position][i]);
    }
    const auto& walls = simulation.interaction().walls();
    if (walls.number_of_bodies() > 0) {
      const auto& body = walls.bodies()[0];
      const auto& of_body = body.mass_properties();
      const BodyState<2> state = body.state();
      curves.kinetic += (of_body.mass * state.velocity.squaredNorm() +
                         of_body.inertia * state.spin * state.spin) /
                        2;
      curves.potential -= of_body.mass * gravity.dot(state.position);
    }
    if (has_gauge) {
      curves.pressure = WallGauge<2>{{1.6, 0.05}, {-1, 0}, spacing}.read(water, mps::pressure);
    }
    return curves;
  }
};

// A lattice is a whole number of particles wide and high.
inline double whole(double size, double spacing) { return spacing * std::round(size / spacing); }

inline OfWater dam_break(double spacing, double width, double height, double viscosity) {
  return {.tank = mps::make_tank<mps::Recommended, 2>(
              {.column = {whole(width, spacing), whole(height, spacing)},
               .size = {.length = 1.6, .height = 1.2},
               .spacing = spacing,
               .lid = true}),
          .spacing = spacing,
          .speed_scale = std::sqrt(9.81 * height),
          .viscosity = viscosity,
          .has_gauge = true};
}

inline OfWater wave_maker(double spacing, double depth, double stroke, double frequency) {
  auto tank = mps::make_empty_tank<mps::Recommended, 2>(
      {.size = {.length = 2, .height = 0.6}, .spacing = spacing, .lid = true});
  const Vec<2> foot{1.2, 0}, top{2, 0.6};  // of the beach
  const double slope = (top[1] - foot[1]) / (top[0] - foot[0]);
  tank.walls.segments.push_back({{foot, top}});
  const double foremost = whole(0.2, spacing), X = foremost - stroke / 2;
  const Vibration<2> harmonic{
      .amplitude = {stroke / 2, 0}, .frequency = frequency, .phase = std::numbers::pi / 2};
  tank.walls.moving_2d =
      mps::MovingWalls<2>{.faces = {{.faces = polyline({{X, 0.6}, {X, 0}}), .motion = harmonic}}};
  for (const auto& x : lattice<2>({{foremost, 0}, {2, whole(depth, spacing)}}, spacing)) {
    const double above = x[1] - slope * (x[0] - foot[0]);
    if (above < 0.45 * spacing * std::hypot(1.0, slope)) continue;
    mps::add_particle(tank.particles, x, mps::Kind::fluid);
  }
  return {.tank = tank, .spacing = spacing, .speed_scale = std::sqrt(9.81 * depth)};
}

inline OfWater floating_body(double spacing, double width, double height, double density_ratio,
                             double turn) {
  auto tank =
      mps::make_tank<mps::Recommended, 2>({.column = {whole(1.6, spacing), whole(0.5, spacing)},
                                           .size = {.length = whole(1.6, spacing), .height = 1.2},
                                           .spacing = spacing,
                                           .lid = true});
  const Vec<2> centre{0.8, 0.5 + height * (0.5 - density_ratio)};
  auto box = faces_of(Box<2>{{-width / 2, -height / 2}, {width / 2, height / 2}});
  for (auto& face : box) {
    for (auto& corner : face.corners) corner = centre + rotation_by(turn) * corner;
  }
  mps::remove_inside(tank.particles, box, spacing);
  tank.walls.moving_2d =
      mps::MovingWalls<2>{.bodies = {{.faces = box, .density = 1000 * density_ratio}}};
  return {.tank = tank, .spacing = spacing, .speed_scale = std::sqrt(9.81 * 0.5)};
}

// --- grains --------------------------------------------------------------------------------------

// All have the same walls and damping, those that a scene does not use being absent or zero, so
// that the module has the code for one type of simulation.
struct OfGrains {
  dem::Grains<2> grains;
  double stiffness;  // normal [N/m]
  double restitution;
  double friction_angle;  // [rad]
  double alpha = 0;       // global damping [1/s]
  Box<2> room = {.lower = {-0.8, 0}, .upper = {0.8, 1.2}};
  double hopper = 0;        // its opening [m]; 0: none
  bool is_bed = false;      // whether it has the floor
  dem::Vibration<2> floor = {};

  static constexpr Index lid_number = 2;
  static constexpr Index floor_number = 4;
  static constexpr double opens_at = 0.6;  // the lid [s]

  dem::Polyline<> side(double sign) const {
    return {{{sign * 0.3, 1.2}, {sign * 0.3, 0.7}, {sign * hopper / 2, 0.4}}};
  }
  dem::Polyline<> lid() const { return {{{-hopper / 2, 0.4}, {hopper / 2, 0.4}}}; }

  auto simulation() const {
    const dem::CundallStrack law{.normal_stiffness = stiffness,
                                 .tangential_stiffness = stiffness / 2,
                                 .restitution = restitution,
                                 .friction_angle = friction_angle};
    const dem::Polyline<> absent{{{0, 0}, {1, 0}}};
    const bool is_hopper = hopper != 0;
    const dem::Contacts contacts{law,
                                 is_hopper ? side(-1) : absent,
                                 is_hopper ? side(1) : absent,
                                 is_hopper ? lid() : absent,
                                 dem::BoxWall<2>{room},
                                 dem::Moving{dem::Plane<2>{}, floor}};
    Simulation simulation{grains, NeighbourList<2>{},
                          Forces{Gravity<2>{{0, -g}},
                                 contacts.with({.steps_per_contact = 20})},
                          Leapfrog{GlobalDamping{.alpha = alpha}}};
    auto& walls = simulation.interaction().template part<1>();
    for (Index wall = 0; wall <= lid_number; ++wall) walls.set_wall_present(wall, is_hopper);
    walls.set_wall_present(floor_number, is_bed);
    return simulation;
  }

  template <class Sim>
  static void tilt(Sim& simulation, const Vec<2>& gravity) {
    simulation.interaction().template part<0>() = Gravity<2>{gravity};
  }
  template <class Sim>
  static void before_step(Sim& simulation) {
    auto& walls = simulation.interaction().template part<1>();
    if (walls.is_wall_present(lid_number) && simulation.time() >= almost(opens_at)) {
      walls.set_wall_present(lid_number, false);
    }
  }
  template <class P>
  static double radius(const P& grains, Index i) {
    return grains[silt::radius][i];
  }
  template <class Sim, class P>
  static Curves curves(const Sim&, const P& grains, const Vec<2>& gravity) {
    return {.kinetic = kinetic_energy(grains) + rotational_energy(grains),
            .potential = potential_energy(grains, gravity)};
  }
  template <class Sim>
  std::vector<Line> lines(const Sim& simulation) const {
    if (is_bed) {
      const double y = floor.pose_at(simulation.time()).shift[1];
      const double left = room.lower[0], right = room.upper[0];
      return {{{left, y}, {right, y}},
              {{left, -0.05}, {left, 0.74}},
              {{right, -0.05}, {right, 0.74}}};
    }
    auto lines = lines_of(room);
    if (hopper == 0) return lines;
    for (const auto& wall : {side(-1), side(1)}) {
      for (const Line& line : polygon(wall.points)) lines.push_back(line);
    }
    if (simulation.interaction().template part<1>().is_wall_present(lid_number)) {
      lines.push_back(polygon(lid().points)[0]);
    }
    return lines;
  }
};

inline OfGrains tower(double R, double friction_angle, double restitution, double alpha) {
  auto grains = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 2 * R),
                                 {.radius = R, .density = 2500});
  dem::add_grain(grains, {0.3 * R, 0.8 + 2 * R}, {.radius = R, .density = 2500});
  return {.grains = grains,
          .stiffness = 2e6,
          .restitution = restitution,
          .friction_angle = friction_angle,
          .alpha = alpha};
}

inline OfGrains vibrating_floor(double depth, double amplitude, double frequency,
                                double restitution, double friction_angle) {
  dem::Grains<2> grains;
  for (const auto& x : lattice<2>({{-0.5, 0.02}, {0.5, 0.02 + depth}}, 0.02)) {
    Random random{.seed = 1, .id = grains.size()};
    const double R = random.uniform({0.008, 0.0095});
    const Index i = dem::add_grain(grains, x, {.radius = R, .density = 2500});
    grains[velocity][i] = {0.2 * random.normal(), 0};
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {.grains = grains,
          .stiffness = 4e6,
          .restitution = restitution,
          .friction_angle = friction_angle,
          .room = {.lower = {-0.5, -infinity}, .upper = {0.5, infinity}},
          .is_bed = true,
          .floor = {.amplitude = {0, amplitude}, .frequency = frequency}};
}

inline OfGrains hopper(double R, double opening, double friction_angle, double restitution) {
  require_positive("hopper: opening", opening);
  dem::Grains<2> grains;
  for (const auto& x : lattice<2>({{-0.28, 0.72}, {0.28, 1.04}}, 2.45 * R)) {
    Random random{.seed = 1, .id = grains.size()};
    dem::add_grain(grains, x, {.radius = R * random.uniform({0.8, 1.2}), .density = 2500});
  }
  return {.grains = grains,
          .stiffness = 1e6,
          .restitution = restitution,
          .friction_angle = friction_angle,
          .hopper = opening};
}

// --- both ----------------------------------------------------------------------------------------

// β = ½ μ C Re ε⁻³ [kg/s] per metre of depth. C = (0.93 + 2.4/√Re)² is within 12 % of that of a
// single cylinder (White 1974); cbrt and pow would have other last bits in other C libraries.
struct DiscDrag {
  static constexpr int dimension = 2;
  static double coefficient(const coupled::GrainInFluid& at) {
    const double root = 0.93 * std::sqrt(at.reynolds()) + 2.4;
    const double e = at.fluid_fraction;
    return root * root * at.viscosity / (2 * e * e * e);
  }
};

inline auto landslide(double spacing, double depth, const std::vector<Vec<2>>& basin,
                      const mps::FluidInMixture<2>& water, const coupled::GrainsInFluid<2>& slide,
                      const std::shared_ptr<Vec<2>>& added_gravity) {
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 3e5,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  const mps::Flow<mps::InMixture<>> flow{
      {.spacing = spacing,
       .density = 1000,
       .viscosity = 1e-6,
       .radius = 4.1,
       .laplacian_radius = 4.1,
       .speed_scale = std::sqrt(9.81 * depth),
       .walls = {.segments = polyline(basin)},
       .body_force = [added_gravity](const Vec<2>&, double) { return *added_gravity; }}};
  return coupled::Coupled{
      Simulation{slide, NeighbourList<2>{},
                 Forces{Gravity<2>{{0, -g}}, dem::Contacts{law, dem::Polyline<>{basin}},
                        coupled::FluidForces{DiscDrag{}}},
                 Leapfrog{}},
      Simulation{water, UniformGrid<2>{}, flow, SemiImplicit<>{}}};
}

class Landslide final : public Scene {
 public:
  Landslide(double spacing, double depth, double slope, double diameter, double density)
      : spacing_(spacing) {
    require_positive("landslide: slope", slope);
    require_positive("landslide: diameter", diameter);
    const double foot = 0.8, top = slope * foot;
    basin_ = {{0, top}, {foot, 0}, {2, 0}, {2, top}, {0, top}};
    const auto above_slope = [&](const Vec<2>& x) {
      return (x[1] - slope * (foot - x[0])) / std::sqrt(1 + slope * slope);
    };
    mps::FluidInMixture<2> water;
    for (const auto& x : lattice<2>({{0, 0}, {2, whole(depth, spacing)}}, spacing)) {
      if (above_slope(x) < 0.45 * spacing) continue;
      mps::add_particle(water, x, mps::Kind::fluid);
    }
    coupled::GrainsInFluid<2> slide;
    const double highest = std::min(depth + 0.4, top - diameter / 2);
    if (!(highest > depth + 0.1 + 1.05 * diameter && slope < 5)) {
      fail({"landslide: depth = ", depth, " m and slope = ", slope,
            " leave no room for discs on the slope above the water; give less depth, and a slope "
            "of about 1"});
    }
    for (const auto& x : lattice<2>({{0, depth + 0.1}, {foot, highest}}, 1.05 * diameter)) {
      if (above_slope(x) < diameter / 2 || above_slope(x) > 0.1) continue;
      dem::add_grain(slide, x, {.radius = diameter / 2, .density = density});
    }
    both_.emplace(landslide(spacing, depth, basin_, water, slide, added_gravity_));
  }

  int step_until(double until, int most) override {
    int steps = 0;
    for (; steps < most && time() < almost(until); ++steps) both_->step();
    return steps;
  }
  double time() const override { return both_->time(); }
  double time_step() override {
    return both_->steps() > 0 ? both_->last_time_step() : both_->time_step();
  }
  Index size() const override {
    return both_->fluid().particles().size() + both_->grains().particles().size();
  }
  std::uint64_t hash() const override { return portability::hash_of(*both_); }

  void tilt(double angle) override {
    gravity_ = turned_gravity(angle);
    *added_gravity_ = gravity_ - Vec<2>{0, -g};
    both_->grains().interaction().template part<0>() = Gravity<2>{gravity_};
  }

  void observe(Quantity quantity) override {
    const auto water = both_->fluid().snapshot();
    const auto grains = both_->grains().snapshot();
    picture_.clear();
    add_to_picture(water, quantity, [&](const auto&, Index) { return spacing_ / 2; });
    add_to_picture(grains, quantity, [](const auto& all, Index i) { return all[radius][i]; });
    show_walls(polygon(basin_));
    const double mass = 1000 * spacing_ * spacing_;
    curves_ = {.kinetic = kinetic_energy(grains) + rotational_energy(grains),
               .potential = potential_energy(grains, gravity_)};
    for (Index i = 0; i < water.size(); ++i) {
      curves_.kinetic += mass * water[velocity][i].squaredNorm() / 2;
      curves_.potential -= mass * gravity_.dot(water[position][i]);
    }
  }

 private:
  using Both = decltype(landslide(1, 1, {}, {}, {}, {}));

  double spacing_;
  std::vector<Vec<2>> basin_;
  std::shared_ptr<Vec<2>> added_gravity_ = std::make_shared<Vec<2>>(Vec<2>::Zero());
  std::optional<Both> both_;
  Vec<2> gravity_{0, -g};
};

// --- all -----------------------------------------------------------------------------------------

inline constexpr std::array names{"dam_break",  "tower",         "vibrating_floor", "hopper",
                                  "wave_maker", "floating_body", "landslide"};

// The end of the program of the same name [s].
inline constexpr std::array ends{1.0, 1.5, 2.0, 2.5, 3.0, 2.0, 2.0};

// More take a browser seconds for a step, and many more exceed the memory of the module.
inline constexpr double max_particles = 20000;

// About the number of particles of a scene, known before any is made. A side that is not positive
// gives 0: Silt refuses it, and its message says why.
inline double estimated_size(Index scene, const std::array<double, 5>& numbers) {
  const double area = std::array{std::min(numbers[1], 1.6) * std::min(numbers[2], 1.2),
                                 0.2 * 0.8,
                                 numbers[0],
                                 0.56 * 0.32,
                                 1.8 * std::min(numbers[1], 0.6),
                                 1.6 * 0.5,
                                 1.6 * std::min(numbers[1], 1.0)}[scene];
  const double side = std::array{numbers[0],
                                 2 * numbers[0],
                                 0.02,
                                 2.45 * numbers[0],
                                 numbers[0],
                                 numbers[0],
                                 std::min(numbers[0], 2 * numbers[3])}[scene];
  return side > 0 ? area / (side * side) : 0;
}

// The numbers in the order of the constants at the top of the program of the same name.
inline std::unique_ptr<Scene> make_scene(Index scene, const std::array<double, 5>& numbers) {
  const auto [a, b, c, d, e] = numbers;
  if (scene < names.size() && estimated_size(scene, numbers) > max_particles) {
    fail(std::string("live: ") + names[scene] + " would have about " +
         to_text(estimated_size(scene, numbers)) + " particles, more than the " +
         to_text(max_particles) + " of this page; give larger or fewer ones");
  }
  switch (scene) {
    case 0:
      return std::make_unique<SceneOf<OfWater>>(dam_break(a, b, c, d));
    case 1:
      return std::make_unique<SceneOf<OfGrains>>(tower(a, b, c, d));
    case 2:
      return std::make_unique<SceneOf<OfGrains>>(vibrating_floor(a, b, c, d, e));
    case 3:
      return std::make_unique<SceneOf<OfGrains>>(hopper(a, b, c, d));
    case 4:
      return std::make_unique<SceneOf<OfWater>>(wave_maker(a, b, c, d));
    case 5:
      return std::make_unique<SceneOf<OfWater>>(floating_body(a, b, c, d, e));
    case 6:
      return std::make_unique<Landslide>(a, b, c, d, e);
    default:
      fail("live: scene = " + std::to_string(scene) + " does not exist; give one below 7");
  }
}

// Of the programs.
inline constexpr std::array<double, 5> defaults[] = {
    {0.028, 0.4, 0.8, 1e-6},     {0.0125, 0.46, 0.5, 0.5}, {0.16, 0.012, 9, 0.6, 0.3},
    {0.0095, 0.12, 0.46, 0.5},   {0.02, 0.24, 0.08, 1.1},  {0.025, 0.3, 0.2, 0.5, 0.5},
    {0.025, 0.2, 1, 0.016, 2500}};

}  // namespace live
