// SPDX-License-Identifier: MIT
// A slide of grains down a slope into a channel, and the wave that it makes. The amplitude of its
// first crest is compared with that of V. Heller, W.H. Hager, "Impulse product parameter in
// landslide generated impulse waves", Journal of Waterway, Port, Coastal, and Ocean Engineering 136
// (2010) 145–155, from 211 experiments with granular slides, which scatters by 30 %:
//
//   a/h = 4/9 P^(4/5),   P = F S^(1/2) M^(1/4) cos^(1/2)(6/7 α)
//
// with F = V/√(g h), V the speed of the centre of the slide when its front reaches the water, S its
// thickness over h, M its mass over ρ b h², and α the angle of the slope.
//
//   landslide --out out/landslide
//   landslide --dimension 2 --spacing 0.01 --out out/landslide_2d
//   examples/plot_landslide.py out/landslide
//
// The floor is z = 0, y = 0 in 2D, for x > 0; the slope is to the left of it.
#include <silt/coupled.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/polyline.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/mps/filling/fill.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/coupled_program.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

struct Options : support::CoupledOptions {
  double depth = 0.2;             // h of the water [m]
  double length = 3;              // of the floor [m]
  double thickness = 0.075;       // of the channel in 3D, along y [m]
  double angle = 45;              // α of the slope [degrees]
  double slide_length = 0.4;      // of the slide, along the slope [m]
  double slide_thickness = 0.06;  // across it [m]
  double distance = 0.4;          // of the slide from the water, along the slope [m]

  double slope() const { return angle * std::numbers::pi / 180; }
  double shore() const { return -depth / std::tan(slope()); }  // x of the waterline [m]
  double top() const {                                         // of the walls [m]
    return depth + (distance + slide_length) * std::sin(slope()) + 4 * spacing;
  }
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  add_option(app, "--depth", o.depth, "of the water [m]", positive());
  add_option(app, "--length", o.length, "of the floor [m]", positive());
  add_option(app, "--thickness", o.thickness, "of the channel in 3D, along y [m]", positive());
  add_option(app, "--angle", o.angle, "of the slope [degrees]", between({20, 80}));
  add_option(app, "--slide-length", o.slide_length, "of the slide, along the slope [m]",
             positive());
  add_option(app, "--slide-thickness", o.slide_thickness, "of the slide, across the slope [m]",
             positive());
  add_option(app, "--distance", o.distance, "of the slide from the water, along the slope [m]",
             positive());
  support::describe_coupled(app, o, "landslide.csv, frames.pvd and summary.json");
}

// --- the channel ---------------------------------------------------------------------------------

// Slope, floor and the wall at the far end, from above to above.
std::vector<Vec<2>> profile(const Options& o) {
  const double top = o.top();
  return {{-top / std::tan(o.slope()), top}, {0, 0}, {o.length, 0}, {o.length, top}};
}
template <int Dim>
std::vector<Face<Dim>> channel(const Options& o) {
  const auto line = profile(o);
  std::vector<Face<Dim>> faces;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    if constexpr (Dim == 2) {
      faces.push_back({{line[k], line[k + 1]}});
    } else {
      const auto at = [&](const Vec<2>& x, double y) { return Vec<3>(x[0], y, x[1]); };
      const Vec<3> a = at(line[k], 0), b = at(line[k + 1], 0);
      const Vec<3> c = at(line[k + 1], o.thickness), d = at(line[k], o.thickness);
      faces.push_back({{a, b, c}});
      faces.push_back({{a, c, d}});
    }
  }
  if constexpr (Dim == 3) {
    for (const double y : {0.0, o.thickness}) {
      for (const auto& [i, j, k] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        const auto at = [&](int n) {
          const Vec<2>& x = line[std::size_t(n)];
          return Vec<3>(x[0], y, x[1]);
        };
        faces.push_back({{at(i), at(j), at(k)}});
      }
    }
  }
  return faces;
}
template <int Dim>
auto contacts_of(const Options& o) {
  if constexpr (Dim == 2) {
    return dem::Contacts{support::law_of<2>(o), dem::Polyline<>{profile(o)}};
  } else {
    return dem::Contacts{support::law_of<3>(o), dem::MeshWall<>{triangles_of(channel<3>(o))}};
  }
}
template <int Dim>
Box<Dim> box(const Options& o) {
  Box<Dim> box{.lower = Vec<Dim>::Constant(-0.1), .upper = Vec<Dim>::Constant(o.thickness + 0.1)};
  box.lower[0] = profile(o).front()[0] - 0.1;
  box.upper[0] = o.length + 0.1;
  box.upper[Dim - 1] = 3 * o.top();
  return box;
}

