// SPDX-License-Identifier: MIT
// Fuzz target: an input is a sequence of calls of the API of grains, with numbers that it may not
// expect. A call that throws silt::Error changes nothing, and the next one follows.
#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/dem/setup/settling.hpp>

#include "fuzz/target.hpp"
#include "support/checkpoint_bytes.hpp"
#include "support/restart.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;
using fuzz::Choices;

constexpr Index max_grains = 60;  // so that an input takes little time
constexpr double R = 0.01;        // usual radius [m]

// Ends a run after some steps.
struct FewSteps {
  int left = 4;
  bool stop_requested() { return left-- == 0; }
};

template <int Dim>
Vec<Dim> point(Choices& choices) {
  Vec<Dim> x;
  for (int k = 0; k < Dim; ++k) x[k] = choices.number(2.1 * R * double(choices.below(5)));
  return x;
}

template <int Dim>
Box<Dim> any_box(Choices& choices) {
  Box<Dim> box;
  box.lower = choices.vector<Dim>(Vec<Dim>::Constant(-0.1));
  box.upper = choices.vector<Dim>(Vec<Dim>::Constant(0.3));
  const std::uint8_t periodic = choices.byte();
  for (int k = 0; k < Dim; ++k) box.periodic[Index(k)] = periodic & 64 && periodic >> k & 1;
  box.on_escape = choices.flag() ? OnEscape::remove : OnEscape::refuse;
  return box;
}

template <class P>
void add_grain(Choices& choices, P& grains) {
  if (grains.size() >= max_grains) return;
  const dem::Grain grain{.radius = choices.number(R),
                         .density = choices.number(2500),
                         .shape = choices.flag() ? dem::Shape::sphere : dem::Shape::natural,
                         .material = choices.count(0)};
  dem::add_grain(grains, point<P::dimension>(choices), grain);
}

template <class P>
void change_grain(Choices& choices, P& grains) {
  if (grains.empty()) return;
  const Index i = choices.below(grains.size());
  const int k = static_cast<int>(choices.below(P::dimension));
  switch (choices.below(7)) {
    case 0:
      grains[position][i][k] = choices.number(grains[position][i][k]);
      break;
    case 1:
      grains[velocity][i][k] = choices.number(1);
      break;
    case 2:
      component(grains[spin][i], k) = choices.number(100);
      break;
    case 3:
      grains[mass][i] = choices.number(grains[mass][i]);
      break;
    case 4:
      grains[inertia][i] = choices.number(grains[inertia][i]);
      break;
    case 5:
      grains[radius][i] = choices.number(grains[radius][i]);
      break;
    default:
      grains[dem::material][i] = static_cast<std::uint32_t>(choices.count(0));
  }
}

template <int Dim>
dem::Blend<dem::UniformSizes> any_blend(Choices& choices) {
  return {.sizes = {.min_radius = choices.number(R / 2), .max_radius = choices.number(R)},
          .density = choices.number(2500)};
}

template <class P>
void scatter_grains(Choices& choices, P& grains) {
  dem::Scatter some{.number = {}, .solid_fraction = {}, .tries = choices.below(50)};
  // More grains than these could be placed as well, but would take long.
  some.number = std::min<Index>(choices.below(8), max_grains - std::min(max_grains, grains.size()));
  constexpr int Dim = P::dimension;
  const auto region = any_box<Dim>(choices);
  dem::scatter(grains, any_blend<Dim>(choices), region, some);
}

struct Motions {
  std::vector<Id> ids;
  std::vector<std::uint64_t> bits;  // of all numbers, as NaN does not equal itself
  bool operator==(const Motions&) const = default;
};

// By ids: sorting is not undone after a failed step.
template <class P>
Motions motions_of(const P& grains) {
  Motions motions{{grains.ids().begin(), grains.ids().end()}, {}};
  std::sort(motions.ids.begin(), motions.ids.end());
  const auto add = [&](double value) {
    motions.bits.push_back(std::bit_cast<std::uint64_t>(value));
  };
  for (const Id id : motions.ids) {
    const Index i = grains.index_of(id);
    for (int k = 0; k < P::dimension; ++k) {
      add(grains[position][i][k]);
      add(grains[velocity][i][k]);
    }
    for (int k = 0; k < angular_size<P::dimension>; ++k) {
      add(component(grains[spin][i], k));
    }
  }
  return motions;
}

template <class Sim>
void step(Choices& choices, Sim& simulation) {
  const bool chooses_step = !choices.flag();
  const double dt = chooses_step ? 0 : choices.number(1e-5);
  const auto before = motions_of(simulation.particles());
  const double time = simulation.time();
  if (!fuzz::accepts([&] { chooses_step ? simulation.step() : simulation.step(dt); })) {
    fuzz::require(simulation.time() == time && motions_of(simulation.particles()) == before,
                  "a step that failed changes the state");
    return;
  }
  fuzz::require(simulation.time() > time, "a step does not change the time");
  for (const std::uint64_t bits : motions_of(simulation.particles()).bits) {
    fuzz::require(is_finite(std::bit_cast<double>(bits)),
                  "a step succeeds with a result that is not finite");
  }
}

template <class Sim>
void run(Choices& choices, Sim& simulation) {
  const Run run{
      .until = simulation.time() + choices.number(1e-3),
      .output_every = choices.number(1e-4),
      .time_step = choices.flag() ? std::optional<double>(choices.number(1e-5)) : std::nullopt,
      .end_exactly = choices.flag()};
  simulation.run(run, FewSteps{});
}

