// SPDX-License-Identifier: MIT
// Prints the table of exact results, reference and measured, and compares it with that of a page.
//
//   dem_reference PAGE             returns 1 if a row fails or the page has a different table
//   dem_reference PAGE --write     writes the table to the page
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
  oblique_impacts(table);
  grains_in_flight(table);
  grains_at_rest(table);
  table.sort();
  return compare_with_page(table, argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
