// SPDX-License-Identifier: MIT
// How a run of the larger examples is stopped and resumed. Its folder holds, until the run is
// complete,
//
//   arguments.json     the program, and the arguments of the run
//   checkpoint.silt    written every so often, and when Ctrl-C or SIGTERM ends the run
//
// and `program --resume FOLDER` goes on with it.
#pragma once

#include <silt/core/simulation.hpp>
#include <silt/core/transfer.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/io/file.hpp>
#include <silt/io/stop_on_signal.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace support {

struct Resume {
  std::string folder = {};        // of the run to go on with; empty: a new run
  double checkpoint_every = 600;  // wall-clock time [s]; 0: only when the run is stopped
  std::string program = {};      // as it was called
  std::string name = {};         // of the program
  std::vector<std::string> arguments = {};  // of the run, without --out

  bool is_asked_for() const { return !folder.empty(); }
};

/// What a run that was stopped throws.
struct Stopped {
  std::filesystem::path folder;
  int signal_number;
  double time;  // [s]
};

/// Adds --resume and --checkpoint-every.
inline void describe_resume(CLI::App& app, Resume& resume) {
  app.add_option("--resume", resume.folder,
                 "folder of a run that was stopped, to go on with it; of the other options only "
                 "--until, --threads and --checkpoint-every may be given, too");
  app.add_option("--checkpoint-every", resume.checkpoint_every,
                 "wall-clock time between checkpoints, from which --resume goes on [s]; 0: only "
                 "when Ctrl-C or SIGTERM ends the run")
      ->check(not_negative())
      ->capture_default_str();
}

namespace detail {

inline constexpr const char* may_change[] = {"--until", "--threads", "--checkpoint-every"};

// Removes an option and its value, as "--name value" and as "--name=value".
inline void remove_option(std::vector<std::string>& arguments, const std::string& name) {
  for (auto at = arguments.begin(); at != arguments.end();) {
    if (*at == name && at + 1 != arguments.end()) {
      at = arguments.erase(at, at + 2);
    } else if (at->starts_with(name + "=")) {
      at = arguments.erase(at);
    } else {
      ++at;
    }
  }
}

// Parses the arguments of the run to resume, with what may change from the command line.
inline void parse_resumed(CLI::App& app, Resume& resume) {
  const std::filesystem::path folder = resume.folder;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    const bool is_allowed = name == "--resume" ||
                            std::find(std::begin(may_change), std::end(may_change), name) !=
                                std::end(may_change);
    if (option->count() > 0 && !is_allowed) {
      throw Refusal(name + " cannot be given with --resume, which takes it from the run in " +
                    folder.string());
    }
  }
  try {
    const auto stored =
        nlohmann::json::parse(silt::file::read("--resume", folder / "arguments.json"));
    if (stored.at("program") != app.get_name()) {
      throw Refusal("--resume " + folder.string() + " is a run of " +
                    stored.at("program").get<std::string>());
    }
    resume.arguments = stored.at("arguments").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception& error) {
    throw Refusal("--resume: " + (folder / "arguments.json").string() + ": " + error.what());
  } catch (const silt::Error& error) {
    throw Refusal(std::string(error.what()) + ", and that the folder is one of --out");
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
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
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
  for (const char* const ending : {".silt", ".silt.part"}) {
    for (const auto& path : checkpoints_in(folder, ending)) std::filesystem::remove(path);
  }
}

}  // namespace detail

/// As run() of command_line.hpp, for a program with describe_resume() and --out. A run that a
/// signal ended says how to go on with it, and returns 128 + the number of the signal.
template <class Body>
int run(CLI::App& app, int argc, char** argv, Resume& resume, Body&& body) {
  resume.program = argv[0];
  resume.name = app.get_name();
  resume.arguments.assign(argv + 1, argv + argc);
  detail::remove_option(resume.arguments, "--out");  // the folder may be moved
  try {
    return run(app, argc, argv, [&] {
      if (resume.is_asked_for()) detail::parse_resumed(app, resume);
      body();
    });
  } catch (const Stopped& stopped) {
    std::fprintf(stderr, "%s: stopped at t = %.4g s; go on with: %s --resume %s\n",
                 app.get_name().c_str(), stopped.time, resume.program.c_str(),
                 stopped.folder.string().c_str());
    return 128 + stopped.signal_number;
  }
}

/// Makes the folder, and keeps the arguments of the run in it. Refuses to resume where there is
/// nothing to go on from.
inline void open_output_folder(const Resume& resume, const std::filesystem::path& folder) {
  if (resume.is_asked_for()) {
    if (detail::checkpoints_in(folder).empty()) {
      const bool is_complete = std::filesystem::exists(folder / "summary.json");
      throw Refusal("--resume: the run in " + folder.string() +
                    (is_complete ? " is complete" : " has no checkpoint yet; begin it anew"));
    }
    make_output_folder(folder);
  } else {
    make_output_folder(folder);
    detail::remove_checkpoints(folder);
  }
  const nlohmann::ordered_json arguments{{"program", resume.name},
                                         {"arguments", resume.arguments}};
  silt::file::replace("--out", folder / "arguments.json", arguments.dump(2) + "\n");
}

/// Writes the summary, with which the run is complete: its checkpoints are removed.
inline void complete(const std::filesystem::path& folder, const nlohmann::ordered_json& summary) {
  write_summary(folder, summary);
  detail::remove_checkpoints(folder);
}

/// A simulation and the parts of its run, which a checkpoint holds.
template <class Sim, class... Parts>
class ResumableRun {
 public:
  /// Reads the checkpoint if the run is to be resumed and `file` is there.
  ResumableRun(const Resume& resume, const std::filesystem::path& file, Sim& simulation,
               Parts&... parts)
      : folder_(file.parent_path()),
        simulation_(simulation),
        checkpoints_(file,
                     {.every = resume.checkpoint_every > 0
                                   ? resume.checkpoint_every
                                   : std::numeric_limits<double>::infinity()},
                     parts...) {
    if (!resume.is_asked_for() || !checkpoints_.exist()) return;
    or_refuse([&] {
      checkpoints_.read(simulation);
      return true;
    });
  }

  /// As Simulation::run(), but throws Stopped if a signal ended the run.
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

/// Runs the simulation, or goes on with its run, for programs with a single run. Its parts are the
/// observers that have a transfer().
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
