// SPDX-License-Identifier: MIT
// Stopping and resuming a run of the larger examples. Until the run is complete, its output folder
// contains
//
//   arguments.json     the program and the arguments of the run
//   checkpoint.silt    written at regular intervals, and when Ctrl-C or SIGTERM ends the run
//
// and `program --resume FOLDER` resumes it.
#pragma once

#include <silt/core/simulation.hpp>
#include <silt/core/transfer.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>
#include <silt/io/stop_on_signal.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace support {

struct Resume {
  std::string folder = {};        // of the run to resume; empty: a new run
  double checkpoint_every = 600;  // wall-clock time [s]; 0: only when the run is stopped
  std::string program = {};       // command that called the program
  std::string name = {};          // of the program
  std::vector<std::string> arguments = {};  // of the run, without --out

  bool is_requested() const { return !folder.empty(); }
};

/// Thrown when a signal stops a run.
struct Stopped {
  std::filesystem::path folder;
  int signal_number;
  double time;  // [s]
};

/// Adds --resume and --checkpoint-every.
inline void describe_resume(CLI::App& app, Resume& resume) {
  app.add_option("--resume", resume.folder,
                 "output folder of a stopped run, to resume it; of the other options, only "
                 "--until, --threads and --checkpoint-every may also be given");
  app.add_option("--checkpoint-every", resume.checkpoint_every,
                 "wall-clock time between checkpoints for --resume [s]; 0: only when Ctrl-C or "
                 "SIGTERM ends the run")
      ->check(not_negative())
      ->capture_default_str();
}

namespace detail {

inline constexpr const char* may_change[] = {"--until", "--threads", "--checkpoint-every"};

// Removes an option and its value, as "--name value" and as "--name=value".
inline void remove_option(std::vector<std::string>& arguments, const std::string& name) {
  for (auto argument = arguments.begin(); argument != arguments.end();) {
    if (*argument == name && argument + 1 != arguments.end()) {
      argument = arguments.erase(argument, argument + 2);
    } else if (argument->starts_with(name + "=")) {
      argument = arguments.erase(argument);
    } else {
      ++argument;
    }
  }
}

// Parses the stored arguments of the run to resume, with changes from the command line.
inline void parse_resumed(CLI::App& app, Resume& resume) {
  const std::filesystem::path folder = resume.folder;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    const bool is_allowed = name == "--resume" ||
                            std::find(std::begin(may_change), std::end(may_change), name) !=
                                std::end(may_change);
    if (option->count() > 0 && !is_allowed) {
      throw OptionError(name + " cannot be given with --resume, which takes it from the run in " +
                        folder.string());
    }
  }
  try {
    const auto stored =
        nlohmann::json::parse(silt::file::read("--resume", folder / "arguments.json"));
    if (stored.at("program") != app.get_name()) {
      throw OptionError("--resume " + folder.string() + " is a run of " +
                        stored.at("program").get<std::string>());
    }
    resume.arguments = stored.at("arguments").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception& error) {
    throw OptionError("--resume: " + (folder / "arguments.json").string() + ": " + error.what());
  } catch (const silt::Error& error) {
    throw OptionError(std::string(error.what()) +
                      ", and that the folder is the --out folder of a run");
  }
  for (const char* name : may_change) {
    const CLI::Option* const option = app.get_option_no_throw(name);
    if (option == nullptr || option->count() == 0) continue;
    remove_option(resume.arguments, name);
    resume.arguments.push_back(name + ("=" + option->results().back()));
  }
  auto arguments = resume.arguments;
  for (const char* name : {"--out", "--resume"}) {
    arguments.push_back(name + ("=" + folder.string()));
  }
  app.clear();
  std::reverse(arguments.begin(), arguments.end());  // the order that CLI11 expects
  app.parse(std::move(arguments));
}

inline std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& folder,
                                                         const std::string& ending = ".silt") {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("checkpoint") && name.ends_with(ending)) paths.push_back(entry.path());
  }
  return paths;
}

// Also those of which a run that was killed had written a part.
inline void remove_checkpoints(const std::filesystem::path& folder) {
  // In this order: as long as there is a checkpoint, a run that was killed here can be resumed, and
  // removes what is left.
  for (const char* const ending : {".part", ".silt"}) {
    for (const auto& path : checkpoints_in(folder, ending)) std::filesystem::remove(path);
  }
}

}  // namespace detail