// Height of x above the slope, across it [m].
template <int Dim>
double above_slope(const Options& o, const Vec<Dim>& x) {
  return std::sin(o.slope()) * x[0] + std::cos(o.slope()) * x[Dim - 1];
}

// On a lattice along the slope, not quite regular.
template <int Dim>
coupled::GrainsInFluid<Dim> slide(const Options& o) {
  coupled::GrainsInFluid<Dim> grains{box<Dim>(o)};
  std::mt19937 random(1);
  constexpr double looseness = 1.05;
  const double pitch = looseness * o.diameter, shift = (looseness - 1) * o.diameter / 2;
  const auto jitter = [&] { return shift * (2 * double(random()) / double(random.max()) - 1); };
  const auto count = [&](double size) { return int(std::floor(size / pitch + 1e-9)); };
  const int rows = Dim == 3 ? count(o.thickness) : 1;
  const double from_shore = o.depth / std::sin(o.slope()) + o.distance;
  for (int i = 0; i < count(o.slide_length); ++i) {
    for (int j = 0; j < rows; ++j) {
      for (int k = 0; k < count(o.slide_thickness); ++k) {
        const double along = from_shore + (i + 0.5) * pitch + jitter();
        const double across = (k + 0.5) * pitch + jitter();
        Vec<Dim> x = Vec<Dim>::Zero();
        x[0] = -std::cos(o.slope()) * along + std::sin(o.slope()) * across;
        x[Dim - 1] = std::sin(o.slope()) * along + std::cos(o.slope()) * across;
        if constexpr (Dim == 3) x[1] = (j + 0.5) * o.thickness / rows + jitter();
        dem::add_grain(grains, x, {.radius = o.diameter / 2, .density = o.density});
      }
    }
  }
  return grains;
}

// --- what is measured ----------------------------------------------------------------------------

// Distances of the gauges from the shore, over h. The crest is highest within them, beyond the
// splash.
constexpr double gauges[] = {3.5, 4.5, 5.5, 6.5, 7.5};

std::string gauge_name(std::size_t k) { return "level_" + std::to_string(k + 1); }

template <int Dim>
std::vector<double> measure(const Options& o, const auto& both) {
  const auto grains = both.grains().snapshot();
  const auto x = grains[position];
  const auto v = grains[velocity];
  double front = x[0][0];
  Vec<Dim> mean = Vec<Dim>::Zero();
  std::vector<double> heights;
  for (Index k = 0; k < grains.size(); ++k) {
    front = std::max(front, double(x[k][0]) + o.diameter / 2);
    mean += v[k] / double(grains.size());
    heights.push_back(above_slope<Dim>(o, x[k]) + o.diameter / 2);
  }
  // Without single grains that bounce.
  const auto high = heights.begin() + std::ptrdiff_t(0.95 * double(heights.size()));
  std::nth_element(heights.begin(), high, heights.end());
  std::vector<double> row{front, mean.norm(), *high};
  for (const double distance : gauges) {
    Vec<Dim> point = Vec<Dim>::Constant(o.thickness / 2);
    point[0] = o.shore() + distance * o.depth;
    row.push_back(SurfaceHeight<Dim>{.point = point, .spacing = o.spacing}.read(both));
  }
  return row;
}

