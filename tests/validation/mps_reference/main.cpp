// SPDX-License-Identifier: MIT
// Prints the table of flows whose solution is known, reference and measured, and compares it with the
// page that has it. The flows are those of the program fluid_cases.
//
//   mps_reference PAGE             1 if a row does not hold, or the page's table is not this one
//   mps_reference PAGE --write     puts this table into the page
#include "support/fluid_cases/all.hpp"
#include "support/reference_table.hpp"

#include <silt/mps.hpp>

#include <cstdio>
#include <exception>
#include <string>

namespace silt::test {
namespace {

using Scheme = mps::Case10;

// The rows of one run, under the name of its item.
void run(ReferenceTable& table, const std::string& item, const fluid_cases::Choice& choice) {
  const auto flow = fluid_cases::make(choice);
  auto simulation = fluid_cases::simulation_of<Scheme>(flow, {});
  fluid_cases::Notes notes(flow);
  simulation.run({.until = flow.until}, notes);
  for (const auto& finding : flow.findings(notes.history())) {
    table.add({item + ", l0 = " + to_text(choice.spacing) + " m", finding.quantity,
               finding.reference, finding.measured, finding.allowed, finding.scale});
  }
}

}  // namespace
}  // namespace silt::test

int main(int argc, char** argv) try {
  using namespace silt::test;
  ReferenceTable table;
  for (const double spacing : {0.04, 0.02, 0.01}) {
    run(table, "1 Taylor–Green vortices, Re = 100", {.name = "taylor_green", .spacing = spacing});
  }
  run(table, "2 standing wave, λ = 1 m", {.name = "standing_wave", .spacing = 0.02});
  run(table, "3 oscillating drop, A0/B0 = 1",
      {.name = "oscillating_drop", .spacing = 0.04, .swing = 1});
  run(table, "4 oscillating drop, A0/B0 = 0.4",
      {.name = "oscillating_drop", .spacing = 0.04, .swing = 0.4});
  run(table, "5 rotating square", {.name = "rotating_square", .spacing = 0.02});
  run(table, "6 falling block", {.name = "falling_block", .spacing = 0.02});
  table.sort();
  return compare_with_page(table, argc, argv);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