/// Like run() in command_line.hpp, for a program with describe_resume() and --out. If a signal ends
/// the run, prints the command that resumes it, and returns 128 + the number of the signal.
template <class Body>
int run(CLI::App& app, int argc, char** argv, Resume& resume, Body&& body) {
  const char* const called_as = std::getenv("SILT_EXAMPLE_COMMAND");  // set by examples/run
  resume.program = called_as != nullptr ? called_as : argv[0];
  resume.name = app.get_name();
  resume.arguments.assign(argv + 1, argv + argc);
  detail::remove_option(resume.arguments, "--out");  // the folder may be moved
  try {
    return run(app, argc, argv, [&] {
      if (resume.is_requested()) detail::parse_resumed(app, resume);
      body();
    });
  } catch (const Stopped& stopped) {
    std::fprintf(stderr, "%s: stopped at t = %.4g s; resume with: %s --resume %s\n",
                 app.get_name().c_str(), stopped.time, resume.program.c_str(),
                 stopped.folder.string().c_str());
    return 128 + stopped.signal_number;
  }
}

/// Creates the folder and writes the arguments of the run to it. Throws OptionError if there is no
/// checkpoint to resume from.
inline void open_output_folder(const Resume& resume, const std::filesystem::path& folder) {
  if (resume.is_requested()) {
    if (detail::checkpoints_in(folder).empty()) {
      const bool is_complete = std::filesystem::exists(folder / "summary.json");
      throw OptionError("--resume: the run in " + folder.string() +
                        (is_complete ? " is complete" : " has no checkpoint; start it again"));
    }
    create_output_folder(folder);
  } else {
    create_output_folder(folder);
    detail::remove_checkpoints(folder);
  }
  const nlohmann::ordered_json arguments{{"program", resume.name},
                                         {"arguments", resume.arguments}};
  silt::file::replace("--out", folder / "arguments.json", arguments.dump(2) + "\n");
}

/// Writes the summary of a complete run and removes its checkpoints.
inline void complete(const Resume& resume, const std::filesystem::path& folder,
                     nlohmann::ordered_json summary) {
  if (resume.is_requested()) summary["seconds_are_since_resume"] = true;
  write_summary(folder, summary);
  detail::remove_checkpoints(folder);
}

/// A simulation and the other parts of its run that are saved in a checkpoint.
template <class Sim, class... Parts>
class ResumableRun {
 public:
  /// Reads the checkpoint if the run is to be resumed and `file` exists.
  ResumableRun(const Resume& resume, const std::filesystem::path& file, Sim& simulation,
               Parts&... parts)
      : folder_(file.parent_path()),
        simulation_(simulation),
        checkpoints_(file,
                     {.every = resume.checkpoint_every > 0
                                   ? resume.checkpoint_every
                                   : std::numeric_limits<double>::infinity()},
                     parts...) {
    if (!resume.is_requested() || !checkpoints_.exist()) return;
    or_reject([&] {
      checkpoints_.read(simulation);
      return true;
    });
  }

  /// Like Simulation::run(), but throws Stopped if a signal ended the run.
  template <class... Observers>
  void run(const silt::Run& run, Observers&&... observers) {
    if (simulation_.run(run, observers..., stop_, checkpoints_)) return;
    checkpoints_.write(simulation_);
    throw Stopped{folder_, stop_.signal_number(), simulation_.time()};
  }

 private:
  std::filesystem::path folder_;
  Sim& simulation_;
  silt::Checkpoints<Parts...> checkpoints_;
  silt::StopOnSignal stop_;
};

/// Runs the simulation, or resumes its run, for programs with a single run. Its parts are the
/// observers with a transfer().
template <class Sim, class... Observers>
void run_or_resume(const Resume& resume, const std::filesystem::path& folder, Sim& simulation,
                   const silt::Run& run, Observers&&... observers) {
  const auto part = []<class Observer>(Observer& observer) {
    if constexpr (silt::Transferable<Observer, silt::checkpoint::Writer>) {
      return std::tie(observer);
    } else {
      return std::tuple<>();
    }
  };
  std::apply(
      [&](auto&... parts) {
        ResumableRun whole(resume, folder / "checkpoint.silt", simulation, parts...);
        whole.run(run, observers...);
      },
      std::tuple_cat(part(observers)...));
}

}  // namespace support
