// SPDX-License-Identifier: MIT
// Faults that the sanitizers must find: planted_fault NAME. A build without the sanitizer of that
// fault ends with 0.
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace {

// Not known when compiled.
volatile int one = 1;
volatile double large = 1e300;
int* volatile kept = nullptr;

int read_beyond_the_end() {
  const std::vector<int> values(3);
  return values.data()[2 + one];
}
int read_freed_memory() {
  kept = new int(one);
  delete kept;
  return *kept;
}
int lose_memory() {
  kept = new int[100];
  kept = nullptr;
  return 0;
}
int overflow() { return std::numeric_limits<int>::max() + one; }
int convert_beyond_the_range() { return static_cast<int>(large); }
int load_neither_true_nor_false() {
  const unsigned char two = static_cast<unsigned char>(2 * one);
  bool value;
  std::memcpy(&value, &two, 1);
  return value ? 1 : 0;
}
int add_from_two_threads() {
  int sum = 0;
#ifdef _OPENMP
#pragma omp parallel for num_threads(2)
  for (int i = 0; i < 1000; ++i) sum += one;
#endif
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const struct {
    const char* name;
    int (*commit)();
  } faults[] = {{"read_beyond_the_end", read_beyond_the_end},
                {"read_freed_memory", read_freed_memory},
                {"lose_memory", lose_memory},
                {"overflow", overflow},
                {"convert_beyond_the_range", convert_beyond_the_range},
                {"load_neither_true_nor_false", load_neither_true_nor_false},
                {"add_from_two_threads", add_from_two_threads}};
  for (const auto& fault : faults) {
    if (argc != 2 || std::string(argv[1]) != fault.name) continue;
    std::printf("%d\n", fault.commit());
    return 0;
  }
  std::fprintf(stderr, "usage: planted_fault NAME\n");
  return 2;
}
