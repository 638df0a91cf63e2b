// SPDX-License-Identifier: MIT
#include <silt/core/simulation.hpp>
#include <silt/io/file.hpp>
#include <silt/io/progress.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <unistd.h>

namespace silt::test::progress_test {
namespace {

struct Advancing {
  double now = 0;
  double time() const { return now; }
  double last_time_step() const { return 0.25; }
  unsigned long long steps() const { return static_cast<unsigned long long>(now / 0.25); }
};

void run_to_the_end(Progress& progress) {
  Advancing simulation;
  progress(simulation);
  while (simulation.now < 1) {
    simulation.now += 0.25;
    progress.after_step(simulation, silt::Run{.until = 1});
  }
}

// Output to a file of a run of so many steps, each taking so many seconds of wall-clock time.
std::string log_of(int steps, double seconds_per_step, int stop_after) {
  std::FILE* file = std::tmpfile();
  double wall = 50;  // a clock may begin at any time
  {
    Progress progress{file, [&wall] { return wall; }};
    Advancing simulation;
    progress(simulation);
    for (int k = 0; k < stop_after; ++k) {
      simulation.now += 0.25;
      wall += seconds_per_step;
      progress.after_step(simulation, Run{.until = 0.25 * steps});
    }
  }
  std::string text(static_cast<std::size_t>(std::ftell(file)), ' ');
  std::rewind(file);
  EXPECT_EQ(std::fread(text.data(), 1, text.size(), file), text.size());
  std::fclose(file);
  return text;
}
auto lines_in(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Progress, WritesLinesAtGrowingIntervalsToAFile) {
  const std::string log = log_of(100, 1, 100);
  // After 3, 6, 12, 24, 48 and 96 s, and at the end.
  EXPECT_EQ(lines_in(log), 7) << log;
  EXPECT_TRUE(log.starts_with("step 3  t = 0.75 s  dt = 2.50e-01 s    3.0 %  left 97 s\n")) << log;
  EXPECT_TRUE(log.ends_with("\nstep 100  t = 25 s  dt = 2.50e-01 s  100.0 %  took 100 s\n")) << log;
  EXPECT_EQ(log.find('\r'), std::string::npos);
  EXPECT_EQ(log.find('\x1b'), std::string::npos);
  // Ten hours: after 3, 6, 12, 24, 48, 96, 192, 384 s, then every 5 minutes.
  EXPECT_EQ(lines_in(log_of(36000, 1, 36000)), 8 + (36000 - 384) / 300 + 1);
}

TEST(Progress, WritesAFinalLineForAShortOrStoppedRun) {
  EXPECT_EQ(log_of(4, 0.1, 4), "step 4  t = 1 s  dt = 2.50e-01 s  100.0 %  took 0 s\n");
  EXPECT_EQ(log_of(8, 1, 2), "step 2  t = 0.5 s  dt = 2.50e-01 s   25.0 %  took 2 s\n");
  EXPECT_EQ(log_of(8, 1, 0), "");
}

TEST(Progress, EstimatesTheRemainingTimeOfAResumedRun) {
  const silt::file::Stream stream(std::tmpfile());  // must outlive progress
  std::FILE* const file = stream.get();
  double wall = 7;
  Progress progress{file, [&wall] { return wall; }};
  Advancing simulation{.now = 0.75};  // the first step after 0.5
  progress.after_step(simulation, silt::Run{.until = 1});
  wall += 4;
  progress.after_step(simulation, silt::Run{.until = 1});
  EXPECT_GT(std::ftell(file), 0);
  char text[100] = {};
  std::rewind(file);
  EXPECT_GT(std::fread(text, 1, sizeof text - 1, file), 0u);
  EXPECT_EQ(std::string(text), "step 3  t = 0.75 s  dt = 2.50e-01 s   75.0 %  left 4 s\n");
}

TEST(Progress, UpdatesOneLineOnATerminal) {
  const int controller = posix_openpt(O_RDWR | O_NOCTTY);
  if (controller < 0 || grantpt(controller) != 0 || unlockpt(controller) != 0) {
    std::printf("[   note   ] this machine has no pseudo-terminals\n");
    return;
  }
  std::FILE* terminal = std::fopen(ptsname(controller), "w");
  ASSERT_NE(terminal, nullptr);
  {
    Progress progress{terminal};
    run_to_the_end(progress);
  }
  // A read from a terminal may return only part of the output.
  std::string shown;
  while (shown.find('\n') == std::string::npos) {
    pollfd waiting{.fd = controller, .events = POLLIN, .revents = 0};
    ASSERT_EQ(poll(&waiting, 1, 10000), 1) << shown;
    char text[4096];
    const auto length = read(controller, text, sizeof text);
    ASSERT_GT(length, 0) << shown;
    shown.append(text, static_cast<std::size_t>(length));
  }
  EXPECT_EQ(shown.front(), '\r');
  EXPECT_NE(shown.find("step 4  t = 1 s"), std::string::npos) << shown;
  EXPECT_NE(shown.find("100.0 %"), std::string::npos) << shown;
  EXPECT_EQ(shown.back(), '\n');
  EXPECT_EQ(shown.find('\n'), shown.size() - 1) << shown;
  std::fclose(terminal);
  close(controller);
}

}  // namespace
}  // namespace silt::test::progress_test
