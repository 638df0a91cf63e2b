// SPDX-License-Identifier: MIT
// A checkpoint has the bits of the state, and no others.
// Only with --all: every law and search.
#include <silt/dem.hpp>
#include <silt/io/archive.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silt::test::checkpoint_bytes_test {
namespace {

// Sets all numbers of a history.
struct SetNumbers {
  void operator()(std::string_view, double& number) { number = 2.5; }
  void operator()(std::string_view, Vec<2>& vector) { vector = {1.5, -0.0}; }
  void operator()(std::string_view, Vec<3>& vector) { vector = {1.5, -0.0, 3}; }
  void operator()(std::string_view, auto& part) {
    if constexpr (requires { part.transfer(*this); }) part.transfer(*this);
  }
};

// Histories of which every byte that is not part of a number is `byte`.
template <class History>
std::string written_over(unsigned char byte) {
  std::vector<History> values(3);
  for (History& each : values) {
    std::memset(static_cast<void*>(&each), byte, sizeof each);
    SetNumbers set;
    each.transfer(set);
  }
  checkpoint::Writer writer;
  writer("values", values);
  return std::move(writer).finish();
}

template <class Law>
class HistoryInCheckpoint : public testing::Test {};
using Laws = testing::Types<
    dem::CundallStrack, dem::CundallStrackIncremental,
    dem::Law<dem::LinearSpringDashpot, dem::LinearFriction>,
    dem::Law<dem::WaltonBraun, dem::LinearFriction, dem::RollingResistance>,
    dem::Law<dem::Hertz, dem::Mindlin, dem::RollingResistance, dem::ConstantCohesion>>;
TYPED_TEST_SUITE(HistoryInCheckpoint, Laws);

TYPED_TEST(HistoryInCheckpoint, HasNoOtherBytesThanItsNumbers) {
  using Plane = typename TypeParam::template History<2, double>;
  using Space = typename TypeParam::template History<3, double>;
  EXPECT_EQ(written_over<Plane>(0), written_over<Plane>(0xff));
  EXPECT_EQ(written_over<Space>(0), written_over<Space>(0xff));
}

// A contact that remembers a number and whether it has slid, as a user may define it.
struct Slid {
  double size = 0;
  bool has_slid = false;
  template <class Archive>
  void transfer(Archive& archive) {
    archive("size", size);
    archive("has_slid", has_slid);
  }
  bool operator==(const Slid&) const = default;
};
struct Nothing {
  template <class Archive>
  void transfer(Archive&) {}
  bool operator==(const Nothing&) const = default;
};
struct NothingInside {
  double scratch = 0;
  Nothing nothing;
  template <class Archive>
  void transfer(Archive& archive) {
    archive("nothing", nothing);
  }
  bool operator==(const NothingInside&) const = default;
};

template <class T>
std::string written(const std::vector<T>& values) {
  checkpoint::Writer writer;
  writer("values", values);
  writer("end", 1.5);
  return std::move(writer).finish();
}
template <class T>
std::vector<T> read(const std::string& bytes, std::vector<T> values) {
  checkpoint::Reader reader("test", bytes);
  double end = 0;
  reader.read_all([&] {
    reader("values", values);
    reader("end", end);
  });
  EXPECT_EQ(end, 1.5);
  return values;
}

TEST(StructsInCheckpoint, AreReadWithTruthValues) {
  const std::vector<Slid> values{{1, true}, {2, false}, {3, true}};
  EXPECT_EQ(read(written(values), std::vector<Slid>(7)), values);
  // A truth value with other bits is refused.
  std::string bytes = written(values);
  const Index at = bytes.find("has_slid") + 8 + 1 + 4 + 4 + 8;
  ASSERT_EQ(bytes[at], 1);
  bytes[at] = 2;
  bytes.resize(bytes.size() - sizeof(std::uint64_t));
  const std::uint64_t sum = checkpoint::checksum(bytes);
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  EXPECT_TRUE(refuses([&] { read(bytes, values); }, {"has_slid = 2, which is neither 0 nor 1"}));
}

TEST(StructsInCheckpoint, AreAsManyAsWrittenIfTheyHaveNoMembers) {
  for (const Index n : {Index{0}, Index{5}}) {
    EXPECT_EQ(read(written(std::vector<Nothing>(n)), std::vector<Nothing>(3)).size(), n);
    EXPECT_EQ(read(written(std::vector<NothingInside>(n)), std::vector<NothingInside>(3)).size(),
              n);
  }
  const PairHistory<Nothing> pairs({{1, 2, {}}, {1, 3, {}}});
  checkpoint::Writer writer;
  PairHistory<Nothing>(pairs).transfer(writer);
  const std::string bytes = std::move(writer).finish();
  checkpoint::Reader reader("test", bytes);
  PairHistory<Nothing> found;
  reader.read_all([&] { found.transfer(reader); });
  EXPECT_EQ(found.size(), 2u);
}

using CheckpointBytes = FileTest;

TEST_F(CheckpointBytes, AreTheSameEachTimeTheStateIsWritten) {
  const dem::CundallStrackIncremental law{.normal_stiffness = 1e5, .tangential_stiffness = 5e4};
  Simulation simulation{crowd<2, double>(8, 1), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  for (int k = 0; k < 5; ++k) simulation.step();
  write_checkpoint(path, simulation);
  const std::string first = bytes();
  read_checkpoint(path, simulation);
  write_checkpoint(path, simulation);
  EXPECT_TRUE(bytes() == first);
}

// Positions that a search would move into the box, or whose bits an operation could change.
template <class S>
void expect_same_positions(const std::filesystem::path& path) {
  auto grains = crowd<2, double>(8, 1);
  auto box = cube<2, double>(-0.1, 0.9);
  box.periodic = {true, true};
  grains.set_box(box);
  Simulation simulation{grains, S{}, Gravity<2>{{0, -1}}, Leapfrog{}};
  for (int k = 0; k < 3; ++k) simulation.step(1e-3);
  const auto x = simulation.particles()[position];
  x[0] = {7.3, -0.0};
  x[1] = {-0.1, 0.9};
  x[2] = {std::numeric_limits<double>::denorm_min(), -5.1};
  write_checkpoint(path, simulation);
  Simulation other{dem::Grains<2>{}, S{}, Gravity<2>{{0, -1}}, Leapfrog{}};
  read_checkpoint(path, other);
  EXPECT_TRUE(state_of(other.particles()) == state_of(simulation.particles()));
  EXPECT_TRUE(std::signbit(other.particles()[position][0][1]));
}

TEST_F(CheckpointBytes, HoldThePositionsToTheBit) {
  expect_same_positions<BruteForce<2>>(path);
  expect_same_positions<UniformGrid<2>>(path);
  expect_same_positions<LevelGrid<2>>(path);
  expect_same_positions<NeighbourList<2>>(path);
}

}  // namespace
}  // namespace silt::test::checkpoint_bytes_test
