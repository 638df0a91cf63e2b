// SPDX-License-Identifier: MIT
// A run that was stopped or failed, and was resumed, writes the same files as an uninterrupted run,
// byte by byte.
#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"

#include <silt/dem/setup/inflow.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace silt::test::resume_test {
namespace {

std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    files[std::filesystem::relative(entry.path(), folder).string()] = {
        std::istreambuf_iterator<char>(stream), {}};
  }
  return files;
}

struct StopAfter {
  std::uint64_t steps;
  std::uint64_t done = 0;
  template <class Sim>
  void after_step(const Sim& simulation, const Run&) {
    done = simulation.steps();
  }
  bool stop_requested() const { return done >= steps; }
};
struct FailAfter {
  std::uint64_t steps;
  template <class Sim>
  void after_step(const Sim& simulation, const Run&) const {
    if (simulation.steps() >= steps) throw std::runtime_error("stopped by the test");
  }
};
struct CheckpointAfter {
  std::uint64_t steps;
  std::filesystem::path path;
  const VtkSeries& series;
  const CsvFile& table;
  template <class Sim>
  void between_steps(const Sim& simulation) const {
    if (simulation.steps() == steps) write_checkpoint(path, simulation, series, table);
  }
};

// Writes a row at every output and after every step.
struct Rows {
  CsvFile& table;
  template <class Sim>
  void operator()(const Sim& simulation) const {
    table.row({simulation.time(), -1});
  }
  template <class Sim>
  void after_step(const Sim& simulation, const Run&) const {
    table.row({simulation.time(), double(simulation.steps())});
  }
};

const std::vector<std::string> columns{"t", "step"};

template <class Make>
void expect_same_files(const Run& run, Make&& make) {
  const Folder folder;
  const auto whole_path = folder.path / "whole", part_path = folder.path / "part";
  const auto checkpoint = folder.path / "run.silt";
  std::uint64_t steps = 0;
  {
    std::filesystem::create_directory(whole_path);
    auto simulation = make();
    VtkSeries series{whole_path / "frames"};
    CsvFile table{whole_path / "rows.csv", columns};
    EXPECT_TRUE(simulation.run(run, series, Rows{table}));
    steps = simulation.steps();
  }
  const auto whole = files_in(whole_path);
  ASSERT_GT(whole.size(), 4u);
  ASSERT_GE(steps, 12u);
  const auto clear = [&] {
    std::filesystem::remove_all(part_path);
    std::filesystem::create_directory(part_path);
  };
  const auto resume = [&] {
    auto simulation = make();
    VtkSeries series{part_path / "frames"};
    CsvFile table{part_path / "rows.csv", columns};
    read_checkpoint(checkpoint, simulation, series, table);
    EXPECT_TRUE(simulation.was_read());
    EXPECT_TRUE(simulation.run(run, series, Rows{table}));
  };
  for (std::uint64_t k = 0; k <= steps; k += steps > 40 ? 3 : 1) {
    clear();
    {
      auto simulation = make();
      VtkSeries series{part_path / "frames"};
      CsvFile table{part_path / "rows.csv", columns};
      EXPECT_EQ(simulation.run(run, series, Rows{table}, StopAfter{k}), k == steps);
      EXPECT_EQ(simulation.steps(), k);
      write_checkpoint(checkpoint, simulation, series, table);
    }
    if (k == steps) continue;
    resume();
    EXPECT_EQ(files_in(part_path), whole) << "stopped after step " << k << " of " << steps;
  }
  // Failed some steps after the checkpoint: later output is written again.
  for (std::uint64_t k = 1; k + 5 < steps; k += steps / 10) {
    clear();
    {
      auto simulation = make();
      VtkSeries series{part_path / "frames"};
      CsvFile table{part_path / "rows.csv", columns};
      EXPECT_THROW(simulation.run(run, CheckpointAfter{k, checkpoint, series, table}, series,
                                  Rows{table}, FailAfter{k + 5}),
                   std::runtime_error);
    }
    resume();
    EXPECT_EQ(files_in(part_path), whole) << "checkpoint after step " << k << " of " << steps;
  }
}

