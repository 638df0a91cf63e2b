// SPDX-License-Identifier: MIT
// Parallel loops; the only file that uses OpenMP. Results are bitwise identical for any number of
// threads:
//   - for_each: every index is processed by one thread, which writes only data of that index;
//   - ordered_sum: sums over fixed chunks, added in the order of the chunks;
//   - if several indices throw, the exception of the lowest index is rethrown after the loop.
// The number of threads may therefore change from one loop to the next. It can be given by
// use_threads() or OMP_NUM_THREADS. Otherwise the steps of a simulation are timed
// (thread_choice.hpp), and other loops use several threads if they are long enough.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/instruction_set.hpp>
#include <silt/core/largest_of.hpp>
#include <silt/core/thread_choice.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <limits>
#include <utility>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace silt {

/// Maximum number of threads of a loop started by the calling thread. Unless the number was given,
/// by use_threads() or OMP_NUM_THREADS, loops may use fewer: one where several would be slower.
inline int threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

namespace detail {

/// Whether the number of threads of the calling thread's loops was given.
inline bool& threads_are_given() {
  thread_local bool given = [] {
    const char* const number = std::getenv("OMP_NUM_THREADS");
    return number && *number;
  }();
  return given;
}

}  // namespace detail

/// Sets the number of threads of all loops that the calling thread starts from now on. Throws if it
/// is below 1 or above 1024, or above 1 in a build without OpenMP.
inline void use_threads(int number) {
  if (number < 1) {
    fail({"use_threads: number = ", number, " is below 1; give at least 1"});
  }
  if (number > 1024) {
    fail({"use_threads: number = ", number, " is above 1024; give at most 1024"});
  }
#ifdef _OPENMP
  omp_set_num_threads(number);
#else
  if (number > 1) {
    fail({"use_threads: number = ", number,
          ", but this program was built without OpenMP; build it with -fopenmp or give 1"});
  }
#endif
  detail::threads_are_given() = true;
}

/// One chunk: its number and its indices [first, last).
struct Chunk {
  Index number;
  Index first;
  Index last;
};

/// Number of indices of a chunk; the last one may have fewer.
inline constexpr Index chunk_size = 1024;

/// Number of chunks of [0, n).
inline Index chunk_count(Index n) { return (n + chunk_size - 1) / chunk_size; }

