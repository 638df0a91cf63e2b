// SPDX-License-Identifier: MIT
// A file that is replaced is the whole old or the whole new one at any time: with several writers,
// behind symbolic links, and after any system call has failed.
#include <silt/core/simulation.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/silt.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

namespace silt::test::replaced_file_test {
namespace {

using file::Outlasts;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}
Index files_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<Index>(std::distance(begin(files), end(files)));
}

// The calls of the system, of which one fails.
struct FailingCalls : file::SystemCalls {
  static inline int until_failure = 0;  // the number of the call that fails
  static inline bool writes_halves = false;
  static inline std::vector<std::string> calls;

  static bool fails(const char* name) {
    calls.emplace_back(name);
    if (--until_failure != 0) return false;
    errno = ENOSPC;
    return true;
  }
  static File create(const char* path) {
    return fails("create") ? none : SystemCalls::create(path);
  }
  static File open_folder(const char* path) {
    return fails("open_folder") ? none : SystemCalls::open_folder(path);
  }
  static std::ptrdiff_t write(File file, const char* bytes, std::size_t size) {
    if (fails("write")) return -1;
    return SystemCalls::write(file, bytes, writes_halves ? (size + 1) / 2 : size);
  }
  static int sync(File file) { return fails("sync") ? -1 : SystemCalls::sync(file); }
  static int close(File file) {
    const bool is_failure = fails("close");
    const int answer = SystemCalls::close(file);
    if (is_failure) errno = ENOSPC;
    return is_failure ? -1 : answer;
  }
  static int rename(const char* from, const char* to) {
    return fails("rename") ? -1 : SystemCalls::rename(from, to);
  }
};

TEST(ReplacedFile, IsTheOldOneAfterAnyFailedCall) {
  const Folder folder;
  const auto path = folder.path / "state";
  for (const Outlasts outlasts : {Outlasts::the_process, Outlasts::power_failure}) {
    for (const bool halves : {false, true}) {
      FailingCalls::writes_halves = halves;
      for (int k = 1;; ++k) {
        file::replace("old", path, "old");
        FailingCalls::calls.clear();
        FailingCalls::until_failure = k;
        std::string message;
        try {
          file::replace<FailingCalls>("test", path, "new bytes", outlasts);
        } catch (const Error& error) {
          message = error.what();
        }
        EXPECT_EQ(files_in(folder.path), 1u);
        if (FailingCalls::until_failure > 0) {
          EXPECT_EQ(message, "");
          EXPECT_EQ(bytes_of(path), "new bytes");
          EXPECT_GE(k, outlasts == Outlasts::power_failure ? 8 : 5);
          break;
        }
        const std::string failed = FailingCalls::calls[Index(k) - 1];
        const auto before_failure = FailingCalls::calls.begin() + (k - 1);
        const bool is_done =
            std::find(FailingCalls::calls.begin(), before_failure, "rename") != before_failure;
        EXPECT_EQ(bytes_of(path), is_done ? "new bytes" : "old") << failed;
        if (is_done && failed == "close") continue;  // of the folder: nothing is lost
        EXPECT_NE(message.find("test: "), message.npos) << failed;
        EXPECT_NE(message.find(folder.path.string()), message.npos) << message;
        EXPECT_NE(message.find("No space left"), message.npos) << message;
      }
    }
  }
  FailingCalls::until_failure = 0;
  FailingCalls::calls.clear();
  file::replace<FailingCalls>("test", path, "new", Outlasts::power_failure);
  EXPECT_EQ(FailingCalls::calls,
            (std::vector<std::string>{"create", "write", "write", "sync", "close", "open_folder",
                                      "rename", "sync", "close"}));
}

// The calls of the system in a folder that cannot be opened or made permanent.
struct CallsInFolder : file::SystemCalls {
  static inline int open_error = 0;
  static inline int sync_error = 0;
  static inline File folder = none;
  static inline int open_files = 0;

  static bool fails(int error) {
    if (error != 0) errno = error;
    return error != 0;
  }
  static File create(const char* path) {
    ++open_files;
    folder = none;
    return SystemCalls::create(path);
  }
  static File open_folder(const char* path) {
    if (fails(open_error)) return none;
    ++open_files;
    return folder = SystemCalls::open_folder(path);
  }
  static int sync(File file) {
    return file == folder && fails(sync_error) ? -1 : SystemCalls::sync(file);
  }
  static int close(File file) {
    --open_files;
    return SystemCalls::close(file);
  }
};

TEST(ReplacedFile, IsTheNewOneIfTheFolderCannotBeMadePermanent) {
  const Folder folder;
  const auto path = folder.path / "state";
  const auto write = [&](int open_error, int sync_error) {
    CallsInFolder::open_error = open_error;
    CallsInFolder::sync_error = sync_error;
    file::replace("old", path, "old");
    file::replace<CallsInFolder>("test", path, "new", Outlasts::power_failure);
  };
  // A folder without the right to read it, and file systems that cannot do this for folders.
  EXPECT_NO_THROW(write(EACCES, 0));
  EXPECT_EQ(bytes_of(path), "new");
  for (const int error : {EINVAL, ENOTSUP, EOPNOTSUPP, ENOSYS, EBADF}) {
    EXPECT_NO_THROW(write(0, error)) << error;
    EXPECT_EQ(bytes_of(path), "new");
  }
  EXPECT_TRUE(refuses([&] { write(EMFILE, 0); }, {"cannot open " + folder.path.string()}));
  EXPECT_EQ(bytes_of(path), "old");
  EXPECT_TRUE(refuses([&] { write(0, EIO); }, {"replaced, but cannot make permanent"}));
  EXPECT_EQ(bytes_of(path), "new");
  EXPECT_EQ(files_in(folder.path), 1u);
  EXPECT_EQ(CallsInFolder::open_files, 0);
}

