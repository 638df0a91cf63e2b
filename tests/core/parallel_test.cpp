// SPDX-License-Identifier: MIT
#include <silt/core/parallel.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace silt::test::parallel_test {
namespace {

class Threads : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OneToFour, Threads, ::testing::Values(1, 2, 3, 4));

// Sizes around the chunk size, and several chunks per thread.
const std::vector<Index> sizes{
    0, 1, chunk_size - 1, chunk_size, chunk_size + 1, 10 * chunk_size + 7};

TEST_P(Threads, ProcessEveryIndexOnce) {
  with_threads(GetParam(), [] {
    for (const Index n : sizes) {
      std::vector<int> visits(n, 0);
      for_each(n, [&](Index i) { ++visits[i]; });
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(n));
    }
  });
}

// Values of very different magnitude, so that the last bits depend on the order of addition.
double term(Index i) { return std::sin(double(i) * 12.9898) * std::pow(10.0, double(i % 17) - 8); }

TEST_P(Threads, SumToTheSameBits) {
  for (const Index n : sizes) {
    const double alone = with_threads(1, [n] { return ordered_sum(n, 0.0, term); });
    const double together = with_threads(GetParam(), [n] { return ordered_sum(n, 0.0, term); });
    EXPECT_EQ(alone, together);
  }
}

TEST(OrderedSum, IsTheSumAndTheInitialValueIfEmpty) {
  EXPECT_EQ(ordered_sum(5000, Index{0}, [](Index i) { return i; }), Index{5000 * 4999 / 2});
  EXPECT_EQ(ordered_sum(0, 3.5, term), 3.5);
}

TEST_P(Threads, FindTheMaximumAndTheFirst) {
  with_threads(GetParam(), [] {
    EXPECT_EQ(largest(9000, 0.0, [](Index i) { return double(i == 4321 ? 7 : i % 5); }), 7.0);
    EXPECT_EQ(largest(0, -2.0, [](Index) { return 1.0; }), -2.0);
    EXPECT_EQ(largest(10, 3.0, [](Index) { return 1.0; }), 3.0);
    EXPECT_EQ(first_where(9000, [](Index i) { return i >= 5000 || i == 4444; }), 4444u);
    EXPECT_EQ(first_where(9000, [](Index) { return false; }), no_index);
  });
}

TEST_P(Threads, RethrowTheExceptionOfTheLowestIndex) {
  with_threads(GetParam(), [] {
    for (const Index lowest : {Index{0}, Index{1500}, Index{5000}, 10 * chunk_size}) {
      for (int repeat = 0; repeat < 20; ++repeat) {
        try {
          for_each(11 * chunk_size, [&](Index i) {
            if (i >= lowest) throw std::runtime_error(std::to_string(i));
          });
          FAIL() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
          EXPECT_EQ(error.what(), std::to_string(lowest));
        }
      }
    }
  });
}

TEST_P(Threads, ProcessEveryIndexOnceInRanges) {
  with_threads(GetParam(), [&] {
    for (const Index n : sizes) {
      std::vector<std::atomic<int>> visits(n);
      for_each_range(n, [&](Index first, Index last) {
        EXPECT_LT(first, last);
        EXPECT_LE(last - first, range_size);
        for (Index i = first; i < last; ++i) ++visits[i];
      });
      EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](const auto& v) { return v == 1; }));
    }
  });
}

TEST_P(Threads, ProcessEveryIndexOnceInChunks) {
  with_threads(GetParam(), [&] {
    for (const Index n : sizes) {
      std::vector<std::atomic<int>> visits(n);
      std::vector<std::atomic<int>> chunks(chunk_count(n));
      for_each_chunk(n, [&](Chunk chunk) {
        EXPECT_EQ(chunk.first, chunk.number * chunk_size);
        EXPECT_LT(chunk.first, chunk.last);
        EXPECT_EQ(chunk.last % chunk_size == 0 || chunk.last == n, true);
        ++chunks[chunk.number];
        for (Index i = chunk.first; i < chunk.last; ++i) ++visits[i];
      });
      const auto is_one = [](const auto& v) { return v == 1; };
      EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), is_one));
      EXPECT_TRUE(std::all_of(chunks.begin(), chunks.end(), is_one));
    }
  });
}

TEST_P(Threads, MayNestLoops) {
  with_threads(GetParam(), [] {
    std::vector<double> sums(3000);
    for_each(sums.size(), [&](Index i) {
      sums[i] = ordered_sum(2100, 0.0, [i](Index k) { return double(i + k); });
    });
    for (Index i = 0; i < sums.size(); ++i)
      ASSERT_EQ(sums[i], 2100.0 * double(i) + 2100 * 2099 / 2);
  });
}

TEST(UseThreads, SetsTheNumberAndRejectsZero) {
#ifdef _OPENMP
  with_threads(4, [] { EXPECT_EQ(threads(), 4); });
#endif
  const int before = threads();
  EXPECT_TRUE(refuses([] { use_threads(0); }, {"use_threads", "number = 0"}));
  EXPECT_TRUE(refuses([] { use_threads(-3); }, {"use_threads", "number = -3"}));
  EXPECT_EQ(threads(), before);
}

// `available` is the number of threads of the machine, at most 4.
class AutomaticThreads : public ::testing::Test {
 protected:
  static constexpr Index many = 100 * chunk_size;

