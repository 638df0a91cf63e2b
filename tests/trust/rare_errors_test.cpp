// SPDX-License-Identifier: MIT
// Errors that no other test raises, see tests/mutation/errors.py.
#include <silt/dem.hpp>
#include <silt/dem/bond/bonds.hpp>
#include <silt/dem/measure/stress.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/dem/setup/size_distribution.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/io/csv.hpp>
#include <silt/measure/profiles.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <any>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silt::test::rare_errors_test {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// An archive that reads these values, as if from a checkpoint with a valid checksum.
class ReadsThese {
 public:
  static constexpr bool reads = true;

  explicit ReadsThese(std::map<std::string, std::any> values) : values_(std::move(values)) {}

  template <class T>
  void operator()(std::string_view name, T& value) {
    value = std::any_cast<T>(values_.at(std::string(name)));
  }
  void same(std::string_view, const std::string&) {}

 private:
  std::map<std::string, std::any> values_;
};

// Adds no forces; its interaction range is negative.
struct Repelled {
  template <class P>
  double reach(const P&) const {
    return -1;
  }
  template <class P, class S>
  void accelerate(P&, S&, double) const {}
};

TEST(RareErrors, NameANegativeInteractionRange) {
  EXPECT_TRUE(refuses(
      [] { Simulation(one_grain<2>({0, 0}, {0, 0}), UniformGrid<2>{}, Repelled{}, Leapfrog{}); },
      {"Simulation: interaction range = -1"}));
}

TEST(RareErrors, NameTheRadiusOfASearch) {
  auto grains = crowd<2, double>(70, 1);
  EXPECT_TRUE(refuses([&] { UniformGrid<2>().sort(grains); }, {"UniformGrid: radius = 0"}));
  EXPECT_TRUE(refuses([&] { NeighbourList<2>().sort(grains); }, {"NeighbourList: radius = 0"}));
  EXPECT_TRUE(refuses([&] { LevelGrid<2>().sort(grains); }, {"LevelGrid: radius = 0"}));
  EXPECT_TRUE(refuses([&] { LevelGrid<2>().update(grains); }, {"LevelGrid: radius = 0"}));
  EXPECT_TRUE(refuses([] { LevelGrid<2>().set_radius(-1); }, {"LevelGrid: radius = -1"}));
}

TEST(RareErrors, NamePositionsOfTheLastUpdate) {
  auto grains = two_grains<2>(0.01, {0, 0});
  const std::vector<Vec<2>> x{{0, 0}, {not_a_number, 0}};
  EXPECT_TRUE(refuses([&] { at_positions(grains, x, [] { ADD_FAILURE(); }); },
                      {"search: position of the last update", "nan"}));
  ReadsThese archive({{"is_known", false}, {"positions", std::vector<Vec<2>>{{0, 0}, {1, 0}}}});
  const auto read = [&] {
    transfer_update(
        archive, grains, true, [](Index) { return Vec<2>(0, 0); }, [] { ADD_FAILURE(); });
  };
  EXPECT_TRUE(refuses(read, {"search: is_known = 0, but there are 2 positions"}));
}

TEST(RareErrors, NameAListOfContactsOfOtherGrains) {
  const Vec<2> zero(0, 0);
  dem::detail::SavedList<2, double> list;
  ReadsThese archive({{"is_known", true},
                      {"first", std::vector<Id>{0}},
                      {"second", std::vector<Id>{1}},
                      {"since", std::vector<Vec<2>>{zero}},
                      {"margin", 0.1},
                      {"time", 0.0},
                      {"extent_lower", zero},
                      {"extent_upper", zero},
                      {"stable_time_step", 1.0}});
  list.transfer(archive);
  EXPECT_TRUE(refuses([&] { list.check(two_grains<2>(0.01, {0, 0})); },
                      {"dem::Contacts: the list has 1 positions for 2 grains"}));
}

