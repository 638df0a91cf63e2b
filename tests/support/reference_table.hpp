// SPDX-License-Identifier: MIT
// A table of results beside exact ones, and the page of the documentation that has it.
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
  double allowed = 0;    ///< error, over the scale; infinite: any
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
  /// Lines that the page's table of these columns does not have: no such row, or one whose measured
  /// value is off by more than a quarter of what is allowed, or a tenth of the scale.
  std::vector<std::string> differences_from(const std::string& page) const;

 private:
  std::vector<ReferenceRow> rows_;
};

/// Prints the table, and compares it with that of a page, which begins with the same line of column
/// names. Returns what main returns: 1 if a row does not hold or the page has it otherwise. With
/// argv = {program, PAGE, "--write"} the page gets this table instead. Throws if it has none to
/// replace.
int compare_with_page(const ReferenceTable& table, int argc, char** argv);

}  // namespace silt::test
