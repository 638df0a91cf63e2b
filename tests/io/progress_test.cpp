// SPDX-License-Identifier: MIT
#include <silt/core/simulation.hpp>
#include <silt/io/progress.hpp>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <unistd.h>

namespace {

using namespace silt;

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
    progress.after_step(simulation, Run{.until = 1});
  }
}

TEST(Progress, IsSilentWhereThereIsNoTerminal) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  {
    Progress progress{file};
    run_to_the_end(progress);
  }
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

TEST(Progress, RewritesOneLineOnATerminalAndEndsIt) {
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
  // A terminal hands over what it has so far, which need not be all.
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