template <int Dim, class Sim>
void rain_on(Choices& choices, Sim& simulation) {
  typename dem::Inflow<Box<Dim>, dem::UniformSizes>::Settings settings{
      .number = std::min(choices.count(5), max_grains),
      .from = choices.number(simulation.time()),
      .velocity = choices.vector<Dim>(Vec<Dim>::Constant(-1)),
      .every = choices.number(0),
      .tries = 1 + choices.below(20)};
  if (choices.flag()) settings.rate = choices.number(1e4);
  if (simulation.particles().size() >= max_grains) return;
  dem::Inflow rain{any_box<Dim>(choices), any_blend<Dim>(choices), settings};
  dem::Outflow drain{any_box<Dim>(choices), {.every = choices.number(1e-4)}};
  simulation.run({.until = simulation.time() + 1e-3}, rain, drain, FewSteps{2});
}

template <class Sim>
void read_results(const Choices&, const Sim& simulation) {
  const auto state = simulation.state();
  state.interaction.for_each_contact(state.particles,
                                     [](Index, Index, const auto&, const auto&) {});
  (void)state.interaction.elastic_energy(state.particles);
  (void)state.interaction.load_on(state.particles, 0);
}

// A simulation that is read from a checkpoint makes the same step.
template <class Sim>
void write_and_read(const Sim& simulation) {
  test::RunWith before{simulation};
  const std::string text = test::written(before);
  auto after = before;
  const bool is_read = fuzz::accepts([&] { checkpoint::restore({.file = "file"}, text, after.simulation); });
  const bool can_step = fuzz::accepts([&] { before.simulation.step(); });
  fuzz::require(is_read || !can_step,
                "the checkpoint of a simulation that can make a step cannot be read");
  if (!is_read) return;
  fuzz::require(fuzz::accepts([&] { after.simulation.step(); }) == can_step,
                "only one of two equal simulations can make a step");
  fuzz::require(
      motions_of(after.simulation.particles()) == motions_of(before.simulation.particles()),
      "another step after reading a checkpoint");
}

template <int Dim, class Sim>
void call(Choices& choices, Sim& simulation) {
  auto& grains = simulation.particles();
  switch (choices.below(12)) {
    case 0:
    case 1:
      return step(choices, simulation);
    case 2:
      return add_grain(choices, grains);
    case 3:
      return change_grain(choices, grains);
    case 4:
      return grains.remove(choices.count(0));
    case 5:
      return grains.set_box(any_box<Dim>(choices));
    case 6:
      return scatter_grains(choices, grains);
    case 7:
      return run(choices, simulation);
    case 8:
      return rain_on<Dim>(choices, simulation);
    case 9:
      return read_results(choices, simulation);
    case 10:
      return write_and_read(simulation);
    default:
      dem::settle(simulation,
                  {.speed = choices.number(0.1),
                   .check_every = choices.number(1e-4),
                   .max_time = choices.number(1e-3),
                   .time_step = choices.number(1e-5)},
                  FewSteps{8});
  }
}

template <int Dim, class S, class Law, class... Walls>
void call_all(Choices& choices, S search, const Law& law, const Walls&... walls) {
  dem::Grains<Dim> grains;
  fuzz::accepts([&] { grains = dem::Grains<Dim>(any_box<Dim>(choices)); });
  for (Index k = 1 + choices.below(6); k > 0; --k) {
    fuzz::accepts([&] { add_grain(choices, grains); });
  }
  using Sim = decltype(Simulation{grains, search, dem::Contacts{law, walls...}, Leapfrog{}});
  std::optional<Sim> simulation;
  fuzz::accepts([&] {
    dem::Contacts contacts{law, walls...};
    const dem::ContactSettings settings{.steps_per_contact = choices.number(50),
                                        .check_stability = choices.byte() < 128};
    simulation.emplace(grains, std::move(search), contacts.with(settings), Leapfrog{});
  });
  if (!simulation) return;
  for (int calls = 0; choices.are_left() && calls < 40; ++calls) {
    fuzz::accepts([&] { call<Dim>(choices, *simulation); });
  }
}

dem::CundallStrack linear_law(Choices& choices) {
  return {.normal_stiffness = choices.number(1e5),
          .tangential_stiffness = choices.number(5e4),
          .restitution = choices.number(0.5),
          .friction_angle = choices.number(0.4),
          .cohesion = choices.number(0),
          .limit_damping = choices.flag()};
}

auto hertzian_law(Choices& choices) {
  const dem::Elastic elastic{.young_modulus = choices.number(1e7),
                             .poisson_ratio = choices.number(0.3)};
  const dem::Hertz normal{.elastic = elastic, .restitution = choices.number(0.5)};
  return dem::Law{normal, dem::Mindlin{.elastic = elastic, .friction_angle = choices.number(0.4)}};
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Choices choices(data, size);
  fuzz::accepts([&] {
    if (choices.flag()) {
      const dem::Plane<2> floor{.point = choices.vector<2>({0, -R}),
                                .normal = choices.vector<2>({0, 1}),
                                .material = std::uint32_t(choices.count(0))};
      const dem::Circle<> drum{.centre = choices.vector<2>({0, 0}), .radius = choices.number(1)};
      NeighbourList<2>::Settings settings;
      if (choices.flag()) settings.skin_fraction = choices.number(0.2);
      call_all<2>(choices, NeighbourList<2>(settings), linear_law(choices), floor, drum);
    } else {
      const dem::BoxWall<3> bin{.box = any_box<3>(choices)};
      call_all<3>(choices, LevelGrid<3>{}, hertzian_law(choices), bin);
    }
  });
  return 0;
}
