// SPDX-License-Identifier: MIT
// What simulations of grains and flows have in common behind AnySimulation.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/run.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/vtk.hpp>

#include "any_simulation.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

namespace silt::python {

template <Field F, class Value>
FieldInfo info_of() {
  const std::string name(name_of<F>());
  if constexpr (requires { typename Value::Scalar; }) {
    return {name, vtk_type<typename Value::Scalar>(), int(Value::SizeAtCompileTime)};
  } else {
    return {name, vtk_type<Value>(), 0};
  }
}

/// The values of a std::span or FieldView.
template <Field F, class Values>
ColumnMemory memory_of(const Values& values) {
  using Value = std::remove_cvref_t<decltype(values[0])>;
  ColumnMemory memory{.field = info_of<F, Value>(), .size = values.size(), .stride = sizeof(Value)};
  if (values.empty()) return memory;
  // const is removed only here: whoever has not asked for access to write must not write.
  const auto bytes = [&](Index i) {
    return reinterpret_cast<std::byte*>(const_cast<Value*>(&values[i]));
  };
  memory.first = bytes(0);
  if (values.size() > 1) memory.stride = bytes(1) - bytes(0);
  return memory;
}

/// Observer that calls the hooks, and what acts before steps.
template <class BeforeStep>
struct CallsHooks {
  Hooks& hooks;
  BeforeStep act;

  template <class Sim>
  void operator()(const Sim&) {
    hooks.make_output();
  }
  template <class Sim>
  void before_step(Sim&) {
    act();
  }
  bool stop_requested() { return hooks.stop_requested(); }
};

/// Reads a simulation and further parts; compare(read), with the simulation of the file, throws if
/// the set-up is another one.
template <class Sim, class Compare, class... Parts>
void read_compared(const CheckpointToRead& from, Sim& simulation, Compare&& compare,
                   Parts&... parts) {
  Sim copy = simulation;
  silt::read_checkpoint(from, copy, parts...);
  if (!from.accepts_other_setup) compare(std::as_const(copy));
  simulation = std::move(copy);
}

/// What can be done with the particles of a simulation, also of one that is a part of another, and
/// belongs to it. `Sim` is a Simulation.
template <class Sim>
class TypedSimulation : public AnySimulation {
 public:
  explicit TypedSimulation(std::shared_ptr<Sim> simulation) : shared_(std::move(simulation)) {}

  int dimension() const override { return Particles::dimension; }
  Index size() const override { return simulation().particles().size(); }
  double time() const override { return simulation().time(); }
  std::uint64_t steps() const override { return simulation().steps(); }
  double last_time_step() const override { return simulation().last_time_step(); }
  std::uint64_t particles_lost() const override { return simulation().particles_lost(); }
  std::span<const Id> ids() const override { return simulation().particles().ids(); }

  std::vector<FieldInfo> fields() const override {
    std::vector<FieldInfo> all;
    simulation().particles().for_each_field([&]<class Values, class F>(const Values&, F) {
      all.push_back(info_of<F, typename Values::value_type>());
    });
    return all;
  }
  ColumnMemory column(std::string_view name, bool is_written) override {
    ColumnMemory memory;
    std::string names;
    std::as_const(*shared_).particles().for_each_field([&]<class F>(const auto& values, F field) {
      names += names.empty() ? "" : ", ";
      names += name_of<F>();
      if (name_of<F>() != name) return;
      memory = is_written ? memory_of<F>(simulation().particles()[field]) : memory_of<F>(values);
    });
    if (memory.field.name.empty()) {
      fail("Simulation: there is no field \"" + std::string(name) + "\"; give one of " + names);
    }
    return memory;
  }
  std::vector<ColumnCopy> snapshot() const override {
    const Particles particles = simulation().snapshot();
    const auto ids = particles.ids();
    std::vector<Index> order(particles.size());
    std::iota(order.begin(), order.end(), Index(0));
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return ids[a] < ids[b]; });
    std::vector<ColumnCopy> all{copy_of({"id", vtk_type<Id>(), 0}, ids, order)};
    particles.for_each_field([&]<class Values, class F>(const Values& values, F) {
      all.push_back(copy_of(info_of<F, typename Values::value_type>(), values, order));
    });
    return all;
  }

  void remove(const std::vector<Id>& ids) override {
    auto& particles = simulation().particles();
    for (const Id id : ids) {
      if (particles.index_of(id) == no_index) {
        fail("Simulation.remove: no particle has the id " + std::to_string(id) +
             "; it was removed or never existed");
      }
    }
    const std::unordered_set<Id> gone(ids.begin(), ids.end());
    particles.remove_if([&](Index i) { return gone.contains(particles.id(i)); });
  }

  void write_frame(VtkSeries& frames) const override { frames(simulation()); }

 protected:
  using Particles = std::remove_cvref_t<decltype(std::declval<Sim&>().particles())>;

  const Sim& simulation() const { return *shared_; }
  Sim& simulation() { return *shared_; }

 private:
  template <class Values>
  static ColumnCopy copy_of(FieldInfo field, const Values& values,
                            const std::vector<Index>& order) {
    using Value = std::remove_cvref_t<decltype(values[0])>;
    ColumnCopy copy{std::move(field), order.size(),
                    std::vector<std::byte>(order.size() * sizeof(Value))};
    std::byte* to = copy.bytes.data();
    for (const Index i : order) {
      std::memcpy(to, &values[i], sizeof(Value));
      to += sizeof(Value);
    }
    return copy;
  }

  std::shared_ptr<Sim> shared_;
};

/// A simulation that makes its own steps; Base is a TypedSimulation.
template <class Base>
class Alone : public Base {
 public:
  using Base::Base;

  double time_step() override { return this->simulation().time_step(); }
  void step() override {
    before_step();
    this->simulation().step();
  }
  void step(double dt) override {
    before_step();
    this->simulation().step(dt);
  }
  bool run(const Run& run, Hooks& hooks) override {
    CallsHooks observer{hooks, [this] { before_step(); }};
    return this->simulation().run(run, observer);
  }

 protected:
  /// What a simulation does before each step.
  virtual void before_step() {}
};

}  // namespace silt::python