auto falling_grains() {
  return Simulation{crowd<2, double>(5, 1), NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}},
                           dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5,
                                                            .tangential_stiffness = 5e4,
                                                            .restitution = 0.6,
                                                            .friction_angle = 0.5},
                                         dem::Plane<2>{}}},
                    Leapfrog{}};
}

TEST(ResumedRun, OfGrainsWritesTheFilesOfAnUninterruptedRun) {
  // Steps of 2e-4 s, an output at every fifth, and one at the end.
  expect_same_files({.until = 5.1e-3, .output_every = 1e-3, .time_step = 2e-4},
                         falling_grains);
}
TEST(ResumedRun, OfGrainsThatEndsExactlyWritesTheFilesOfAnUninterruptedRun) {
  expect_same_files({.until = 5e-3, .output_every = 7e-4, .end_exactly = true},
                         falling_grains);
}
TEST(ResumedRun, OfWaterWritesTheFilesOfAnUninterruptedRun) {
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.08, 0.12}, .size = {.length = 0.16, .height = 0.2}, .spacing = 0.01});
  expect_same_files({.until = 0.05, .output_every = 0.01}, [&tank] {
    return Simulation{tank.particles, NeighbourList<2>{{.skin_fraction = 0}},
                      mps::Flow<mps::Recommended>{
                          {.spacing = 0.01, .speed_scale = 1, .walls = tank.walls}},
                      SemiImplicit<>{}};
  });
}

TEST(ResumedRun, OfTheSecondOfTwoRunsWritesTheFilesOfAnUninterruptedRun) {
  const Folder folder;
  // Returns whether both runs were completed. Outputs at every fifth step, and at the end of each run.
  const auto program = [](auto& simulation, VtkSeries& frames, CsvFile& table, std::uint64_t steps) {
    StopAfter stop{steps};
    for (const double until : {1.5e-3, 3.1e-3}) {
      if (!simulation.run({.until = until, .output_every = 1e-3, .time_step = 2e-4}, frames,
                          Rows{table}, stop)) {
        return false;
      }
    }
    return true;
  };
  const auto all = [&](const std::string& name, auto&& use) {
    std::filesystem::create_directory(folder.path / name);
    auto simulation = falling_grains();
    VtkSeries frames{folder.path / name / "frames"};
    CsvFile table{folder.path / name / "rows.csv", columns};
    use(simulation, frames, table);
  };
  all("whole", [&](auto&... part) { EXPECT_TRUE(program(part..., 1000)); });
  for (const std::uint64_t k : {3u, 9u, 12u, 15u}) {
    std::filesystem::remove_all(folder.path / "part");
    all("part", [&](auto&... part) {
      EXPECT_FALSE(program(part..., k));
      write_checkpoint(folder.path / "run.silt", part...);
    });
    all("part", [&](auto&... part) {
      read_checkpoint(folder.path / "run.silt", part...);
      EXPECT_TRUE(program(part..., 1000));
    });
    EXPECT_EQ(files_in(folder.path / "part"), files_in(folder.path / "whole")) << k;
  }
}

TEST(ResumedRun, AppendsFramesEvenIfTheCheckpointHasNoSeries) {
  const Folder folder;
  const auto frames = [&](const std::string& name) {
    return VtkSeries{folder.path / name / "frames"};
  };
  const silt::Run run{.until = 4e-3, .output_every = 1e-3, .time_step = 2e-4};
  auto whole = falling_grains();
  whole.run(run, frames("whole"));
  for (const std::uint64_t k : {7u, 10u, 20u}) {
    std::filesystem::remove_all(folder.path / "part");
    auto first = falling_grains();
    first.run(run, frames("part"), StopAfter{k});
    write_checkpoint(folder.path / "run.silt", first);
    auto second = falling_grains();
    read_checkpoint(folder.path / "run.silt", second);
    second.run(run, frames("part"));
    EXPECT_EQ(files_in(folder.path / "part"), files_in(folder.path / "whole")) << k;
  }
}

