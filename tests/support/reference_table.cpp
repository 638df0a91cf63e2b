// SPDX-License-Identifier: MIT
#include "support/reference_table.hpp"

#include <silt/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

namespace silt::test {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, '|');) {
    const auto first = cell.find_first_not_of(' ');
    const auto last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// Two significant digits, as a percentage unless very small.
std::string share(double value) {
  if (value == 0) return "0";
  if (!is_finite(value)) return "stated";
  char text[32];
  const bool small = value < 1e-4;
  std::snprintf(text, sizeof text, small ? "%.1g" : "%.2g %%", small ? value : 100 * value);
  return text;
}

constexpr std::string_view column_names =
    "| case | quantity | reference | measured | error | allowed |\n";

// Range of the table in the page, from the column names to the end of the last line; empty if there
// is none.
struct TextRange {
  std::size_t from;
  std::size_t to;
};
TextRange table_of(const std::string& page) {
  const auto from = page.find(column_names);
  if (from == std::string::npos) return {page.size(), page.size()};
  const auto end = page.find("\n\n", from);
  return {from, end == std::string::npos ? page.size() : end + 1};
}

std::string line_of(const ReferenceRow& row) {
  return "| " + row.item + " | " + row.quantity + " | " + to_text(row.reference) + " | " +
         to_text(row.measured) + " | " + share(row.error()) + " | " + share(row.allowed) + " |";
}

}  // namespace

double ReferenceRow::error() const {
  return std::abs(measured - reference) / (scale > 0 ? scale : std::abs(reference));
}
bool ReferenceRow::is_within_tolerance() const { return is_finite(measured) && error() <= allowed; }

void ReferenceTable::sort() {
  std::stable_sort(rows_.begin(), rows_.end(), [](const ReferenceRow& a, const ReferenceRow& b) {
    return std::stoi(a.item) < std::stoi(b.item);
  });
}

std::vector<ReferenceRow> ReferenceTable::failed() const {
  std::vector<ReferenceRow> failed;
  for (const auto& row : rows_) {
    if (!row.is_within_tolerance()) failed.push_back(row);
  }
  return failed;
}

std::string ReferenceTable::text() const {
  std::string text = std::string(column_names) + "|---|---|---|---|---|---|\n";
  for (const auto& row : rows_) text += line_of(row) + "\n";
  return text;
}

std::vector<std::string> ReferenceTable::differences_from(const std::string& page) const {
  std::vector<std::string> differences;
  std::vector<std::vector<std::string>> lines;
  const TextRange range = table_of(page);
  std::stringstream stream(page.substr(range.from, range.to - range.from));
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("| ")) lines.push_back(cells_of(line));
  }
  std::size_t next = 1;  // after the column names
  for (const auto& row : rows_) {
    const auto own = cells_of(line_of(row));
    if (next >= lines.size()) {
      differences.push_back(line_of(row));
      continue;
    }
    const auto& line = lines[next++];
    bool same = line.size() == own.size();
    for (const std::size_t cell : {1, 2, 3, 6}) same = same && line[cell] == own[cell];
    if (same) {
      ReferenceRow on_page = row;
      on_page.reference = row.measured;
      on_page.measured = std::stod(line[4]);
      on_page.scale = row.scale > 0 ? row.scale : std::abs(row.reference);
      same = on_page.error() <= std::min(row.allowed / 4, 0.1) + 1e-5;
    }
    if (!same) differences.push_back(line_of(row));
  }
  if (next < lines.size()) differences.push_back("(the page has more rows)");
  return differences;
}

int compare_with_page(const ReferenceTable& table, int argc, char** argv) {
  const std::string program = argv[0];
  if (argc < 2) fail(program + ": give the page with the table as an argument");
  std::printf("%s", table.text().c_str());
  std::ifstream stream(argv[1]);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  if (argc > 2 && std::string(argv[2]) == "--write") {
    const TextRange range = table_of(page);
    if (range.from == page.size()) fail(program + ": the page has no table to replace");
    std::ofstream(argv[1]) << page.substr(0, range.from) << table.text() << page.substr(range.to);
    return 0;
  }
  const auto failed = table.failed();
  for (const auto& row : failed) {
    std::printf("error too large: %s, %s\n", row.item.c_str(), row.quantity.c_str());
  }
  const auto differences = table.differences_from(page);
  for (const auto& line : differences) {
    std::printf("%s differs (update with %s PAGE --write): %s\n", argv[1], argv[0], line.c_str());
  }
  return failed.empty() && differences.empty() ? 0 : 1;
}

}  // namespace silt::test
