// SPDX-License-Identifier: MIT
// A column of water collapses in a tank, computed with Silt's recommended scheme or one of the
// eleven of Table 1 in S.C. Hwang, B.H. Lee, J.C. Park, "Improvement of MPS method in simulating
// violent free-surface motion and predicting impact-loads". The front is compared with Martin and
// Moyce (1952).
//
//   dam_break --out out/dam_break
//   dam_break --case 00 --out out/dam_break/case_00
//   dam_break --dimension 3 --spacing 0.02 --depth 0.2 --out out/dam_break_3d
//   examples/plot_dam_break.py out/dam_break
//
// The run itself is in support/dam_break/collapse.hpp.
#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/dam_break/collapse.hpp"
#include "support/flow_program.hpp"
#include "support/resume.hpp"

#include <string>
#include <utility>

namespace {

using namespace dam_break;

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return support::add_option(app, name, value, text, check);
  };
  using support::positive, support::between;
  // Names are converted to numbers; an integer that begins with 0 would be read as octal.
  const auto number_of = [](std::string& text) {
    if (text == "recommended") text = std::to_string(recommended);
    if (text == "wall_particles") text = std::to_string(for_wall_particles);
    if (text.size() == 2 && text.front() == '0') text.erase(0, 1);
    return std::string();
  };
  app.add_option("--case", o.scheme, "recommended, wall_particles: that for walls of particles, "
                 "or a column of Table 1: 00 the original MPS, 10 PNU-MPS")
      ->check(support::between({for_wall_particles, 10}))
      ->transform(CLI::Validator(number_of, ""))
      ->default_str("recommended");
  add("--column", o.column, "width,height of the column of water [m], whole numbers of spacings",
      positive())->delimiter(',')->expected(2);
  add("--tank", o.tank, "length,height of the tank [m], with the schemes of Table 1 whole numbers of "
      "spacings; by default four column widths long, as in Koshizuka and Oka (1996), since the paper "
      "does not give it", positive())->delimiter(',')->expected(2);
  add("--depth", o.depth, "depth of the tank in 3D [m], a whole number of spacings", positive());
  support::describe_flow(app, o, "P2 of the paper: on the right wall, 0.02 m above the floor",
                         "front.csv, pressure.csv, energy.csv, summary.json and frames.pvd");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.out = "out/dam_break";
  CLI::App app("Collapse of a column of water in a tank", "dam_break");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    const auto& [length, height] = std::pair(options.tank[0], options.tank[1]);
    if (options.dimension == 2) {
      support::read_probes(options, {length, height}, {length, 0.02});
      collapse<2>(options);
    } else {
      support::read_probes(options, {length, options.depth, height},
                           {length, options.depth / 2, 0.02});
      collapse<3>(options);
    }
  });
}