TEST(ResumedRun, ReplacesOldFramesIfTheCheckpointHasNone) {
  const Folder folder;
  auto earlier = falling_grains();
  earlier.run({.until = 4e-3, .output_every = 1e-3, .time_step = 2e-4},
              VtkSeries{folder.path / "frames"});
  auto simulation = falling_grains();
  simulation.run({.until = 2e-3, .time_step = 2e-4});
  VtkSeries frames{folder.path / "frames"};
  write_checkpoint(folder.path / "run.silt", simulation, frames);
  read_checkpoint(folder.path / "run.silt", simulation, frames);
  simulation.run({.until = 3e-3, .time_step = 2e-4}, frames);
  EXPECT_EQ(frames.frames(), 2u);
}

TEST(ResumedRun, WritesAFirstFrameIfTheCheckpointWasWrittenAfterARun) {
  const Folder folder;
  auto simulation = falling_grains();
  simulation.run({.until = 1e-3, .time_step = 2e-4});
  write_checkpoint(folder.path / "state.silt", simulation);
  auto variant = falling_grains();
  read_checkpoint(folder.path / "state.silt", variant);
  VtkSeries frames{folder.path / "variant"};
  variant.run({.until = 2e-3, .time_step = 2e-4}, frames);
  EXPECT_EQ(frames.frames(), 2u);
}

TEST(ResumedRun, RejectsATruncatedTable) {
  const Folder folder;
  auto simulation = falling_grains();
  CsvFile table{folder.path / "rows.csv", columns};
  table.row({1, 2});
  write_checkpoint(folder.path / "run.silt", simulation, table);
  std::filesystem::resize_file(folder.path / "rows.csv", 3);
  EXPECT_TRUE(refuses([&] { read_checkpoint(folder.path / "run.silt", simulation, table); },
                      {"rows.csv", "has 3 bytes"}));
  CsvFile other{folder.path / "other.csv", {"t"}};
  EXPECT_TRUE(refuses([&] { read_checkpoint(folder.path / "run.silt", simulation, other); },
                      {"columns = t,step"}));
}

TEST(CsvFile, KeepsAnExistingTableUntilTheFirstRow) {
  const Folder folder;
  const auto path = folder.path / "rows.csv";
  CsvFile{path, columns}.row({1, 2});
  CsvFile again{path, columns};
  EXPECT_EQ(read_csv(path).rows(), 1u);
  again.row({3, 4});
  EXPECT_EQ(read_csv(path)["t"], (std::vector<double>{3}));
  CsvFile third{path, columns};
  third.begin();
  EXPECT_EQ(read_csv(path).rows(), 0u);
}

TEST(VtkSeries, HasOneFramePerTime) {
  const Folder folder;
  auto simulation = falling_grains();
  VtkSeries frames{folder.path / "frames"};
  simulation.run({.until = 1e-3, .time_step = 2e-4}, frames);
  simulation.run({.until = 2e-3, .time_step = 2e-4}, frames);
  EXPECT_EQ(frames.frames(), 3u);
}

TEST(Checkpoints, AreWrittenAtIntervalsAndRestoreAllParts) {
  const Folder folder;
  const auto path = folder.path / "run.silt";
  {
    auto simulation = falling_grains();
    VtkSeries frames{folder.path / "frames"};
    Checkpoints never{path, {}, frames};
    simulation.run({.until = 1e-3, .time_step = 2e-4}, frames, never);
    EXPECT_FALSE(never.exist());
    Checkpoints always{path, {.every = 0}, frames};
    simulation.run({.until = 2e-3, .time_step = 2e-4}, frames, always);
    EXPECT_TRUE(always.exist());
  }
  auto later = falling_grains();
  VtkSeries frames{folder.path / "frames"};
  Checkpoints checkpoints{path, {}, frames};
  checkpoints.read(later);
  EXPECT_EQ(later.steps(), 10u);
  EXPECT_EQ(frames.frames(), 2u) << "the frame at the end is written after the checkpoint";
  EXPECT_TRUE(
      refuses([&] { Checkpoints(path, {.every = -1}, frames); }, {"Checkpoints: every = -1"}));
}

}  // namespace
}  // namespace silt::test::resume_test
