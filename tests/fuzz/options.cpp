// SPDX-License-Identifier: MIT
// Fuzz target: an input is a command line of the examples, one argument per line, where FOLDER
// stands for the folder of a stopped run; after an empty line, it is the arguments.json there.
#include <silt/core/error.hpp>

#include "fuzz/target.hpp"
#include "support/command_line.hpp"
#include "support/flow_program.hpp"
#include "support/resume.hpp"
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace silt;

bool is_between(double value, double lower, double upper) {
  return lower <= value && value <= upper;
}

void require_valid(const support::FlowOptions& o) {
  for (const double value : {o.spacing, o.until, o.output_every}) {
    fuzz::require(is_finite(value) && value > 0, "a number that is not positive and finite");
  }
  fuzz::require(o.max_time_step > 0, "a time step that is not positive");
  fuzz::require(o.dimension == 2 || o.dimension == 3, "a dimension other than 2 and 3");
  fuzz::require(is_between(o.radius, 1.5, 6) && is_between(o.laplacian_radius, 1.5, 6),
                "a radius out of its range");
  fuzz::require(is_between(o.courant, 1e-3, 0.5), "a Courant number out of its range");
  fuzz::require(is_between(o.tolerance, 1e-12, 0.1), "a tolerance out of its range");
  fuzz::require(is_between(o.threads, 0, 1024), "a number of threads out of its range");
  const double every = o.resume.checkpoint_every;
  fuzz::require(is_finite(every) && every >= 0, "an invalid time between checkpoints");
  fuzz::require(!o.probes.empty(), "no probe");
  for (const auto& point : o.probes) {
    fuzz::require(point.size() == 2, "a probe of another dimension");
    for (const double x : point) fuzz::require(is_between(x, 0, 1), "a probe outside the tank");
  }
}

// The lines up to an empty one, and the text after it.
struct CommandLine {
  explicit CommandLine(std::string_view rest, const std::string& folder) {
    while (!rest.empty()) {
      const std::string_view line = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
      if (line.empty()) break;
      arguments.emplace_back(line == "FOLDER" ? folder : line.substr(0, line.find('\0')));
    }
    stored = rest;
  }

  std::vector<std::string> arguments = {"fuzz"};
  std::string_view stored;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file("arguments.json");
  CommandLine line(fuzz::as_text(data, size), file.folder().string());
  file.write(line.stored);
  std::vector<char*> argv;
  for (std::string& argument : line.arguments) argv.push_back(argument.data());

  support::FlowOptions options;
  CLI::App app("Options of a flow", "fuzz");
  support::describe_flow(app, options, "the middle", "results");
  // What support::run() does, without printing: these errors end a program with the exit code 2.
  try {
    app.parse(static_cast<int>(argv.size()), argv.data());
    if (options.resume.is_requested()) support::detail::parse_resumed(app, options.resume);
    support::read_probes(options, {1, 1}, {0.5, 0.5});
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    app.exit(error, out, out);
    ++fuzz::refused;
    return 0;
  } catch (const support::OptionError&) {
    ++fuzz::refused;
    return 0;
  }
  require_valid(options);
  ++fuzz::accepted;
  return 0;
}
