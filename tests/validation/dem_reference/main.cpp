// SPDX-License-Identifier: MIT
// Prints the table of exact results, reference and measured, and compares it with the page that has
// it.
//
//   dem_reference PAGE             1 if a row does not hold, or the page's table is not this one
//   dem_reference PAGE --write     puts this table into the page
#include "items.hpp"

#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
  using namespace silt::test;
  ReferenceTable table;
  time_steps(table);
  impacts(table);
  bounces(table);
  friction(table);
  hertz(table);
  grains_in_flight(table);
  grains_at_rest(table);
  table.sort();
  return compare_with_page(table, argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
