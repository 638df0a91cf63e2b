// SPDX-License-Identifier: MIT
// A table that compares results with exact ones, and the page of the documentation that contains
// it.
#pragma once

#include <string>
#include <vector>

namespace silt::test {

/// One quantity of one case.
struct ReferenceRow {
  std::string item;      ///< case; begins with its number in the list of exact results
  std::string quantity;  ///< with its unit
  double reference = 0;
  double measured = 0;
  double allowed = 0;    ///< error relative to the scale; infinity: any
  double scale = 0;      ///< scale of the error; 0: the reference

  double error() const;
  bool is_within_tolerance() const;
};

class ReferenceTable {
 public:
  void add(const ReferenceRow& row) { rows_.push_back(row); }
  /// Sorts by the numbers of the items (stable).
  void sort();
  /// The rows whose error exceeds the allowed one.
  std::vector<ReferenceRow> failed() const;
  /// The table as Markdown, one line for each row.
  std::string text() const;
  /// Lines that are missing in the table of the page, or whose measured value there differs by more
  /// than a quarter of the allowed error or a tenth of the scale.
  std::vector<std::string> differences_from(const std::string& page) const;

 private:
  std::vector<ReferenceRow> rows_;
};

/// Prints the table and compares it with the table of a page, which is found by its line of column
/// names. Returns the exit code of main: 1 if the error of a row exceeds the allowed one or if the
/// page differs. With argv = {program, PAGE, "--write"} the table of the page is replaced instead.
/// Throws if there is no page, or no table to replace.
int compare_with_page(const ReferenceTable& table, int argc, char** argv);

}  // namespace silt::test
