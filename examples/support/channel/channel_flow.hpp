// SPDX-License-Identifier: MIT
// What the cases of the example channel have in common: the options, the openings, the shape of the
// walls, and what is recorded. The shapes are drawn in a vertical plane, x and height, and are
// extended in 3D along y, between two walls. Volumes are per width: in [m²].
#pragma once

#include <silt/geometry/face.hpp>
#include <silt/measure/flux.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/extraction.hpp>
#include <silt/mps/setup/inflow.hpp>
#include <silt/mps/setup/outflow.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <nlohmann/json.hpp>

#include "../findings.hpp"
#include "../flow_program.hpp"
#include "../history.hpp"

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace channel {

using namespace silt;

using support::Finding;
using support::g;
using support::History;
using support::stated;

inline constexpr double density = 1000;  // [kg/m³]
inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Options : support::FlowOptions {
  std::string name = "jump";  // of the case
  double froude = 2;          // before the jump
  double depth = 0.05;        // there [m]
  double length = 0;          // of the channel with the jump [m]; 0: enough
  double head = 0;            // over the crest or the slot [m]; 0: that of the case
  double slot = 0.1;          // its width [m]
  double viscosity = 1e-6;    // kinematic [m²/s]
  double thickness = 0.1;     // in 3D, along y [m]
};

/// Observer: where water enters and leaves, and the section through which its flow is counted.
template <int Dim>
struct Openings {
  mps::Inflow<Dim> in;
  std::optional<mps::Extraction<Dim>> drawn;  // leaves with a given velocity
  mps::Outflow<Dim> out;                      // leaves by itself
  Flux<Dim> section;

  double volume_out() const { return out.volume() + (drawn ? drawn->volume() : 0); }

  template <class Sim>
  void before_step(Sim& simulation) {
    in.before_step(simulation);
    if (drawn) drawn->before_step(simulation);
    out.before_step(simulation);
    section.before_step(simulation);
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    section.after_step(simulation);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    archive.within("in", [&] { in.transfer(archive); });
    if (drawn) archive.within("drawn", [&] { drawn->transfer(archive); });
    archive.within("out", [&] { out.transfer(archive); });
    archive.within("section", [&] { section.transfer(archive); });
  }
};

/// A case: its flow, and what is compared with theory.
template <int Dim>
struct Flow {
  mps::Fluid<Dim> water;
  mps::FlowSettings<Dim, mps::Recommended> settings;
  Openings<Dim> openings;
  Range reach;                          // along x, in which levels are measured [m]
  std::function<double(double)> bed{};  // height of the floor below x [m]
  // Further values of the record, and their names.
  std::vector<std::string> names{};
  std::function<std::vector<double>(const mps::Fluid<Dim>&)> measure{};
  std::function<std::vector<Finding>(const History&)> findings{};
  nlohmann::ordered_json numbers{};  // for the plot script
};

/// What walls of a shape drawn in the plane are made of: segments; in 3D as wide as the channel.
/// Their normals point along `normal`, as far as possible.
template <int Dim>
std::vector<Face<Dim>> faces_along(const std::vector<Vec<2>>& points, const Vec<2>& normal,
                                   double thickness) {
  std::vector<Face<Dim>> faces;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec<2>&a = points[k], &b = points[k + 1];
    if constexpr (Dim == 2) {
      faces.push_back({{a, b}});
    } else {
      const double y = thickness;
      faces.push_back({{Vec<3>(a[0], 0, a[1]), Vec<3>(b[0], 0, b[1]), Vec<3>(b[0], y, b[1])}});
      faces.push_back({{Vec<3>(a[0], 0, a[1]), Vec<3>(b[0], y, b[1]), Vec<3>(a[0], y, a[1])}});
    }
  }
  for (auto& face : faces) {
    const Vec<Dim> own = normal_of(face);
    if (own[0] * normal[0] + own[Dim - 1] * normal[1] < 0) face = reversed(face);
  }
  return faces;
}
template <int Dim>
void add_walls(mps::ImageWalls& walls, const std::vector<Vec<2>>& points, double thickness) {
  const auto more = faces_along<Dim>(points, Vec<2>::Zero(), thickness);
  auto& faces = walls.faces<Dim>();
  faces.insert(faces.end(), more.begin(), more.end());
}
/// The walls at both ends of y in 3D, over this rectangle.
template <int Dim>
void add_sides(mps::ImageWalls& walls, const Box<2>& area, double thickness) {
  if constexpr (Dim == 3) {
    const Vec<2>&a = area.lower, &b = area.upper;
    for (const double y : {0.0, thickness}) {
      walls.triangles.push_back(
          {{Vec<3>(a[0], y, a[1]), Vec<3>(b[0], y, a[1]), Vec<3>(b[0], y, b[1])}});
      walls.triangles.push_back(
          {{Vec<3>(a[0], y, a[1]), Vec<3>(b[0], y, b[1]), Vec<3>(a[0], y, b[1])}});
    }
  }
}
template <int Dim>
void set_pistons(mps::ImageWalls& walls, std::vector<mps::MovingFaces<Dim>> pistons) {
  if constexpr (Dim == 2) {
    walls.moving_2d = mps::MovingWalls<2>{.faces = std::move(pistons)};
  } else {
    walls.moving_3d = mps::MovingWalls<3>{.faces = std::move(pistons)};
  }
}

