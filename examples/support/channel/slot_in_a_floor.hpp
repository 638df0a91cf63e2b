// SPDX-License-Identifier: MIT
// Water leaves through a slot in the floor of a tank, which is kept full by an inflow: half of it,
// beside a plane of symmetry. The jet contracts to π/(π + 2) of the slot (G. Kirchhoff 1869), with
// the speed of a fall from the surface (E. Torricelli).
#pragma once

#include "channel_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace channel {

template <int Dim>
Flow<Dim> slot_in_a_floor(const Options& o) {
  const double l0 = o.spacing, b = o.slot, head = o.head;
  const double side = 3 * b, inlet = head / 2;
  const double contraction = std::numbers::pi / (std::numbers::pi + 2);
  const double discharge = contraction * b / 2 * std::sqrt(2 * g * head);
  mps::FlowSettings<Dim, mps::Recommended> settings =
      support::flow_settings<mps::Recommended, Dim>(o, head);
  settings.speed_scale = std::sqrt(2 * g * head);
  settings.viscosity = o.viscosity;
  settings.walls.let_fluid_fall = true;
  add_walls<Dim>(settings.walls, {{0, -8 * b}, {0, 1.5 * head}}, o.thickness);
  add_walls<Dim>(settings.walls, {{b / 2, 0}, {side + 3 * l0, 0}}, o.thickness);
  add_walls<Dim>(settings.walls, {{side + 3 * l0, inlet}, {side, inlet}, {side, 1.5 * head}},
                 o.thickness);
  add_sides<Dim>(settings.walls, {.lower = {0, -8 * b}, .upper = {side + 3 * l0, 1.5 * head}},
                 o.thickness);
  const double mouth = side + 2 * l0;
  const auto inlet_faces = faces_along<Dim>({{mouth, 0}, {mouth, inlet}}, {1, 0}, o.thickness);
  const auto slot_faces = faces_along<Dim>({{0, 0}, {b / 2, 0}}, {0, -1}, o.thickness);
  Openings<Dim> openings{.in = mps::Inflow<Dim>({.faces = inlet_faces,
                                                 .velocity = in_plane<Dim>(-discharge / inlet, 0),
                                                 .spacing = l0,
                                                 .ramp = 0.1}),
                         .drawn = {},
                         .out = mps::Outflow<Dim>(below<Dim>(-6 * b)),
                         .section = Flux<Dim>({slot_faces, l0})};
  set_pistons<Dim>(settings.walls, {openings.in.piston()});
  mps::Fluid<Dim> water;
  fill(water, {.lower = {0, 0}, .upper = {side, head}}, o);
  fill(water, {.lower = {side, 0}, .upper = {mouth, inlet}}, o);

  const Range reach{0, side};
  Flow<Dim> flow{.water = water, .settings = settings, .openings = openings, .reach = reach};
  flow.bed = [](double) { return 0.0; };
  constexpr int slices = 4;  // of the jet, from half a slot below the floor on, as high
  for (int k = 1; k <= slices; ++k) {
    flow.names.push_back("width_" + std::to_string(k));
    flow.names.push_back("speed_" + std::to_string(k));
  }
  flow.measure = [=](const mps::Fluid<Dim>& fluid) {
    std::vector<double> row;
    for (int k = 1; k <= slices; ++k) {
      const auto jet = content_of<Dim>(
          fluid, {.lower = {0, -b * (k + 1) / 2}, .upper = {0.75 * b, -b * k / 2}}, o);
      row.push_back(2 * jet.volume / (b / 2));  // of both halves
      row.push_back(jet.speed);
    }
    return row;
  };
  flow.findings = [=](const History& history) {
    const double level = mean_level(history, reach, {b, side});
    double width = 0, of_speed = 0;  // without the fall below the floor
    for (int k = 1; k <= slices; ++k) {
      const double fallen = level + b * (k + 0.5) / 2, number = slices;
      const std::string name = std::to_string(k);
      width += mean(history, "width_" + name) / b * std::sqrt(fallen / level) / number;
      of_speed += mean(history, "speed_" + name) / std::sqrt(2 * g * fallen) / number;
    }
    std::vector<Finding> all{{.quantity = "width of the jet over that of the slot [-]",
                              .reference = contraction,
                              .measured = width,
                              .allowed = 0.05},
                             {.quantity = "speed of the jet over that of Torricelli [-]",
                              .reference = 1,
                              .measured = of_speed,
                              .allowed = 0.02}};
    for (const auto& more : flow_findings(history, discharge)) all.push_back(more);
    return all;
  };
  flow.numbers = {{"flow", discharge}, {"tank", side}, {"slices", slices}};
  return flow;
}

}  // namespace channel
