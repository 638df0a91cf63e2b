// SPDX-License-Identifier: MIT
// The one place with OpenMP. What stands here gives the same bits for any number of threads:
//   - for_each: every index is worked on by one thread, and writes only what belongs to it;
//   - ordered_sum: sums over fixed chunks, added in the order of the chunks;
//   - an exception of any index is caught, and the one of the lowest index is thrown after the loop.
// The number of threads may therefore change from one loop to the next. It is the one that was
// given; where none was, the steps of a simulation are timed (thread_choice.hpp), and other loops
// use several threads if they are long.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/thread_choice.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace silt {

/// Largest number of threads of a loop that the calling thread begins. Unless it was given, by
/// use_threads() or OMP_NUM_THREADS, loops may use fewer: one where several would be slower.
inline int threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

namespace detail {

/// Whether the number of threads was given to the calling thread.
inline bool& threads_are_given() {
  thread_local bool given = [] {
    const char* const number = std::getenv("OMP_NUM_THREADS");
    return number && *number;
  }();
  return given;
}

}  // namespace detail

/// Sets the number of threads of every loop that the calling thread begins from now on. Throws if
/// it is below 1, or above 1 in a build without OpenMP.
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
  detail::threads_are_given() = true;
}

/// Indices [first, last) of one chunk.
struct Chunk {
  Index number;
  Index first;
  Index last;
};

inline constexpr Index chunk_size = 1024;

inline Index chunk_count(Index n) { return (n + chunk_size - 1) / chunk_size; }

namespace detail {

#ifdef _OPENMP

/// Threads that have a task and a processor. The calling thread may have been confined to fewer
/// processors since the program began.
inline int most_threads(Index tasks) {
  if (tasks < 2 || omp_in_parallel()) return 1;
  return static_cast<int>(
      std::min(tasks, static_cast<Index>(std::min(threads(), omp_get_num_procs()))));
}

/// Threads of the loops of one step, and of what belongs to it, if the number was not given. In
/// force for the calling thread as long as it lives; teams may nest.
class Team {
 public:
  /// For n particles.
  Team(ThreadChoice& choice, Index n) : choice_(choice), outer_(current_) {
    if (!threads_are_given()) {
      const int most = most_threads(chunk_count(n));
      is_chosen_ = most > 1;
      size_ = choice.all() ? most : 1;
    }
    current_ = this;
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  ~Team() { current_ = outer_; }

  void begin_step() {
    if (!is_chosen_) return;
    limit_ = choice_.limit();
    begin_ = Clock::now();
  }
  void end_step() {
    if (is_chosen_) choice_.add(elapsed());
  }

  /// Threads for this many tasks that the calling thread begins now.
  static int size_for_tasks(Index tasks) {
    if (tasks < 2) return 1;
    if (threads_are_given()) return threads();
    return current_ ? current_->size() : most_threads(tasks);
  }
  static int size_for_chunks(Index chunks) {
    // Waking threads takes as long as going through some thousand indices.
    constexpr Index least_alone = 8;
    const bool is_short = chunks < least_alone && !current_ && !threads_are_given();
    return is_short ? 1 : size_for_tasks(chunks);
  }

 private:
  using Clock = std::chrono::steady_clock;

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  int size() {
    if (size_ > 1 && limit_ < std::numeric_limits<double>::infinity() && elapsed() > limit_) {
      size_ = 1;
    }
    return size_;
  }

  static inline thread_local Team* current_ = nullptr;

  ThreadChoice& choice_;
  Team* outer_;
  bool is_chosen_ = false;
  int size_ = 1;
  double limit_ = std::numeric_limits<double>::infinity();  // of the step that began [s]
  Clock::time_point begin_;
};

#else

class Team {
 public:
  Team(ThreadChoice&, Index) {}
  void begin_step() {}
  void end_step() {}
  static int size_for_tasks(Index) { return 1; }
  static int size_for_chunks(Index) { return 1; }
};

#endif

/// f(k) for every k of [0, count), by `team` threads at most. Each has one contiguous run of them.
template <class F>
void share_out(Index count, [[maybe_unused]] int team, F&& f) {
#ifdef _OPENMP
  if (count > 1 && team > 1 && !omp_in_parallel()) {
    // A thread stops at its first fault, and its tasks come in order; the lowest of these first
    // faults is therefore the lowest of all.
    std::exception_ptr fault;
    Index fault_task = no_index;
#pragma omp parallel num_threads(team)
    {
      const auto size = static_cast<Index>(omp_get_num_threads());
      const auto me = static_cast<Index>(omp_get_thread_num());
      const Index last = count * (me + 1) / size;
      Index task = count * me / size;
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

}  // namespace detail

/// Threads that a loop over n indices uses at most if the calling thread begins it now, for work
/// that is divided by threads. No result may depend on it.
inline int threads_for(Index n) { return detail::Team::size_for_chunks(chunk_count(n)); }

/// f(k) for every k of [0, count), in parallel: tasks that are each worth a thread's while. Each
/// thread has one contiguous run of them.
template <class F>
void for_each_task(Index count, F&& f) {
  detail::share_out(count, detail::Team::size_for_tasks(count), f);
}

/// f(chunk) for every chunk of [0, n), in parallel. Each thread has one contiguous run of chunks.
template <class F>
void for_each_chunk(Index n, F&& f) {
  detail::share_out(chunk_count(n), threads_for(n), [&f, n](Index c) {
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
  const Index runs = std::min(chunks, static_cast<Index>(threads_for(n)));
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