TEST(RareErrors, NameTheFirstCornerOfATriangle) {
  const Triangle<> triangle{{Vec<3>{not_a_number, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_TRUE(refuses([&] { dem::MeshWall<>({triangle}); }, {"triangle 0", "nan"}));
}

TEST(RareErrors, NameBondedGrainsAtOnePoint) {
  auto grains = dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0, 0}}, pebble);
  dem::Bonds<2> bonds{dem::ParallelBond{
      .normal_stiffness = 1e9, .tangential_stiffness = 1e9}};
  EXPECT_TRUE(refuses([&] { bonds.bond(grains, {.one = 0, .other = 1}); },
                      {"dem::Bonds: distance of the grains 0 and 1 = 0"}));
}

TEST(RareErrors, NameDashpotsThatCannotBeMixed) {
  const dem::CundallStrack by_restitution{.normal_stiffness = 1e5, .restitution = 0.5};
  const dem::CundallStrack by_beta{.normal_stiffness = 1e5, .beta = 1e-5};
  EXPECT_TRUE(refuses([&] { dem::Materials{by_restitution, by_beta}; },
                      {"CundallStrack: one material has restitution = 0.5, the other beta"}));
}

TEST(RareErrors, NameTheUpperSideOfARegionOfStress) {
  const auto grains = two_grains<2>(0.01, {0, 0});
  const auto contacts =
      for_particles(dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, grains);
  const Box<2> region{.lower = {0, 0}, .upper = {1, std::numeric_limits<double>::infinity()}};
  EXPECT_TRUE(refuses([&] { dem::stress(grains, contacts, region); },
                      {"dem::stress: upper side of the region"}));
}

TEST(RareErrors, NameExistingGrainsThatAreInvalid) {
  const auto place_beside = [](auto field, auto value) {
    auto grains = one_grain<2>({0.5, 0.5}, {0, 0});
    grains[field][0] = value;
    const Box<2> region{.lower = {0, 0}, .upper = {1, 1}};
    const dem::Blend<dem::EqualSizes> blend{.sizes = {0.01}, .density = 2500};
    dem::scatter(grains, blend, region, {.number = 1});
  };
  EXPECT_TRUE(refuses([&] { place_beside(position, Vec<2>(not_a_number, 0)); },
                      {"dem: position of an existing grain"}));
  EXPECT_TRUE(refuses([&] { place_beside(radius, 0.0); },
                      {"dem: radius of an existing grain = 0"}));
}

TEST(RareErrors, NameSievesWithCountlessGrains) {
  EXPECT_TRUE(refuses(
      [] { dem::SieveSizes({{.min_radius = 1e-75, .max_radius = 2e-75, .mass = 1e100}}); },
      {"SieveSizes: number of grains for these masses"}));
}

TEST(RareErrors, NameSamplesOfOtherProfiles) {
  Profiles<2> profiles({.lower = 0, .upper = 1, .count = 2, .cross_section = 1});
  EXPECT_TRUE(refuses([&] { profiles.rows(); }, {"Profiles: there are 0 samples"}));

  const auto read = [](std::vector<double> current, Index in_current) {
    BlockSums sums(2);
    ReadsThese archive({{"blocks", std::vector<double>{}},
                        {"current", std::move(current)},
                        {"in_current", in_current},
                        {"block_length", Index(4)},
                        {"samples", in_current}});
    sums.transfer(archive);
  };
  read({1, 2}, 3);
  EXPECT_TRUE(refuses([&] { read({1}, 3); }, {"BlockSums", "samples of 1 values, not 2"}));
  EXPECT_TRUE(refuses([&] { read({1, 2}, 4); }, {"BlockSums: in_current = 4 is not below"}));
}

using RareErrorsOfFiles = FileTest;

TEST_F(RareErrorsOfFiles, NameATableThatIsNoLongerThere) {
  CsvFile table(path, {"a"});
  table.row({1});
  const auto read = [&] {
    ReadsThese archive({{"size", std::uint64_t(std::filesystem::file_size(path))}});
    table.transfer(archive);
  };
  read();
  std::filesystem::resize_file(path, 2);
  EXPECT_TRUE(refuses([&] { table.row({2}); }, {"CsvFile", "has 2 bytes, but had 4"}));
  std::filesystem::remove(path);
  EXPECT_TRUE(refuses([&] { table.row({2}); }, {"CsvFile: cannot write"}));
}

}  // namespace
}  // namespace silt::test::rare_errors_test