/// A vector in the plane.
template <int Dim>
Vec<Dim> in_plane(double x, double up) {
  Vec<Dim> all = Vec<Dim>::Zero();
  all[0] = x;
  all[Dim - 1] = up;
  return all;
}
/// All that is lower than this height [m].
template <int Dim>
Box<Dim> below(double height) {
  Box<Dim> box;
  box.upper[Dim - 1] = height;
  return box;
}
template <int Dim>
Box<Dim> as_wide(const Box<2>& area, double thickness) {
  Vec<Dim> lower = Vec<Dim>::Zero(), upper = Vec<Dim>::Constant(thickness);
  lower[0] = area.lower[0], lower[Dim - 1] = area.lower[1];
  upper[0] = area.upper[0], upper[Dim - 1] = area.upper[1];
  return {.lower = lower, .upper = upper};
}

/// Adds water with the pressure at rest below the top of the rectangle, and a speed along x [m/s].
template <int Dim>
void fill(mps::Fluid<Dim>& water, const Box<2>& area, const Options& o, double speed = 0) {
  for (const auto& x : lattice<Dim>(as_wide<Dim>(area, o.thickness), o.spacing)) {
    const Index i = mps::add_particle(water, x, mps::Kind::fluid);
    water[velocity][i] = in_plane<Dim>(speed, 0);
    water[mps::pressure][i] = density * g * (area.upper[1] - x[Dim - 1]);
  }
}

/// Of the water in a rectangle.
struct Content {
  double volume = 0;    // per width [m²]
  double speed = 0;     // mean [m/s]; 0 of no water
  double momentum = 0;  // ∫ (P + ρ u_x²) dV per width [N]
};
template <int Dim>
Content content_of(const mps::Fluid<Dim>& water, const Box<2>& area, const Options& o) {
  const double each = std::pow(o.spacing, Dim) / (Dim == 3 ? o.thickness : 1);
  const Box<Dim> box = as_wide<Dim>(area, o.thickness);
  Content all;
  double speeds = 0, number = 0;
  for (Index i = 0; i < water.size(); ++i) {
    if (!box.contains(water[position][i])) continue;
    const Vec<Dim> u = water[velocity][i];
    number += 1;
    speeds += u.norm();
    all.momentum += each * (water[mps::pressure][i] + density * squared(u[0]));
  }
  all.volume = number * each;
  all.speed = number > 0 ? speeds / number : 0;
  return all;
}

/// Places along x at which levels are measured [m].
inline constexpr int gauges = 24;
inline double place_of_gauge(int k, const Range& reach) {
  return reach.lower + (k + 0.5) * (reach.upper - reach.lower) / gauges;
}

/// When the findings begin: they are means of the second half [s].
inline double settled(const History& history) { return history["t"].back() / 2; }
inline double mean(const History& history, const std::string& name) {
  return support::mean_from(settled(history), history["t"], history[name]);
}
/// Of the levels at those places of the reach that are within a part of it [m].
inline double mean_level(const History& history, const Range& reach, const Range& within) {
  double sum = 0, number = 0;
  for (int k = 0; k < gauges; ++k) {
    const double x = place_of_gauge(k, reach);
    if (x < within.lower || x > within.upper) continue;
    sum += mean(history, "level_" + std::to_string(k + 1));
    number += 1;
  }
  return sum / number;
}
/// Growth of a volume per time since then [m²/s].
inline double rate(const History& history, const std::string& name) {
  const auto &t = history["t"], &volume = history[name];
  std::size_t k = 0;
  while (k + 1 < t.size() && t[k] < settled(history)) ++k;
  return (volume.back() - volume[k]) / (t.back() - t[k]);
}

/// The flow rates over that given.
inline std::vector<Finding> flow_findings(const History& history, double flow) {
  return {{.quantity = "flow that enters over that given [-]",
           .reference = 1,
           .measured = rate(history, "volume_in") / flow,
           .allowed = 0.01},
          {.quantity = "flow through the section over it [-]",
           .reference = 1,
           .measured = rate(history, "volume_passed") / flow,
           .allowed = stated},
          {.quantity = "flow that leaves over it [-]",
           .reference = 1,
           .measured = rate(history, "volume_out") / flow,
           .allowed = stated}};
}

}  // namespace channel
