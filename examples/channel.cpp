// SPDX-License-Identifier: MIT
// Water that flows through a channel, in and out: a hydraulic jump, a broad-crested weir, or a slot
// in the floor of a tank. Depths, discharge and jet are compared with the theory of each case,
// which is a header in support/channel/.
//
//   channel --out out/channel
//   channel --froude 3 --until 6 --out out/jump_3
//   channel --case weir --out out/weir
//   channel --case slot --out out/slot
//   examples/plot_channel.py out/channel
//
// The findings are means of the second half of the run. In 2D all is per metre of width.
#include <silt/measure/surface_height.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>

#include "support/channel/broad_crested_weir.hpp"
#include "support/channel/channel_flow.hpp"
#include "support/channel/hydraulic_jump.hpp"
#include "support/channel/slot_in_a_floor.hpp"
#include "support/command_line.hpp"
#include "support/flow_program.hpp"
#include "support/flow_study.hpp"
#include "support/resume.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace silt;
using channel::Options;

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::not_negative, support::between;
  add_option(app, "--case", o.name,
             "jump: a hydraulic jump; weir: a broad-crested weir; slot: a slot in a floor",
             CLI::IsMember({"jump", "weir", "slot"}));
  add_option(app, "--froude", o.froude, "Froude number before the jump", between({1.2, 10}));
  add_option(app, "--depth", o.depth, "depth of the water before the jump [m]", positive());
  add_option(app, "--length", o.length,
             "length of the channel with the jump [m]; 0: 16 depths, and 13.5 of those after it",
             not_negative());
  add_option(app, "--head", o.head,
             "height of the water above the crest or the slot [m]; 0: 0.15 m, 6 widths of the slot",
             not_negative());
  add_option(app, "--slot", o.slot, "width of the slot [m], of which half is computed", positive());
  add_option(
      app, "--viscosity", o.viscosity,
      "kinematic [m²/s]; an eddy viscosity stands for turbulence, which is three-dimensional",
      not_negative());
  add_option(app, "--thickness", o.thickness, "thickness of the channel in 3D, along y [m]",
             positive());
  support::describe_numerics(app, o, "channel.csv, frames.pvd, walls.pvd and summary.json");
  app.get_option("--spacing")
      ->description("particle spacing [m]; default 0.01, of the slot 0.005")
      ->default_str("");
  app.get_option("--until")
      ->description("end of the run [s]; default 4, of the weir 8, of the slot 1")
      ->default_str("");
}

// What was not given.
void complete(Options& o) {
  if (!(o.spacing > 0)) o.spacing = o.name == "slot" ? 0.005 : 0.01;
  if (!(o.until > 0)) o.until = o.name == "jump" ? 4 : o.name == "weir" ? 8 : 1;
  if (!(o.head > 0)) o.head = o.name == "weir" ? 0.15 : 6 * o.slot;
}

// Lengths on the lattice, and enough particles for a flow.
void check(const Options& o) {
  const auto require = [&](const std::string& name, double length, int least) {
    const double spacings = length / o.spacing;
    if (spacings > least - 1e-6 && std::abs(spacings - std::round(spacings)) < 1e-6) return;
    throw support::OptionError(name + " " + to_text(length) + " is " + to_text(spacings) +
                               " times --spacing " + to_text(o.spacing) +
                               "; give a whole multiple, at least " + std::to_string(least));
  };
  if (o.name == "jump") require("--depth", o.depth, 4);
  if (o.name != "jump") require("--head", o.head, 6);
  if (o.name == "slot") require("--slot", o.slot, 8);
  if (o.dimension == 3) require("--thickness", o.thickness, 2);
}

template <int Dim>
channel::Flow<Dim> make(const Options& o) {
  return support::or_reject([&] {
    if (o.name == "weir") return channel::broad_crested_weir<Dim>(o);
    if (o.name == "slot") return channel::slot_in_a_floor<Dim>(o);
    return channel::hydraulic_jump<Dim>(o);
  });
}

template <int Dim>
void simulate(const Options& o) {
  auto flow = make<Dim>(o);
  std::vector<SurfaceHeight<Dim>> levels;
  std::vector<double> places, floor;
  std::vector<std::string> names{"volume_in", "volume_passed", "volume_out"};
  for (int k = 0; k < channel::gauges; ++k) {
    const double x = channel::place_of_gauge(k, flow.reach);
    Vec<Dim> point = Vec<Dim>::Constant(o.thickness / 2);
    point[0] = x;
    levels.push_back({.point = point, .spacing = o.spacing, .lowest = 0});
    places.push_back(x);
    floor.push_back(flow.bed(x));
    names.push_back("level_" + std::to_string(k + 1));
  }
  names.insert(names.end(), flow.names.begin(), flow.names.end());
  const auto measure = [&](const auto& simulation) {
    const double width = Dim == 3 ? o.thickness : 1;
    std::vector<double> row{flow.openings.in.volume() / width,
                            flow.openings.section.volume() / width,
                            flow.openings.volume_out() / width};
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const double level = levels[k].read(simulation);
      row.push_back(is_finite(level) ? level : floor[k]);  // dry
    }
    for (const double value : flow.measure(simulation.particles())) row.push_back(value);
    return row;
  };
  nlohmann::ordered_json options{{"case", o.name},           {"froude", o.froude},
                                 {"depth", o.depth},         {"length", flow.reach.upper},
                                 {"head", o.head},           {"slot", o.slot},
                                 {"viscosity", o.viscosity}, {"thickness", o.thickness},
                                 {"gauges", places},         {"floor", floor}};
  options.update(flow.numbers);
  support::run_study(o, flow.water, flow.settings,
                     support::Study{"channel", names, measure, flow.findings, options},
                     flow.openings);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0;  // see complete()
  options.until = 0;
  options.output_every = 0.05;
  options.out = "out/channel";
  CLI::App app("Water that flows through a channel", "channel");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    complete(options);
    check(options);
    options.dimension == 2 ? simulate<2>(options) : simulate<3>(options);
  });
}
