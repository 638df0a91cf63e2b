// SPDX-License-Identifier: MIT
// Shared by the larger examples: checked options, the output folder, the summary, and exit codes: 0
// success, 1 the run failed, 2 an option is invalid. Errors are reported on stderr.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace support {

/// An invalid option, or an invalid combination of options.
struct OptionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Checks a numeric option; `what` completes "must be …". CLI11's own checks accept NaN.
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
// Beyond this range, products of a few quantities would overflow or underflow.
inline bool is_usual(double magnitude) { return 1e-100 <= magnitude && magnitude <= 1e100; }
inline CLI::Validator positive() {
  return number("a number above 0, from 1e-100 to 1e100",
                [](double value) { return is_usual(value); });
}
inline CLI::Validator not_negative() {
  return number("0, or a number from 1e-100 to 1e100",
                [](double value) { return value == 0 || is_usual(value); });
}
inline CLI::Validator between(silt::Range range) {
  return number("a number from " + silt::to_text(range.lower) + " to " + silt::to_text(range.upper),
                [range](double value) { return range.lower <= value && value <= range.upper; });
}

/// The result of make(), which uses the options; if it throws silt::Error, throws OptionError.
template <class Make>
auto or_reject(Make&& make) {
  try {
    return make();
  } catch (const silt::Error& error) {
    throw OptionError(error.what());
  }
}

/// Help of --threads.
inline constexpr const char* threads_help =
    "number of threads; 0: as many as make a step faster. Results are bitwise identical for any "
    "number";

/// Sets the number of threads, unless it is 0.
inline void use_threads_of_option(int number) {
  if (number > 0) silt::use_threads(number);
}

/// Creates the folder, and checks that it is writable.
inline void create_output_folder(const std::filesystem::path& folder) {
  try {
    const std::filesystem::path trial = folder / ".trial";
    silt::file::create_folder("--out", folder);
    silt::file::replace("--out", trial, "");
    std::filesystem::remove(trial);
    // If this run fails, the summary of an earlier run must not be taken for its result.
    std::filesystem::remove(folder / "summary.json");
  } catch (const std::exception& error) {
    throw OptionError(error.what());
  }
}

/// Writes folder/summary.json.
inline void write_summary(const std::filesystem::path& folder,
                          const nlohmann::ordered_json& summary) {
  silt::file::replace("summary", folder / "summary.json", summary.dump(2) + "\n");
}

/// Reads the options, calls body(), and returns the exit code.
template <class Body>
int run(CLI::App& app, int argc, char** argv, Body&& body) {
  const auto report = [&](const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
  };
  try {
    app.parse(argc, argv);
    body();
    return 0;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    report(error);
    return 2;
  } catch (const OptionError& error) {
    report(error);
    return 2;
  } catch (const std::exception& error) {
    report(error);
    return 1;
  }
}

}  // namespace support