std::vector<support::Finding> evaluate(const Options& o, double mass,
                                       const support::History& history) {
  const auto& front = history["front"];
  const auto impact = std::ranges::find_if(front, [&](double x) { return x >= o.shore(); });
  if (impact == front.end()) return {};
  const auto step = std::size_t(impact - front.begin());
  const double h = o.depth, speed = history["speed"][step], thickness = history["thickness"][step];
  const double F = speed / std::sqrt(support::g * h), S = thickness / h, M = mass / (1000 * h * h);
  const double P = F * std::sqrt(S) * std::pow(M, 0.25) * std::sqrt(std::cos(6.0 / 7 * o.slope()));
  double crest = 0, place = 0;
  for (std::size_t k = 0; k < std::size(gauges); ++k) {
    const auto& level = history[gauge_name(k)];
    const double highest = *std::ranges::max_element(level) - h;
    if (highest <= crest) continue;
    crest = highest;
    place = gauges[k];
  }
  const auto stated = [](const std::string& name, double value) {
    return support::Finding{.quantity = name,
                            .reference = support::no_reference,
                            .measured = value,
                            .allowed = support::stated,
                            .scale = 1};
  };
  return {stated("slide Froude number F [-]", F),
          stated("slide thickness S [-]", S),
          stated("slide mass M [-]", M),
          stated("impulse product parameter P [-]", P),
          {.quantity = "amplitude of the first crest over h [-]",
           .reference = 4.0 / 9 * std::pow(P, 0.8),
           .measured = crest / h,
           .allowed = 0.2},
          {.quantity = "its distance from the shore over h [-]",
           .reference = 5.5 * std::sqrt(P),
           .measured = place,
           .allowed = support::stated}};
}

template <int Dim>
void simulate(const Options& o) {
  auto settings = support::mixture_settings<Dim>(o, o.depth);
  settings.walls.template faces<Dim>() = channel<Dim>(o);
  mps::FluidInMixture<Dim> water{box<Dim>(o)};
  Vec<Dim> inside = Vec<Dim>::Constant(o.thickness / 2);
  inside[0] = o.length / 2;
  inside[Dim - 1] = o.depth / 2;
  support::or_reject([&] {
    return mps::fill(water, settings.walls,
                     {.inside = inside, .level = o.depth, .spacing = o.spacing});
  });
  auto grains = slide<Dim>(o);
  double mass_of_slide = 0;
  for (const double m : grains[mass]) mass_of_slide += m;
  if constexpr (Dim == 3) mass_of_slide /= o.thickness;
  auto both = support::couple<Dim>(o, std::move(grains), std::move(water), settings,
                                   contacts_of<Dim>(o), support::DragOfGrains<Dim>{});
  std::vector<std::string> names{"front", "speed", "thickness"};
  for (std::size_t k = 0; k < std::size(gauges); ++k) names.push_back(gauge_name(k));
  const auto row = [&](const auto& simulation) { return measure<Dim>(o, simulation); };
  support::run_coupled(o, both,
                       support::Study{"landslide", names, row,
                                      [&](const support::History& history) {
                                        return evaluate(o, mass_of_slide, history);
                                      },
                                      nlohmann::ordered_json{{"depth", o.depth},
                                                             {"length", o.length},
                                                             {"thickness", o.thickness},
                                                             {"angle", o.angle},
                                                             {"slide_length", o.slide_length},
                                                             {"slide_thickness", o.slide_thickness},
                                                             {"distance", o.distance},
                                                             {"mass_per_width", mass_of_slide},
                                                             {"gauges", gauges}}});
}

void check(const Options& o) {
  support::require_small_grains(o);
  if (o.slide_thickness < o.diameter || o.slide_length < o.diameter) {
    throw support::OptionError("the slide is smaller than --diameter " + to_text(o.diameter));
  }
  const double last = o.shore() + (gauges[std::size(gauges) - 1] + 2) * o.depth;
  if (last > o.length) {
    throw support::OptionError("--length " + to_text(o.length) +
                               " is too short for the gauges; give " + to_text(last) + " or more");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.0125;
  options.dimension = 3;
  options.until = 2;
  options.out = "out/landslide";
  CLI::App app("A slide of grains into water", "landslide");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    options.dimension == 2 ? simulate<2>(options) : simulate<3>(options);
  });
}
