// SPDX-License-Identifier: MIT
// A checkpoint that was damaged, or made by somebody, with the checksum of its bytes: reading it
// gives a legal state or throws silt::Error, changes nothing if it throws, and needs no memory out
// of proportion to the file.
// Only with --all: every byte of large states; io/checkpoint_file_test.cpp refuses damaged files, too.
#include <silt/dem.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/checkpoint_bytes.hpp"
#include "support/counted_memory.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/restarted_grains.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test::damaged_checkpoint_test {
namespace {

class DamagedCheckpoint : public FileTest {
 protected:
  // Whether a file of these bytes is read. Anything but silt::Error fails the test.
  template <class Run>
  bool is_read(const std::string& text, Run& run) {
    bool is_read = true;
    const std::int64_t needed = peak_of([&] {
      try {
        std::apply(
            [&](auto&... part) { checkpoint::restore({.file = "file"}, text, run.simulation, part...); },
            run.observers);
      } catch (const Error&) {
        is_read = false;
      }
    });
    EXPECT_LE(needed, std::int64_t(4 * text.size() + (1 << 20)));
    return is_read;
  }

  // Returns the number of files that are read.
  template <class Run>
  int expect_legal_or_refused(const Run& run, const std::vector<unsigned>& patterns) {
    const std::string good = written(run);
    const std::string body = good.substr(0, good.size() - checksum_size);
    Run target = run;
    EXPECT_TRUE(is_read(good, target));
    EXPECT_TRUE(written(target) == good);
    for (Index size = 0; size < body.size(); ++size) {
      EXPECT_FALSE(is_read(with_checksum(body.substr(0, size)), target)) << size << " bytes";
    }
    EXPECT_FALSE(is_read(with_checksum(body + '\0'), target));
    EXPECT_TRUE(written(target) == good);
    int number_read = 0;
    for (Index at = 0; at < body.size() && !HasFailure(); ++at) {
      for (const unsigned pattern : patterns) {
        SCOPED_TRACE("byte " + std::to_string(at) + " of " + std::to_string(body.size()) +
                     " with " + std::to_string(pattern));
        std::string bad = body;
        bad[at] = static_cast<char>(static_cast<unsigned char>(bad[at]) ^ pattern);
        if (!is_read(with_checksum(bad), target)) continue;
        ++number_read;
        expect_legal(target, run);
        target = run;
      }
    }
    EXPECT_TRUE(written(target) == good);
    return number_read;
  }

