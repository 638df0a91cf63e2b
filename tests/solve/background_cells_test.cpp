// SPDX-License-Identifier: MIT
#include <silt/solve/background_cells.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace silt::test::background_cells_test {
namespace {

using Cells = BackgroundCells<2>;
using Cell = GridCell<2>;

// Cells of a frame around a hole, several of them twice. Stretched, their bounding box is too large
// for a table.
std::vector<Cell> frame(std::int64_t stretch) {
  std::vector<Cell> cells;
  for (std::int64_t x = -3; x <= 4; ++x) {
    for (std::int64_t y = 5; y <= 9; ++y) {
      if (x > -3 && x < 4 && y > 5 && y < 9) continue;
      cells.push_back({x * stretch, y * stretch});
      if ((x + y) % 3 == 0) cells.push_back(cells.front());
    }
  }
  return cells;
}

bool is_even(const Cell& cell) { return ((cell[0] + cell[1]) & 1) == 0; }

TEST(BackgroundCells, AreFoundUnderTheirNumbersAndNoOthersAre) {
  for (const std::int64_t stretch : {1, 1001}) {
    const std::vector<Cell> given = frame(stretch);
    const std::set<Cell> distinct(given.begin(), given.end());
    for (const CellOrder order : {CellOrder::plain, CellOrder::chessboard}) {
      Cells cells;
      cells.number(given, order);
      EXPECT_EQ(cells.size(), distinct.size());
      for (Index c = 0; c < cells.size(); ++c) EXPECT_EQ(cells.find(cells.cells()[c]), c);
      // Around the frame and in it.
      for (std::int64_t x = -5; x <= 6; ++x) {
        for (std::int64_t y = 3; y <= 11; ++y) {
          const Cell cell{x * stretch, y * stretch};
          EXPECT_EQ(cells.find(cell) != Cells::none, distinct.contains(cell)) << x << " " << y;
        }
      }
    }
  }
}

TEST(BackgroundCells, AreNumberedWithXFastestWithinAColour) {
  const auto comes_before = [](const Cell& a, const Cell& b) {
    return a[1] < b[1] || (a[1] == b[1] && a[0] < b[0]);
  };
  for (const std::int64_t stretch : {1, 1001}) {
    Cells cells;
    cells.number(frame(stretch), CellOrder::plain);
    EXPECT_EQ(cells.reds(), cells.size());
    EXPECT_TRUE(std::is_sorted(cells.cells().begin(), cells.cells().end(), comes_before));

    cells.number(frame(stretch), CellOrder::chessboard);
    const auto reds = cells.cells().first(cells.reds());
    const auto blacks = cells.cells().subspan(cells.reds());
    EXPECT_TRUE(std::all_of(reds.begin(), reds.end(), is_even));
    EXPECT_TRUE(std::none_of(blacks.begin(), blacks.end(), is_even));
    EXPECT_TRUE(std::is_sorted(reds.begin(), reds.end(), comes_before));
    EXPECT_TRUE(std::is_sorted(blacks.begin(), blacks.end(), comes_before));
  }
}

TEST(BackgroundCells, AreNoneIfNoneAreGiven) {
  Cells cells;
  cells.number(frame(1), CellOrder::plain);
  cells.number({}, CellOrder::chessboard);
  EXPECT_EQ(cells.size(), 0u);
  EXPECT_EQ(cells.reds(), 0u);
  EXPECT_EQ(cells.find({0, 5}), Cells::none);
  EXPECT_EQ(cells.find({-3, 5}), Cells::none);
}

}  // namespace
}  // namespace silt::test::background_cells_test