auto flight(Index along, double time_step, int steps) {
  const auto points = lattice(cube<2, double>(0, double(along)), 1.0);
  Particles<2, double, velocity_t, force_t, mass_t> particles;
  for (const auto& x : points) {
    const Index i = particles.add(x);
    particles[mass][i] = 1;
  }
  Simulation simulation{particles, UniformGrid<2>{}, Gravity<2>{{0, -1}}, Leapfrog{}};
  for (int k = 0; k < steps; ++k) simulation.step(time_step);
  return simulation;
}

TEST(ReplacedFile, IsWholeWithTwoWritersAndAReader) {
  const Folder folder;
  const auto path = folder.path / "state";
  const auto small = flight(3, 0.1, 1);
  const auto large = flight(60, 0.1, 2);
  write_checkpoint(path, small);
  std::atomic<bool> ends = false;
  std::atomic<int> writes = 0;
  const auto writer = [&](const auto& simulation) {
    return std::thread([&] {
      while (!ends) {
        write_checkpoint(path, simulation);
        ++writes;
      }
    });
  };
  std::thread first = writer(small);
  std::thread second = writer(large);
  std::vector<int> reads(2, 0);
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < std::chrono::seconds(1)) {
    auto simulation = flight(1, 0.1, 0);
    EXPECT_NO_THROW(read_checkpoint(path, simulation));
    const bool is_small = simulation.steps() == 1;
    EXPECT_EQ(state_of(simulation.particles()),
              state_of(is_small ? small.particles() : large.particles()));
    ++reads[is_small ? 0 : 1];
  }
  ends = true;
  first.join();
  second.join();
  EXPECT_GT(reads[0], 0);
  EXPECT_GT(reads[1], 0);
  EXPECT_GT(writes, 4);
  EXPECT_EQ(files_in(folder.path), 1u);
}

TEST(ReplacedFile, LeavesNothingOfProcessesThatWereKilled) {
  const Folder folder;
  const auto path = folder.path / "state";
  const auto write_in_another_process = [&] {
    const pid_t writer = ::fork();
    if (writer == 0) {
      struct Killed : file::SystemCalls {
        static int rename(const char*, const char*) {
          ::_exit(0);  // as if killed
        }
      };
      try {
        file::replace<Killed>("test", path, "lost");
      } catch (...) {
      }
      ::_exit(1);
    }
    int status = 1;
    EXPECT_EQ(::waitpid(writer, &status, 0), writer);
    EXPECT_EQ(status, 0);
  };
  write_in_another_process();
  EXPECT_EQ(files_in(folder.path), 1u);
  write_in_another_process();
  EXPECT_EQ(files_in(folder.path), 1u);
  std::ofstream(folder.path / "state.another-computer.1234567890-1.part") << "of another computer";
  std::ofstream(folder.path / ("state." + file::SystemCalls::computer() + ".1-1.part"))
      << "running";
  file::replace("test", path, "new");
  EXPECT_EQ(bytes_of(path), "new");
  EXPECT_EQ(files_in(folder.path), 3u);
}

TEST(ReplacedFile, IsTheTargetOfALink) {
  const Folder folder;
  std::filesystem::create_directories(folder.path / "a");
  std::filesystem::create_directories(folder.path / "b");
  const auto target = folder.path / "b/state";
  std::filesystem::create_symlink("second", folder.path / "a/first");
  std::filesystem::create_symlink("../b/state", folder.path / "a/second");
  for (const char* text : {"one", "two"}) {  // the target is made, then replaced
    file::replace("test", folder.path / "a/first", text, Outlasts::power_failure);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "a/first"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "a/second"));
    EXPECT_EQ(bytes_of(target), text);
    EXPECT_EQ(files_in(folder.path / "a"), 2u);
    EXPECT_EQ(files_in(folder.path / "b"), 1u);
  }
  const auto loop = folder.path / "loop";
  std::filesystem::create_symlink("loop", loop);
  EXPECT_TRUE(refuses([&] { file::replace("test", loop, "new"); },
                      {"test: cannot open " + loop.string(), "Too many levels"}));
}

TEST(ReplacedFile, IsRefusedWithPathAndReason) {
  const Folder folder;
  const auto simulation = flight(3, 0.1, 1);
  const auto path = folder.path / "state";
  write_checkpoint(path, simulation);
  const std::string before = bytes_of(path);
  const auto refused = [&](const std::filesystem::path& at, const std::string& reason) {
    EXPECT_TRUE(refuses([&] { write_checkpoint(at, simulation); },
                        {"write_checkpoint: cannot", at.string(), reason}));
    EXPECT_EQ(files_in(folder.path), 1u);
    EXPECT_EQ(bytes_of(path), before);
  };
  refused(folder.path / "missing/state", "No such file");
  refused(path / "state", "Not a directory");
  refused(folder.path / std::string(300, 'a'), "File name too long");
  refused(folder.path, "not a file");

  // As with a full disc.
  rlimit limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit few{.rlim_cur = 100, .rlim_max = limit.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &few), 0);
  refused(path, "File too large");
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
}

}  // namespace
}  // namespace silt::test::replaced_file_test
