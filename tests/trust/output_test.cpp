// SPDX-License-Identifier: MIT
// A run that is observed, measured and written in every step has the same bits as one that is not:
// its checkpoint, which has the complete state, is the same.
// Only with --all: every observer and measurement.
#include <silt/dem.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/stop_on_signal.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/profiles.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/fluid.hpp"
#include "support/restarted_grains.hpp"
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test::output_test {
namespace {

using Path = std::filesystem::path;

// An observer of any type, so that run() is compiled once for all of them.
template <class Sim>
struct AnyObserver {
  std::function<void(const Sim&)> at_output;
  std::function<void(Sim&)> before;
  std::function<void(const Sim&, const Run&)> after;
  std::function<void(const Sim&)> between;
  std::function<bool()> stops;

  template <class O>
  explicit AnyObserver(std::shared_ptr<O> o)
      : at_output([o](const Sim& sim) { silt::detail::call_at_output(*o, sim); }),
        before([o](Sim& sim) { silt::detail::call_before_step(*o, sim); }),
        after([o](const Sim& sim, const Run& run) { silt::detail::call_after_step(*o, sim, run); }),
        between([o](const Sim& sim) { silt::detail::call_between_steps(*o, sim); }),
        stops([o] { return silt::detail::requests_stop(*o); }) {
    static_assert(Observer<O, Sim>);
  }
};

template <class Sim>
struct Observers {
  std::vector<AnyObserver<Sim>> all;

  void operator()(const Sim& sim) const {
    for (const auto& each : all) each.at_output(sim);
  }
  void before_step(Sim& sim) const {
    for (const auto& each : all) each.before(sim);
  }
  void after_step(const Sim& sim, const Run& run) const {
    for (const auto& each : all) each.after(sim, run);
  }
  void between_steps(const Sim& sim) const {
    for (const auto& each : all) each.between(sim);
  }
  bool stop_requested() const {
    bool stops = false;
    for (const auto& each : all) stops |= each.stops();
    return stops;
  }
};

// Evaluates measure(simulation), a number, whenever a run calls its observers.
template <class F>
struct Measures {
  F measure;

  template <class Sim>
  void operator()(const Sim& sim) {
    EXPECT_TRUE(is_finite(double(measure(sim))));
  }
  template <class Sim>
  void before_step(Sim& sim) {
    (*this)(std::as_const(sim));
  }
  template <class Sim>
  void after_step(const Sim& sim, const Run&) {
    (*this)(sim);
  }
  template <class Sim>
  void between_steps(const Sim& sim) {
    (*this)(sim);
  }
};

// Reads by functions that are not const, as a program does that does not care.
struct ReadsWithoutConst {
  template <class Sim>
  void before_step(Sim& sim) const {
    double sum = sim.time_step();
    sim.particles().for_each_field([&sum](auto values, auto) {
      if (!values.empty()) sum += double(values.size());
    });
    for (const auto& x : sim.particles()[position]) sum += double(x[0]);
    for (const auto& v : sim.particles()[velocity]) sum += double(v[0]);
    sum += double(sim.interaction().reach(sim.particles()));
    EXPECT_TRUE(is_finite(sum));
  }
};
struct ReadsConstantsWithoutConst {
  template <class Sim>
  void before_step(Sim& sim) const {
    double sum = 0;
    for (const auto R : sim.particles()[radius]) sum += double(R);
    for (const auto m : sim.particles()[mass]) sum += double(m);
    EXPECT_TRUE(is_finite(sum));
  }
};

// Advances copies, which share memory with the simulation.
struct AdvancesCopies {
  template <class Sim>
  void after_step(const Sim& sim, const Run&) const {
    Sim copy = sim;
    copy.step();
    copy.step();
    EXPECT_EQ(copy.steps(), sim.steps() + 2);
  }
};

struct WritesRows {
  CsvFile table;

  template <class Sim>
  void operator()(const Sim& sim) {
    table.row({sim.time(), double(sim.particles().size())});
  }
  template <class Sim>
  void after_step(const Sim& sim, const Run&) {
    (*this)(sim);
  }
};

// Makes observers, each with a name.
template <class Sim>
using Makers = std::vector<std::pair<std::string, std::function<AnyObserver<Sim>(const Sim&)>>>;

template <class Sim, class F>
auto measures(F measure) {
  return [measure](const Sim&) {
    return AnyObserver<Sim>(std::make_shared<Measures<F>>(Measures<F>{measure}));
  };
}
template <class Sim, class O, class... Arguments>
auto made_from(Arguments... arguments) {
  return [=](const Sim&) { return AnyObserver<Sim>(std::make_shared<O>(arguments...)); };
}

// Those for any particles.
template <class Sim>
Makers<Sim> general_observers(const Path& folder) {
  return {
      {"VtkSeries", made_from<Sim, VtkSeries>(folder / "frames")},
      {"CsvFile",
       [=](const Sim&) {
         return AnyObserver<Sim>(std::make_shared<WritesRows>(
             WritesRows{CsvFile(folder / "rows.csv", {"time", "particles"})}));
       }},
      {"Checkpoints",
       made_from<Sim, Checkpoints<>>(folder / "run.silt", Checkpoints<>::Settings{.every = 0})},
      {"Progress",
       [=](const Sim&) {
         const std::shared_ptr<std::FILE> log(std::fopen((folder / "log").string().c_str(), "w"),
                                              file::Close{});
         const auto clock = [t = 0.0]() mutable { return t += 10; };
         return AnyObserver<Sim>(std::shared_ptr<Progress>(
             new Progress(log.get(), clock), [log](Progress* progress) { delete progress; }));
       }},
      {"StopOnSignal", made_from<Sim, StopOnSignal>()},
      {"write_csv", measures<Sim>([=](const Sim& sim) {
         write_csv(folder / "particles.csv", sim.snapshot());
         return 0;
       })},
      {"snapshot() and state()", measures<Sim>([](const Sim& sim) {
         return double(sim.snapshot().size() + sim.state().particles.size());
       })},
      {"access that is not const", made_from<Sim, ReadsWithoutConst>()},
      {"steps of a copy", made_from<Sim, AdvancesCopies>()},
  };
}

// The checkpoint after a run with these observers.
template <class MakeRun, class Sim>
std::string checkpoint_after(const MakeRun& make_run, const Run& run, const Makers<Sim>& makers) {
  auto all = make_run();
  Observers<Sim> observers;
  for (const auto& [name, make] : makers) observers.all.push_back(make(all.simulation));
  checkpoint::Writer writer;
  std::apply(
      [&](auto&... part) {
        EXPECT_TRUE(all.simulation.run(run, part..., observers));
        checkpoint::transfer_all(writer, all.simulation, part...);
      },
      all.observers);
  EXPECT_GT(all.simulation.steps(), 30u);
  return std::move(writer).finish();
}

template <class MakeRun, class Sim>
void expect_no_effect(const MakeRun& make_run, const Run& run, const Makers<Sim>& makers) {
  const std::string plain = checkpoint_after(make_run, run, Makers<Sim>{});
  for (const auto& each : makers) {
    EXPECT_TRUE(checkpoint_after(make_run, run, Makers<Sim>{each}) == plain) << each.first;
  }
  for (const int threads : {1, 2}) {
    with_threads(threads, [&] {
      EXPECT_TRUE(checkpoint_after(make_run, run, makers) == plain)
          << "all together, " << threads << " threads";
    });
  }
}

TEST(Output, OfGrainsHasNoEffectOnThem) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  const auto make = [&] {
    auto run = RestartedGrains<2>({8, 6}).make(law, NeighbourList<2>{});
    return RunWith(run.simulation, std::get<0>(run.observers), std::get<1>(run.observers));
  };
  using Sim = decltype(make().simulation);
  const Folder folder;
  const auto& path = folder.path;
  auto makers = general_observers<Sim>(path);
  makers.emplace_back("EnergyLedger", [](const Sim& sim) {
    return AnyObserver<Sim>(
        std::make_shared<dem::EnergyLedger<dem::Grains<2>>>(dem::EnergyLedger{sim}));
  });
  makers.emplace_back("Profiles", made_from<Sim, Profiles<2>>(
                                      Slices{.upper = 0.2, .count = 4, .cross_section = 0.16}));
  makers.emplace_back("constants by access that is not const",
                      made_from<Sim, ReadsConstantsWithoutConst>());
  makers.emplace_back(
      "contacts", measures<Sim>([](const Sim& sim) {
        const auto& grains = sim.particles();
        const auto& contacts = sim.interaction().template part<1>();
        double sum = contacts.elastic_energy(grains) + contacts.load_on(grains, 0).force[1] +
                     contacts.time_step(grains) + double(contacts.history(grains).size());
        contacts.for_each_contact(
            grains, [&](Index, Index, const auto&, const auto& F) { sum += F.norm(); });
        contacts.for_each_wall_contact(grains, [&](const auto& at) { sum += at.force.norm(); });
        return sum;
      }));
  makers.emplace_back("bonds", measures<Sim>([](const Sim& sim) {
                        const auto& bonds = sim.interaction().template part<2>();
                        return bonds.elastic_energy(sim.particles()) + double(bonds.bonds().size());
                      }));
  makers.emplace_back("stress and coordination", measures<Sim>([](const Sim& sim) {
                        const auto state = sim.state();
                        const auto& contacts = state.interaction.template part<1>();
                        Box<2> region{.lower = {0, 0}, .upper = {0.1, 0.1}};
                        return dem::stress(state.particles, contacts, region).pressure() +
                               dem::coordination(state.particles, contacts).mean;
                      }));
  makers.emplace_back("energies and momenta", measures<Sim>([](const Sim& sim) {
                        const auto grains = sim.snapshot();
                        return kinetic_energy(grains) + rotational_energy(grains) +
                               potential_energy(grains, {0, -9.81}) + momentum(grains).norm() +
                               angular_momentum(grains, {0, 0}) + dem::rms_speed(grains);
                      }));
  makers.emplace_back(
      "Probe", measures<Sim>([](const Sim& sim) {
        const Probe<2> probe{.point = {0.05, 0.05}, .spacing = 0.02};
        return probe.read(sim.particles(), mass, [](Index) { return true; }).value_or(0);
      }));

  auto whole = make();
  const silt::Run run{.until = 0.008, .output_every = 1e-3};
  auto& [drain, rain] = whole.observers;
  EXPECT_TRUE(whole.simulation.run(run, drain, rain));
  EXPECT_GT(rain.number(), 5u);
  EXPECT_GT(whole.simulation.interaction().template part<1>().size(), 10u);
  expect_no_effect(make, run, makers);
}

TEST(Output, OfAFlowHasNoEffectOnIt) {
  const double l0 = 0.02;
  const auto make = [&] {
    const auto tank = mps::make_tank<mps::Recommended>(small_tank<2>(l0));
    return RunWith(Simulation{tank.particles, NeighbourList<2>{},
                              mps::Flow<mps::Recommended>(
                                  {.spacing = l0, .max_time_step = 5e-4, .walls = tank.walls}),
                              SemiImplicit{}});
  };
  using Sim = decltype(make().simulation);
  const Folder folder;
  auto makers = general_observers<Sim>(folder.path);
  makers.emplace_back("energies", measures<Sim>([](const Sim& sim) {
                        const auto& flow = sim.interaction();
                        return flow.energy().total() + flow.energy_of(sim.particles()).total() +
                               flow.time_step_limits(sim.particles()).smallest() +
                               flow.last_solve().residual + flow.seconds_in_pressure();
                      }));
  makers.emplace_back(
      "Probe", measures<Sim>([=](const Sim& sim) {
        const Probe<2> probe{.point = {0.1, 0.1}, .spacing = l0};
        return probe.read(sim.particles(), mps::pressure, [](Index) { return true; }).value_or(0);
      }));
  makers.emplace_back("front", measures<Sim>([=](const Sim& sim) {
                        const auto kinds = sim.particles()[mps::kind];
                        const auto front =
                            find_front(sim.particles(), sim.search(), {.spacing = l0},
                                       [&](Index i) { return kinds[i] == mps::Kind::fluid; });
                        return front.x + front.height;
                      }));
  makers.emplace_back("neighbours", measures<Sim>([](const Sim& sim) {
                        double sum = 0;
                        for (Index i = 0; i < sim.particles().size(); ++i) {
                          sim.search().for_each_neighbour(
                              i, [&](Index, const auto&, double r) { sum += r; });
                        }
                        return sum;
                      }));
  expect_no_effect(make, {.until = 0.02, .output_every = 2e-3}, makers);
}

}  // namespace
}  // namespace silt::test::output_test