  // Calls f as in a program with at most four threads whose number was not given.
  template <class F>
  static void run(F&& f) {
    with_threads(4, [&] {
      detail::threads_are_given() = false;
      f(threads_for(many));
    });
  }
  // A choice whose next step is the first with all threads.
  static detail::ThreadChoice all_threads() {
    detail::ThreadChoice choice;
    choice.add(0.02);
    EXPECT_TRUE(choice.all());
    return choice;
  }
};

TEST_F(AutomaticThreads, AreOneForShortLoopsOutsideOfSteps) {
  run([](int available) {
    EXPECT_LE(available, 4);
    EXPECT_EQ(threads_for(7 * chunk_size), 1);
    EXPECT_EQ(threads_for(8 * chunk_size), available);
  });
}

TEST_F(AutomaticThreads, AreThoseChosenForTheStep) {
  run([](int available) {
    detail::ThreadChoice slow;
    detail::ThreadChoice fast = all_threads();
    const detail::Team team(slow, many);
    EXPECT_EQ(threads_for(many), 1);
    {
      const detail::Team inner(fast, many);
      EXPECT_EQ(threads_for(many), available);
      EXPECT_EQ(threads_for(2 * chunk_size), available);
      EXPECT_EQ(threads_for(chunk_size), 1);
    }
    EXPECT_EQ(threads_for(many), 1) << "the number of the outer step";
  });
}

TEST_F(AutomaticThreads, AreNoMoreThanAStepHasChunks) {
  run([](int available) {
    detail::ThreadChoice fast = all_threads();
    const detail::Team team(fast, 2 * chunk_size);
    EXPECT_EQ(threads_for(many), std::min(available, 2));
  });
}

TEST_F(AutomaticThreads, AreOneBeyondTheLimitOfAStep) {
  run([](int) {
    detail::ThreadChoice fast = all_threads();
    detail::Team team(fast, many);
    team.begin_step();
    std::this_thread::sleep_for(std::chrono::duration<double>(1.1 * fast.limit()));
    EXPECT_EQ(threads_for(many), 1);
    EXPECT_EQ(ordered_sum(many, Index{0}, [](Index i) { return i; }), many * (many - 1) / 2);
    team.end_step();
    EXPECT_FALSE(fast.all()) << "exceeding the limit ends the trial";
  });
}

TEST_F(AutomaticThreads, AreOneWithinAParallelLoop) {
  run([](int) {
    std::vector<int> numbers(4, 0);
    for_each_task(numbers.size(), [&](Index k) {
      detail::threads_are_given() = false;
      detail::ThreadChoice fast = all_threads();
      const detail::Team team(fast, many);
      numbers[k] = threads_for(many);
    });
    EXPECT_EQ(numbers, std::vector<int>(4, 1));
  });
}

TEST_F(AutomaticThreads, AreTheGivenNumber) {
  run([](int) {
    detail::ThreadChoice slow;
    const detail::Team team(slow, many);
    use_threads(3);
    EXPECT_EQ(threads(), 3);
#ifdef _OPENMP
    EXPECT_EQ(threads_for(2 * chunk_size), 3);
#endif
  });
}

// A team of one thread does not count as a parallel region.
TEST(NestedLoops, ProcessEveryIndexOnceInATeamOfOneThread) {
#ifdef _OPENMP
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(0);
  with_threads(2, [] {
    std::vector<int> done(4000, 0);
    double sum = 0;
    for_each(done.size(), [&](Index i) {
      if (i % 64 == 0) sum += ordered_sum(5000, 0.0, [](Index) { return 1.0; });
      ++done[i];
    });
    EXPECT_EQ(done, std::vector<int>(4000, 1));
    EXPECT_EQ(sum, 63 * 5000.0);
  });
  omp_set_max_active_levels(levels);
#endif
}

TEST(Finite, IsTestedOnTheBits) {
  EXPECT_TRUE(is_finite(0.0));
  EXPECT_TRUE(is_finite(-1.7e308));
  EXPECT_TRUE(is_finite(5e-324));
  EXPECT_FALSE(is_finite(std::nan("")));
  EXPECT_FALSE(is_finite(HUGE_VAL));
  EXPECT_FALSE(is_finite(-HUGE_VALF));
  EXPECT_FALSE(is_finite(Vec<3, float>(0, 0, std::nanf(""))));
}

TEST(Error, ReportsWhereItOccurred) {
  const Error error = Error("it broke", {.particle = 3, .id = 17}).with_step(120, 0.31);
  EXPECT_STREQ(error.what(), "it broke (particle 3, id 17, step 120, t = 0.31 s)");
  EXPECT_EQ(error.where().id, Id{17});
  EXPECT_STREQ(Error("alone").what(), "alone");
}

TEST(Error, ReportsTheInvalidNumber) {
  EXPECT_TRUE(refuses([] { require_between("x", 3, {0, 2}); }, {"x = 3", "0 to 2"}));
  EXPECT_TRUE(refuses([] { require_not_negative("x", -3); }, {"x = -3"}));
  EXPECT_TRUE(refuses([] { require_positive("x", 0); }, {"x = 0"}));
  EXPECT_NO_THROW(require_between("x", 2, {0, 2}));
  EXPECT_NO_THROW(require_not_negative("x", 0));
}

}  // namespace
}  // namespace silt::test::parallel_test
