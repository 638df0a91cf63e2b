// SPDX-License-Identifier: MIT
// What the larger examples share: options that are checked, an output folder, a summary, and exit
// codes: 0 done, 1 the run failed, 2 an option was refused. A failure is one sentence on stderr.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/io/file.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace support {

/// An option whose value cannot be used.
struct Refusal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Checks an option's number; `what` completes "must be …". CLI11's own checks let NaN pass.
template <class Accepts>
CLI::Validator number(const std::string& what, Accepts accepts) {
  return CLI::Validator(
      [what, accepts](std::string& text) {
        double value = 0;
        const bool read = CLI::detail::lexical_cast(text, value);
        if (read && silt::is_finite(value) && accepts(value)) return std::string();
        return text + " must be " + what;
      },
      "");
}
inline CLI::Validator positive() {
  return number("a number above 0", [](double value) { return value > 0; });
}
inline CLI::Validator not_negative() {
  return number("a number of at least 0", [](double value) { return value >= 0; });
}
inline CLI::Validator finite() {
  return number("a finite number", [](double) { return true; });
}
inline CLI::Validator between(silt::Range range) {
  return number("a number from " + silt::to_text(range.lower) + " to " + silt::to_text(range.upper),
                [range](double value) { return range.lower <= value && value <= range.upper; });
}

/// What make() makes of the options; what it refuses is refused as an option is.
template <class Make>
auto or_refuse(Make&& make) {
  try {
    return make();
  } catch (const silt::Error& error) {
    throw Refusal(error.what());
  }
}

/// Help of --threads.
inline constexpr const char* threads_help =
    "threads; 0: as many as make a step faster. The result is the same bits for any number";

/// Uses the number of --threads, if it is not 0.
inline void use_threads_of_option(int number) {
  if (number > 0) silt::use_threads(number);
}

/// Makes the folder, and sees that files can be made in it.
inline void make_output_folder(const std::filesystem::path& folder) {
  try {
    const std::filesystem::path trial = folder / ".trial";
    silt::file::create_folder("--out", folder);
    silt::file::replace("--out", trial, "");
    std::filesystem::remove(trial);
    // One of an earlier run would pass for this one's, should this one fail.
    std::filesystem::remove(folder / "summary.json");
  } catch (const std::exception& error) {
    throw Refusal(error.what());
  }
}

/// Writes folder/summary.json.
inline void write_summary(const std::filesystem::path& folder,
                          const nlohmann::ordered_json& summary) {
  silt::file::replace("summary", folder / "summary.json", summary.dump(2) + "\n");
}

/// Reads the options, calls body(), and returns what main returns.
template <class Body>
int run(CLI::App& app, int argc, char** argv, Body&& body) {
  const auto say = [&](const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
  };
  try {
    app.parse(argc, argv);
    body();
    return 0;
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    say(error);
    return 2;
  } catch (const Refusal& error) {
    say(error);
    return 2;
  } catch (const std::exception& error) {
    say(error);
    return 1;
  }
}

}  // namespace support