  // A state that is written can be read, with the same bits, and a step either succeeds or is
  // refused.
  template <class Run>
  void expect_legal(Run& run, const Run& other) {
    const std::string text = written(run);
    Run again = other;
    EXPECT_TRUE(is_read(text, again));
    EXPECT_TRUE(written(again) == text);
    EXPECT_TRUE(state_of(again.simulation.particles()) == state_of(run.simulation.particles()));
    try {
      run.simulation.step();
    } catch (const Error&) {
    }
  }
};

const dem::CundallStrackIncremental law{.normal_stiffness = 1e5,
                                        .tangential_stiffness = 5e4,
                                        .restitution = 0.5,
                                        .friction_angle = 0.4};

template <class S>
auto some_grains(std::vector<Index> along, int steps) {
  auto run = RestartedGrains<2>(std::move(along)).make(law, S{});
  for (int step = 0; step < steps; ++step) restart::step(run);
  return run;
}

TEST_F(DamagedCheckpoint, OfGrainsIsRefusedOrLegal) {
  const auto run = some_grains<NeighbourList<2>>({3, 2}, 3);
  EXPECT_GT(run.simulation.interaction().template part<1>().size(), 0u);
  EXPECT_GT(expect_legal_or_refused(run, {0x01, 0x80}), 500);
}

TEST_F(DamagedCheckpoint, OfAFlowIsRefusedOrLegal) {
  const mps::Tank<2> tank{
      .column = {0.04, 0.04}, .size = {.length = 0.08, .height = 0.08}, .spacing = 0.02};
  RunWith run{Simulation{mps::make_tank(tank), UniformGrid<2>{},
                         mps::Flow<mps::Case00>({.spacing = tank.spacing, .max_time_step = 1e-3}),
                         SemiImplicit{}}};
  run.simulation.step();
  EXPECT_GT(expect_legal_or_refused(run, {0x40}), 500);
}

TEST_F(DamagedCheckpoint, NeedsMemoryInProportionToItsSize) {
  auto grains = crowd<2, double>(60, 3);
  const RunWith run{Simulation{grains, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}}};
  const std::string good = written(run);
  auto target = run;
  EXPECT_TRUE(is_read(good, target));
  RunWith small{
      Simulation{two_grains<2>(0, {0, 0}), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}}};
  const std::string before = written(small);
  int refused = 0;
  for (const Entry& entry : entries_of(good)) {
    for (const std::uint64_t count :
         {entry.count + 1, 2 * entry.count + 1, std::uint64_t(good.size() - entry.values_at),
          std::uint64_t(1) << 40, std::uint64_t(1) << 61, ~std::uint64_t(0)}) {
      SCOPED_TRACE(entry.name + " with " + std::to_string(count) + " values");
      EXPECT_FALSE(is_read(with_value(good, entry.count_at, count), small));
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_TRUE(written(small) == before);
  write(good);
  const std::int64_t needed = peak_of([&] { restart::read(path, small); });
  EXPECT_LE(needed, std::int64_t(4 * good.size() + (1 << 20)));
  EXPECT_TRUE(written(small) == good);
}

// The bytes of the entry with this name replaced.
template <class T>
std::string with_entry(const std::string& text, std::string_view name, const T& value,
                       Index offset = 0) {
  for (const Entry& entry : entries_of(text)) {
    if (entry.name != name) continue;
    EXPECT_LE(offset + sizeof value, entry.size) << name;
    return with_value(text, entry.values_at + offset, value);
  }
  ADD_FAILURE() << "no " << name;
  return text;
}

TEST_F(DamagedCheckpoint, NamesFileFieldAndValue) {
  auto run = some_grains<UniformGrid<2>>({3, 2}, 3);
  const std::string good = written(run);
  const auto refused = [&](std::string_view name, const auto& value,
                           std::vector<std::string> fragments) {
    write(with_entry(good, name, value));
    fragments.push_back("read_checkpoint: " + path.string());
    EXPECT_TRUE(refuses([&] { restart::read(path, run); }, fragments)) << name;
    EXPECT_TRUE(written(run) == good) << name;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const unsigned char two = 2;
  const std::string earlier = "use an earlier checkpoint";
  refused("simulation/time", nan, {"simulation/time = nan, which is not finite", earlier});
  refused("simulation/output_time", infinite, {"output_time = inf", earlier});
  refused("simulation/run_is_open", two, {"run_is_open = 2, which is neither 0 nor 1", earlier});
  refused("simulation/particles/next_id", std::uint64_t(3), {"is not below next_id = 3", earlier});
  refused("simulation/particles/next_id", ~std::uint64_t(0), {"above 2^63", earlier});
  refused("simulation/particles/id", run.simulation.particles().id(1), {"occurs twice", earlier});
  refused("simulation/particles/box/periodic", two, {"box/periodic = 2", earlier});
  refused("simulation/particles/box/on_escape", 7, {"box/on_escape = 7", "none of its values"});
  refused("simulation/particles/box/upper", -infinite, {"upper = -inf is not"});
  refused("simulation/particles/position", nan, {"particles/position = nan", earlier});
  refused("simulation/particles/velocity", infinite, {"particles/velocity = inf", earlier});
  refused("simulation/search/positions", infinite, {"search/positions = inf", earlier});
  refused("simulation/integrator/last_time_step", nan, {"last_time_step = nan", earlier});
  refused("part 2/has_begun", two, {"part 2/has_begun = 2", earlier});
}

// Three grains in a row on a floor.
auto row_on_floor() {
  dem::Grains<2> grains;
  for (int k = 0; k < 3; ++k) {
    dem::add_grain(grains, {0.0199 * k, 0.0099}, {.radius = 0.01, .density = 2500});
  }
  RunWith run{
      Simulation{grains, UniformGrid<2>{}, dem::Contacts{law, dem::Plane<2>{}}, Leapfrog{}}};
  run.simulation.step();
  return run;
}

TEST_F(DamagedCheckpoint, WithContactsThatCannotBeIsRefused) {
  auto run = row_on_floor();
  const std::string good = written(run);
  const std::string history = "simulation/interaction/history/";
  const std::string list = "simulation/interaction/list/";
  const auto refused = [&](const std::string& name, Id value, Index number,
                           std::vector<std::string> fragments) {
    write(with_entry(good, name, value, number * sizeof value));
    fragments.push_back("use an earlier checkpoint");
    EXPECT_TRUE(refuses([&] { restart::read(path, run); }, fragments)) << name << ' ' << value;
    EXPECT_TRUE(written(run) == good) << name << ' ' << value;
  };
  // Contacts by grain: 0 with 1 and the floor, 1 with 2 and the floor, 2 with the floor.
  for (const std::string& partners : {history + "partners", list + "second"}) {
    refused(partners, 7, 0, {"contact of grain 0 with grain 7 is impossible"});
    refused(partners, wall_id(dem::max_wall_elements), 1,
            {"contact of grain 0 with element 268435456 of the walls is impossible"});
  }
  refused(list + "first", 1, 0, {"contact of grain 1 with grain 1"});
  refused(list + "first", 2, 0, {"contact of grain 2 with grain 1"});
  refused(list + "first", wall_id(1), 1, {"of grain 18446744073709551614 with element 0"});
  refused(list + "first", 1, 1, {"contact of grain 1 with element 0 of the walls occurs twice"});
  write(with_entry(good, history + "partners", Id(1), sizeof(Id)));
  EXPECT_TRUE(refuses([&] { restart::read(path, run); }, {"the pair 0, 1 occurs twice"}));
}

TEST_F(DamagedCheckpoint, IsNoneIfGrainsWithContactsOrWallsAreMissing) {
  auto run = row_on_floor();
  write(written(run));
  // The contacts with the floor end.
  RunWith without_floor{
      Simulation{dem::Grains<2>{}, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}}};
  EXPECT_TRUE(refuses([&] { restart::read(path, without_floor); },
                      {"was written with another number of walls"}));
  EXPECT_NO_THROW(read_checkpoint({.file = path, .accepts_other_setup = true},
                                  without_floor.simulation));
  EXPECT_NO_THROW(without_floor.simulation.step());
  EXPECT_EQ(without_floor.simulation.interaction().size(), 2u);

  const auto known = run.simulation.interaction().history(run.simulation.particles());
  run.simulation.particles().remove(1);
  run.simulation.interaction().set_history(run.simulation.particles(), known);
  const std::string text = written(run);
  EXPECT_TRUE(is_read(text, run));
  EXPECT_NO_THROW(run.simulation.step());
  EXPECT_EQ(run.simulation.interaction().size(), 2u);
}

TEST_F(DamagedCheckpoint, MayHaveAnyNumberOfRemovedParticles) {
  auto run = some_grains<UniformGrid<2>>({3, 2}, 3);
  const std::uint64_t next = std::uint64_t(1) << 62;
  EXPECT_TRUE(is_read(with_entry(written(run), "simulation/particles/next_id", next), run));
  auto& grains = run.simulation.particles();
  EXPECT_EQ(grains.id(grains.add({0.1, 0.5})), next);
  for (Index i = 0; i < grains.size(); ++i) EXPECT_EQ(grains.index_of(grains.id(i)), i);
  EXPECT_EQ(grains.index_of(next - 1), no_index);
}

}  // namespace
}  // namespace silt::test::damaged_checkpoint_test
