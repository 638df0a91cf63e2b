// SPDX-License-Identifier: MIT
// The table of exact results that DEM is held against.
#pragma once

#include <string>
#include <vector>

namespace silt::test {

/// One quantity of one case.
struct ReferenceRow {
  std::string item;      ///< case, beginning with its number in the list of exact results
  std::string quantity;  ///< with its unit
  double reference = 0;
  double measured = 0;
  double allowed = 0;    ///< error, over the scale
  double scale = 0;      ///< of the error; 0: the reference

  double error() const;
  bool holds() const;
};

class ReferenceTable {
 public:
  void add(const ReferenceRow& row) { rows_.push_back(row); }
  /// By the numbers of the items, otherwise as they were added.
  void sort();
  /// The rows that do not hold.
  std::vector<ReferenceRow> failed() const;
  /// As Markdown, one line for each row.
  std::string text() const;
  /// Lines that a page's table does not have: no such row, or one whose measured value is off by
  /// more than a quarter of what is allowed.
  std::vector<std::string> differences_from(const std::string& page) const;

 private:
  std::vector<ReferenceRow> rows_;
};

/// Each adds the rows of its items.
void impacts(ReferenceTable& table);
void bounces(ReferenceTable& table);
void friction(ReferenceTable& table);
void hertz(ReferenceTable& table);
void grains_at_rest(ReferenceTable& table);
void grains_in_flight(ReferenceTable& table);
void time_steps(ReferenceTable& table);

}  // namespace silt::test