namespace detail {

#ifdef _OPENMP

/// Maximum number of threads for so many tasks: not more than there are processors, which may be
/// fewer now than when the program began (processor affinity).
inline int max_threads(Index tasks) {
  if (tasks < 2 || omp_in_parallel()) return 1;
  return static_cast<int>(
      std::min(tasks, static_cast<Index>(std::min(threads(), omp_get_num_procs()))));
}

/// Sets the number of threads for all loops of a step and of its observers, unless the number was
/// given. Applies to the calling thread during the lifetime of the object; teams may be nested.
class Team {
 public:
  /// For n particles.
  Team(ThreadChoice& choice, Index n) : choice_(choice), outer_(current_) {
    if (!threads_are_given()) {
      const int max_size = max_threads(chunk_count(n));
      is_chosen_ = max_size > 1;
      size_ = choice.all() ? max_size : 1;
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

  /// Number of threads for so many tasks, started by the calling thread now.
  static int size_for_tasks(Index tasks) {
    if (tasks < 2) return 1;
    if (threads_are_given()) return threads();
    return current_ ? current_->size() : max_threads(tasks);
  }
  static int size_for_chunks(Index chunks) {
    // Waking threads takes as long as processing several thousand indices.
    constexpr Index min_parallel_chunks = 8;
    const bool is_short = chunks < min_parallel_chunks && !current_ && !threads_are_given();
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
  double limit_ = std::numeric_limits<double>::infinity();  // of the current step [s]
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

/// The tasks of one thread that no thread has begun; in a cache line of its own.
struct alignas(64) Share {
  Index next;
  Index last;

  struct Tasks {
    Index first;
    Index last;
    explicit operator bool() const { return first < last; }
  };
  /// Half of them, for few atomic operations; none if there are none.
  Tasks take() {
    const std::atomic_ref<Index> remaining(next);
    Tasks taken{remaining.load(std::memory_order_relaxed), last};
    do {
      taken.last = taken.first + (last - taken.first + 1) / 2;
    } while (taken.first < last &&
             !remaining.compare_exchange_weak(taken.first, taken.last, std::memory_order_relaxed));
    return taken;
  }
};

/// Equal contiguous shares of [0, count). The thread keeps the memory for the next such object,
/// unless it is in use by a loop around this one.
class Shares {
 public:
  Shares(Index count, int team) : shares_(std::move(spare())) {
    const auto size = static_cast<Index>(team);
    shares_.resize(size);
    for (Index k = 0; k < size; ++k) shares_[k] = {count * k / size, count * (k + 1) / size};
  }
  Shares(const Shares&) = delete;
  Shares& operator=(const Shares&) = delete;
  ~Shares() { spare() = std::move(shares_); }

  Index size() const { return shares_.size(); }
  Share& operator[](Index k) { return shares_[k]; }

 private:
  static Buffer<Share>& spare() {
    static thread_local Buffer<Share> memory;
    return memory;
  }
  Buffer<Share> shares_;
};

/// run(k) for every task k in [0, count), with at most `team` threads. Each has a contiguous share,
/// so that successive loops find their data in its cache; once it has finished its share, it helps
/// the others, because tasks may take different times and a core may be busy. No template and not
/// inlined, as other functions for loops: a program has hundreds of loops, and each would compile
/// all of this.
[[gnu::noinline]] inline void run_tasks(Index count, [[maybe_unused]] int team,
                                        FunctionRef<void(Index)> run) {
#ifdef _OPENMP
  if (count > 1 && team > 1 && !omp_in_parallel()) {
    // After an exception, a thread leaves out only the rest of the share that it took; the lowest
    // exception of all is therefore found.
    std::exception_ptr fault;
    Index fault_task = no_index;
    Shares shares(count, team);
    const auto run_share = [&](Share::Tasks tasks) {
      try {
        for (; tasks.first < tasks.last; ++tasks.first) run(tasks.first);
      } catch (...) {
#pragma omp critical(silt_fault)
        if (tasks.first < fault_task) {
          fault_task = tasks.first;
          fault = std::current_exception();
        }
      }
    };
#pragma omp parallel num_threads(team)
    for (Index k = 0; k < shares.size(); ++k) {
      Share& share = shares[(static_cast<Index>(omp_get_thread_num()) + k) % shares.size()];
      while (const auto tasks = share.take()) run_share(tasks);
    }
    if (fault) std::rethrow_exception(fault);
    return;
  }
#endif
  for (Index task = 0; task < count; ++task) run(task);
}

}  // namespace detail

/// Maximum number of threads of a loop over n indices that the calling thread starts now, for work
/// that is divided among threads. Results must not depend on it.
[[gnu::noinline]] inline int threads_for(Index n) {
  return detail::Team::size_for_chunks(chunk_count(n));
}

/// f(k) for every k in [0, count), in parallel, for few long tasks.
[[gnu::noinline]] inline void for_each_task(Index count, FunctionRef<void(Index)> f) {
  detail::run_tasks(count, detail::Team::size_for_tasks(count), f);
}

/// f(chunk) for every chunk of [0, n), in parallel.
[[gnu::noinline]] inline void for_each_chunk(Index n, FunctionRef<void(Chunk)> f) {
  detail::run_tasks(chunk_count(n), threads_for(n), [f, n](Index number) {
    f({number, number * chunk_size, std::min(n, (number + 1) * chunk_size)});
  });
}

/// Number of indices of a range, unless given.
inline constexpr Index range_size = 64;
/// f(first, last) for short ranges of [0, n) that together cover it, in parallel: all ranges but
/// the last have `size` indices. What one range reads and writes stays in the cache between several
/// loops over it.
template <Index size = range_size>
[[gnu::noinline]] void for_each_range(Index n, FunctionRef<void(Index first, Index last)> f) {
  detail::run_tasks((n + size - 1) / size, threads_for(n),
                    [f, n](Index r) { f(r * size, std::min(n, (r + 1) * size)); });
}

/// Number of rows of different lengths, such as those of neighbours, that are stored together, by
/// one thread. A few chunks alone could not be divided equally.
inline constexpr Index rows_together = 256;
/// Number of sets of rows_together rows, of which the last may have fewer.
inline Index row_sets(Index rows) { return (rows + rows_together - 1) / rows_together; }

/// f(i) for every i in [0, n), in parallel.
template <class F>
void for_each(Index n, F&& f) {
  for_each_range(n, [&f](Index first, Index last) {
    for (Index i = first; i < last; ++i) f(i);
  });
}

/// One value for each chunk of [0, n). The thread keeps the memory for the next such object.
template <class Value>
class PerChunk {
 public:
  /// All values are `initial`.
  PerChunk(Index n, const Value& initial) : values_(std::move(spare())) {
    values_.assign(chunk_count(n), initial);
  }
  PerChunk(const PerChunk&) = delete;
  PerChunk& operator=(const PerChunk&) = delete;
  ~PerChunk() {
    values_.clear();
    spare() = std::move(values_);
  }

  Value& operator[](Index chunk) noexcept { return values_[chunk]; }
  auto begin() const noexcept { return values_.begin(); }
  auto end() const noexcept { return values_.end(); }

 private:
  // Empty for an object constructed during the lifetime of another one.
  static Buffer<Value>& spare() noexcept {
    thread_local Buffer<Value> memory;
    return memory;
  }
  Buffer<Value> values_;
};

namespace detail {

/// add(chunk, value) to `initial` for each chunk of [0, n), in parallel; combined in their order.
template <class Value>
Value reduce_chunks(Index n, const Value& initial, FunctionRef<void(Chunk, Value&)> add,
                    void (*combine)(Value& result, const Value& of_chunk)) {
  PerChunk<Value> values(n, initial);
  for_each_chunk(n, [&](Chunk chunk) {
    Value value = initial;
    add(chunk, value);
    values[chunk.number] = value;
  });
  Value result = initial;
  for (const Value& value : values) combine(result, value);
  return result;
}

}  // namespace detail

/// Σ f(i), bitwise identical for any number of threads.
template <class Value, class F>
Value ordered_sum(Index n, const Value& zero, F&& f) {
  return detail::reduce_chunks<Value>(
      n, zero,
      [&f](Chunk chunk, Value& result) {
        Value sum = result;
        for (Index i = chunk.first; i < chunk.last; ++i) sum += f(i);
        result = sum;
      },
      [](Value& sum, const Value& of_chunk) { sum += of_chunk; });
}

namespace detail {
template <class Value, class F>
Value largest_in(Chunk chunk, Value initial, F& f) {
  return SILT_FOR_PROCESSOR(largest_of<Value, F>)(chunk.first, chunk.last, initial, f);
}
}  // namespace detail

/// Maximum of `initial` and all f(i).
template <class Value, class F>
Value largest(Index n, Value initial, F&& f) {
  return detail::reduce_chunks<Value>(
      n, initial,
      [&f](Chunk chunk, Value& result) { result = detail::largest_in(chunk, result, f); },
      [](Value& maximum, const Value& of_chunk) { maximum = std::max<Value>(maximum, of_chunk); });
}

/// Lowest i for which f(i) is true; `no_index` if there is none.
template <class F>
Index first_where(Index n, F&& f) {
  return detail::reduce_chunks<Index>(
      n, no_index,
      [&f](Chunk chunk, Index& result) {
        for (Index i = chunk.first; i < chunk.last; ++i) {
          if (f(i)) {
            result = i;
            return;
          }
        }
      },
      [](Index& lowest, const Index& of_chunk) { lowest = std::min(lowest, of_chunk); });
}

}  // namespace silt
