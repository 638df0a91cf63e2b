// SPDX-License-Identifier: MIT
// Prints the table of exact results, reference and measured, and compares it with the page that has
// it.
//
//   dem_reference PAGE             1 if a row does not hold, or the page's table is not this one
//   dem_reference PAGE --write     puts this table into the page
#include "table.hpp"

#include <silt/core/error.hpp>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

int main(int argc, char** argv) try {
  using namespace silt::test;
  if (argc < 2) {
    std::fprintf(stderr, "dem_reference: name the page with the table\n");
    return 2;
  }
  ReferenceTable table;
  time_steps(table);
  impacts(table);
  bounces(table);
  friction(table);
  hertz(table);
  grains_in_flight(table);
  grains_at_rest(table);
  table.sort();
  std::printf("%s", table.text().c_str());

  std::ifstream stream(argv[1]);
  std::string page{std::istreambuf_iterator<char>(stream), {}};
  if (argc > 2 && std::string(argv[2]) == "--write") {
    const auto from = page.find("| case |");
    if (from == std::string::npos) silt::fail("dem_reference: the page has no table to replace");
    auto to = page.find("\n\n", from);
    to = to == std::string::npos ? page.size() : to + 1;
    std::ofstream(argv[1]) << page.substr(0, from) << table.text() << page.substr(to);
    return 0;
  }
  const auto failed = table.failed();
  for (const auto& row : failed) {
    std::printf("does not hold: %s, %s\n", row.item.c_str(), row.quantity.c_str());
  }
  const auto differences = table.differences_from(page);
  for (const auto& line : differences) {
    std::printf("%s has it otherwise (dem_reference PAGE --write): %s\n", argv[1], line.c_str());
  }
  return failed.empty() && differences.empty() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
