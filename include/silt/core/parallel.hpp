// SPDX-License-Identifier: MIT
// The one place with OpenMP. What stands here gives the same bits for any number of threads:
//   - for_each: every index is worked on by one thread, and writes only what belongs to it;
//   - ordered_sum: sums over fixed chunks, added in the order of the chunks;
//   - an exception of any index is caught, and the one of the lowest index is thrown after the loop.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace silt {

/// Threads that the loops below use.
inline int threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

/// Sets the number of threads of this process. Throws if it is below 1, or above 1 in a build
/// without OpenMP.
inline void use_threads(int number) {
  if (number < 1) {
    fail("use_threads: number = " + std::to_string(number) + " is below 1; give at least 1");
  }
#ifdef _OPENMP
  omp_set_num_threads(number);
#else
  if (number > 1) {
    fail("use_threads: number = " + std::to_string(number) +
         ", but this program was built without OpenMP; build it with -fopenmp or give 1");
  }
#endif
}

/// Indices [first, last) of one chunk.
struct Chunk {
  Index number;
  Index first;
  Index last;
};

inline constexpr Index chunk_size = 1024;

inline Index chunk_count(Index n) { return (n + chunk_size - 1) / chunk_size; }

/// f(k) for every k of [0, count), in parallel: tasks that are each worth a thread's while. Each
/// thread has one contiguous run of them.
template <class F>
void for_each_task(Index count, F&& f) {
#ifdef _OPENMP
  if (count > 1 && threads() > 1 && !omp_in_parallel()) {
    // A thread stops at its first fault, and its tasks come in order; the lowest of these first
    // faults is therefore the lowest of all.
    std::exception_ptr fault;
    Index fault_task = no_index;
#pragma omp parallel
    {
      const auto team = static_cast<Index>(omp_get_num_threads());
      const auto me = static_cast<Index>(omp_get_thread_num());
      const Index last = count * (me + 1) / team;
      Index task = count * me / team;
      try {
        for (; task < last; ++task) f(task);
      } catch (...) {
#pragma omp critical(silt_fault)
        if (task < fault_task) {
          fault_task = task;
          fault = std::current_exception();
        }
      }
    }
    if (fault) std::rethrow_exception(fault);
    return;
  }
#endif
  for (Index task = 0; task < count; ++task) f(task);
}

/// f(chunk) for every chunk of [0, n), in parallel. Each thread has one contiguous run of chunks.
template <class F>
void for_each_chunk(Index n, F&& f) {
  for_each_task(chunk_count(n), [&f, n](Index c) {
    f(Chunk{c, c * chunk_size, std::min(n, (c + 1) * chunk_size)});
  });
}

/// f(i) for every i of [0, n), in parallel.
template <class F>
void for_each(Index n, F&& f) {
  for_each_chunk(n, [&f](Chunk chunk) {
    for (Index i = chunk.first; i < chunk.last; ++i) f(i);
  });
}

/// What each chunk of [0, n) comes to, in memory that the thread keeps for the next time.
template <class Value>
class PerChunk {
 public:
  PerChunk(Index n, const Value& initial) : values_(std::move(spare())) {
    values_.assign(chunk_count(n), initial);
  }
  PerChunk(const PerChunk&) = delete;
  PerChunk& operator=(const PerChunk&) = delete;
  ~PerChunk() { spare() = std::move(values_); }

  Value& operator[](Index chunk) noexcept { return values_[chunk]; }
  auto begin() const noexcept { return values_.begin(); }
  auto end() const noexcept { return values_.end(); }

 private:
  // Within an f that sums itself, the inner one finds this empty.
  static std::vector<Value>& spare() noexcept {
    thread_local std::vector<Value> memory;
    return memory;
  }
  std::vector<Value> values_;
};

/// Chunks of one loop, from the first to the last.
struct ChunkSpan {
  Index first;
  Index last;
};

/// make(chunk) and then use(chunk) for every chunk of [0, n), in parallel; use(chunk) comes after
/// make() of all chunks of needs(chunk), and not long after, while what was made is at hand.
template <class Make, class Use, class Needs>
void for_each_chunk_in_two(Index n, Make&& make, Use&& use, Needs&& needs) {
  const auto chunk_at = [n](Index c) {
    return Chunk{c, c * chunk_size, std::min(n, (c + 1) * chunk_size)};
  };
  const Index chunks = chunk_count(n);
  const Index runs = std::min(chunks, static_cast<Index>(threads()));
  // Chunks between the two: a bed of 32 000 grains takes a tenth less time than with none.
  constexpr Index lag = 2;
  PerChunk<char> used(n, false);
  for_each_task(runs, [&](Index run) {
    const Index begin = chunks * run / runs;
    const Index end = chunks * (run + 1) / runs;
    Index next = begin;
    for (Index c = begin; c < end; ++c) {
      make(chunk_at(c));
      const Index reached = c + 1 == end ? c : c - std::min(c, lag);
      for (; next < end && needs(chunk_at(next)).last <= reached; ++next) {
        if (needs(chunk_at(next)).first < begin) continue;  // it needs what others make
        use(chunk_at(next));
        used[next] = true;
      }
    }
  });
  PerChunk<std::uint32_t> left(n, 0);
  Index count = 0;
  for (Index c = 0; c < chunks; ++c) {
    if (!used[c]) left[count++] = static_cast<std::uint32_t>(c);
  }
  for_each_task(count, [&](Index k) { use(chunk_at(left[k])); });
}

/// Σ f(i), the same bits for any number of threads.
template <class Value, class F>
Value ordered_sum(Index n, const Value& zero, F&& f) {
  PerChunk<Value> partial(n, zero);
  for_each_chunk(n, [&](Chunk chunk) {
    Value sum = zero;
    for (Index i = chunk.first; i < chunk.last; ++i) sum += f(i);
    partial[chunk.number] = sum;
  });
  Value sum = zero;
  for (const Value& part : partial) sum += part;
  return sum;
}

/// max over f(i), at least `least`.
template <class Value, class F>
Value largest(Index n, Value least, F&& f) {
  PerChunk<Value> partial(n, least);
  for_each_chunk(n, [&](Chunk chunk) {
    Value most = least;
    for (Index i = chunk.first; i < chunk.last; ++i) most = std::max<Value>(most, f(i));
    partial[chunk.number] = most;
  });
  Value most = least;
  for (const Value& part : partial) most = std::max<Value>(most, part);
  return most;
}

/// Lowest i for which f(i) holds, `no_index` if there is none.
template <class F>
Index first_where(Index n, F&& f) {
  PerChunk<Index> found(n, no_index);
  for_each_chunk(n, [&](Chunk chunk) {
    for (Index i = chunk.first; i < chunk.last; ++i) {
      if (f(i)) {
        found[chunk.number] = i;
        return;
      }
    }
  });
  for (const Index i : found) {
    if (i != no_index) return i;
  }
  return no_index;
}

}  // namespace silt
