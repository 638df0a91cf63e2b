// SPDX-License-Identifier: MIT
// A weir with a long, level crest, on which the flow is critical: its discharge follows from the
// head before it, q = √g (2 H/3)^{3/2} (V.T. Chow, Open-Channel Hydraulics, 1959).
#pragma once

#include "channel_flow.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace channel {

/// Per width [m²/s].
inline double critical_flow(double head) { return std::sqrt(g) * std::pow(2 * head / 3, 1.5); }

template <int Dim>
Flow<Dim> broad_crested_weir(const Options& o) {
  const double l0 = o.spacing, head = o.head;
  const double height = head, pool = 4 * head, crest = 10 * head / 3, edge = 0.4 * head;
  const double level = height + head, discharge = critical_flow(head);
  std::vector<Vec<2>> line{{-3 * l0, 0}, {pool, 0}};
  for (int k = 0; k <= 8; ++k) {  // a round edge
    const double a = k * std::numbers::pi / 16;
    line.push_back({pool + edge * (1 - std::cos(a)), height + edge * (std::sin(a) - 1)});
  }
  line.push_back({pool + crest, height});
  line.push_back({pool + crest, -2 * head});
  const auto upright = [&](double x, const Range& heights) {
    return faces_along<Dim>({{x, heights.lower}, {x, heights.upper}}, {1, 0}, o.thickness);
  };
  mps::FlowSettings<Dim, mps::Recommended> settings =
      support::flow_settings<mps::Recommended, Dim>(o, level);
  settings.viscosity = o.viscosity;
  add_walls<Dim>(settings.walls, line, o.thickness);
  add_sides<Dim>(settings.walls,
                 {.lower = {-3 * l0, -2 * head}, .upper = {pool + crest + 4 * head, 3 * level}},
                 o.thickness);
  Openings<Dim> openings{
      .in = mps::Inflow<Dim>({.faces = upright(0, {0, 2 * level}),
                              .velocity = in_plane<Dim>(discharge / level, 0),
                              .spacing = l0,
                              .level = level,
                              .ramp = 0.5}),
      .drawn = {},
      .out = mps::Outflow<Dim>(below<Dim>(-2 * head / 3)),
      .section = Flux<Dim>({upright(pool + crest / 2, {height, 2 * level}), l0})};
  set_pistons<Dim>(settings.walls, {openings.in.piston()});
  mps::Fluid<Dim> water;
  fill(water, {.lower = {0, 0}, .upper = {pool, level}}, o);

  const Range reach{0, pool + crest}, before{0.3 * pool, 0.6 * pool};
  Flow<Dim> flow{.water = water, .settings = settings, .openings = openings, .reach = reach};
  flow.bed = [=](double x) {
    // 1 at the front, 0 where the crest is level.
    const double from_edge = (pool + edge - x) / edge;
    if (from_edge > 1) return 0.0;
    return height - (from_edge > 0 ? edge * (1 - std::sqrt(1 - squared(from_edge))) : 0);
  };
  flow.measure = [](const mps::Fluid<Dim>&) { return std::vector<double>{}; };
  flow.findings = [=](const History& history) {
    const double depth = mean_level(history, reach, before);
    const double measured = depth - height + squared(discharge / depth) / (2 * g);
    const double on_crest = mean_level(history, reach, {pool + 0.4 * crest, pool + 0.6 * crest});
    std::vector<Finding> all{{.quantity = "discharge over that of the head [-]",
                              .reference = 1,
                              .measured = discharge / critical_flow(measured),
                              .allowed = 0.05},
                             {.quantity = "depth at the middle of the crest over critical [-]",
                              .reference = 1,
                              .measured = (on_crest - height) / (2 * measured / 3),
                              .allowed = stated}};
    for (const auto& more : flow_findings(history, discharge)) all.push_back(more);
    return all;
  };
  flow.numbers = {{"flow", discharge}, {"before", {before.lower, before.upper}}};
  return flow;
}

}  // namespace channel
