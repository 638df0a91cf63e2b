// SPDX-License-Identifier: MIT
// Runs a fuzz target without libFuzzer: fuzz_NAME FOLDER [NUMBER [FIRST]] passes all files of the
// folder to it, then so many random changes of them; fuzz_NAME FILE passes one file. An input that
// fails is written to the file fuzz_NAME.input.
#include <silt/core/parallel.hpp>

#include "fuzz/counts.hpp"
#include "fuzz/mutation.hpp"
#include "support/sanitizers.hpp"
#include <sys/time.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#if SILT_HAS_ADDRESS_SANITIZER
extern "C" void __sanitizer_set_death_callback(void (*callback)());
#endif

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using namespace silt;
namespace fs = std::filesystem;

constexpr int longest = 20;  // processor time of one input until it counts as endless [s]

// Global, for signal handlers.
std::string input;
std::string input_name;
std::string failed_path;

void report(const char* what) {
  std::fprintf(stderr, "%s: %s; it is in %s\n", input_name.c_str(), what, failed_path.c_str());
  std::ofstream(failed_path, std::ios::binary) << input;
}

// The process is about to end anyway: what a signal handler may not do can only fail.
[[noreturn]] void report_signal(int number) {
  std::signal(SIGABRT, SIG_DFL);
  report(number == SIGPROF   ? "takes too long"
         : number == SIGABRT ? "ends the program by abort()"
                             : "ends the program by a signal");
  std::_Exit(1);
}

void limit_time(int seconds) {
  const itimerval timer{.it_interval = {}, .it_value = {.tv_sec = seconds, .tv_usec = 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
}

std::string read(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool passes(std::string bytes, std::string name) {
  input = std::move(bytes);
  input_name = std::move(name);
  limit_time(longest);
  try {
    // A copy of exactly this size, so that a sanitizer notices a read beyond its end.
    const std::vector<std::uint8_t> exactly(input.begin(), input.end());
    LLVMFuzzerTestOneInput(exactly.data(), exactly.size());
  } catch (const std::exception& error) {
    report(error.what());
    return false;
  } catch (...) {
    report("throws something unknown");
    return false;
  }
  return true;
}

int replay(const std::vector<std::string>& arguments) {
  const fs::path corpus = arguments.at(1);
  if (!fs::is_directory(corpus)) return passes(read(corpus), corpus.string()) ? 0 : 1;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(corpus)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  if (paths.empty()) throw std::runtime_error(corpus.string() + " is empty");
  std::vector<std::string> texts;
  for (const fs::path& path : paths) {
    texts.push_back(read(path));
    if (!passes(texts.back(), path.string())) return 1;
  }
  const std::uint64_t number = arguments.size() > 2 ? std::stoull(arguments[2]) : 0;
  const std::uint64_t first = arguments.size() > 3 ? std::stoull(arguments[3]) : 0;
  const fuzz::Mutations mutations(texts);
  for (std::uint64_t k = first; k < first + number; ++k) {
    if (!passes(mutations.input(k), "input " + std::to_string(k))) return 1;
  }
  limit_time(0);
  std::printf("%zu files and %llu further inputs: %llu calls succeeded, %llu were refused\n",
              texts.size(), static_cast<unsigned long long>(number),
              static_cast<unsigned long long>(fuzz::accepted),
              static_cast<unsigned long long>(fuzz::refused));
  // Otherwise one of the two is not tested.
  if (fuzz::accepted == 0 || fuzz::refused == 0) return 1;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv, argv + argc);
  if (argc < 2 || argc > 4) {
    std::fprintf(stderr, "usage: %s FOLDER [NUMBER [FIRST]]  or  %s FILE\n", argv[0], argv[0]);
    return 2;
  }
  failed_path = fs::path(arguments[0]).filename().string() + ".input";
  for (const int each : {SIGPROF, SIGABRT}) std::signal(each, report_signal);
#if SILT_HAS_ADDRESS_SANITIZER
  __sanitizer_set_death_callback([] { report("makes a sanitizer end the program"); });
#else
  for (const int each : {SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(each, report_signal);
#endif
  use_threads(1);
  try {
    return replay(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 2;
  }
}
