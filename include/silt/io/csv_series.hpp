// SPDX-License-Identifier: MIT
// Readings of measures over time as a CSV file.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/csv.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silt {

/// A measure that CsvSeries writes has columns() and filter(), texts that name its numbers and say
/// how they are found, and row(simulation), the numbers: SurfaceHeight, WallGauge, WallLoad, Flux,
/// Tracks. Where it has before_step(simulation), after_step(simulation) and transfer(archive), they
/// are called.
template <class M>
concept WritesRows = requires(const M& measure) {
  { measure.columns() } -> std::convertible_to<std::vector<std::string>>;
  { measure.filter() } -> std::convertible_to<std::string>;
};

/// Observer that writes the time [s] and the readings of measures after every step, or at outputs
/// only, and what each is in the first lines. Columns with the same name get numbers: height_1,
/// height_2.
template <WritesRows... M>
class CsvSeries {
 public:
  /// Throws as CsvFile.
  explicit CsvSeries(const std::filesystem::path& path, M... measures)
      : measures_(std::move(measures)...), file_(path, names(), comment()) {
    static_assert(sizeof...(M) > 0, "silt::CsvSeries: give at least one measure");
  }
  /// Rows at outputs only.
  CsvSeries&& at_outputs() && {
    at_outputs_ = true;
    return std::move(*this);
  }

  /// The measures, in their order: std::get<0>(series.measures()).
  const std::tuple<M...>& measures() const noexcept { return measures_; }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (at_outputs_ || simulation.steps() == 0) write(simulation);
  }
  template <class Sim>
  void before_step(const Sim& simulation) {
    for_each_measure([&](auto& measure) {
      if constexpr (requires { measure.before_step(simulation); }) measure.before_step(simulation);
    });
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    for_each_measure([&](auto& measure) {
      if constexpr (requires { measure.after_step(simulation); }) measure.after_step(simulation);
    });
    if (!at_outputs_) write(simulation);
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    file_.transfer(archive);
    archive("has_rows", has_rows_);
    archive("last_step", last_step_);
    std::size_t number = 0;
    for_each_measure([&](auto& measure) {
      const std::string name = "measure_" + std::to_string(number++);
      if constexpr (requires { measure.transfer(archive); }) {
        archive.within(name, [&] { measure.transfer(archive); });
      }
    });
  }

 private:
  template <class F>
  void for_each_measure(F&& f) {
    std::apply([&](auto&... measure) { (f(measure), ...); }, measures_);
  }
  // Of each measure.
  std::vector<std::vector<std::string>> names_by_measure() const {
    std::vector<std::vector<std::string>> names;
    std::map<std::string, int> count, next;
    std::apply([&](const auto&... measure) { (names.push_back(measure.columns()), ...); },
               measures_);
    for (const auto& of_measure : names) {
      for (const auto& name : of_measure) ++count[name];
    }
    for (auto& of_measure : names) {
      for (auto& name : of_measure) {
        if (count[name] > 1) name += "_" + std::to_string(++next[name]);
      }
    }
    return names;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names{"t"};
    for (const auto& of_measure : names_by_measure()) {
      names.insert(names.end(), of_measure.begin(), of_measure.end());
    }
    return names;
  }
  std::string comment() const {
    const auto names = names_by_measure();
    std::string text = "t: time [s]";
    std::size_t number = 0;
    const auto add = [&](const auto& measure) {
      const auto& of_measure = names[number++];
      if (of_measure.empty()) return;
      text += "\n" + of_measure.front();
      if (of_measure.size() > 1) text += " to " + of_measure.back();
      text += ": " + measure.filter();
    };
    std::apply([&](const auto&... measure) { (add(measure), ...); }, measures_);
    return text;
  }

  template <class Sim>
  void write(const Sim& simulation) {
    // A second run makes an output where the first one ended.
    if (has_rows_ && last_step_ == simulation.steps()) return;
    std::vector<double> numbers{simulation.time()};
    for_each_measure([&](auto& measure) {
      static_assert(
          requires { measure.row(simulation); },
          "silt::CsvSeries: a measure has no row(simulation) for this simulation");
      for (const double number : measure.row(simulation)) numbers.push_back(number);
    });
    has_rows_ = true;
    last_step_ = simulation.steps();
    if (process_of(simulation.particles()).rank == 0) file_.row(numbers);
  }

  std::tuple<M...> measures_;
  CsvFile file_;
  bool at_outputs_ = false;
  bool has_rows_ = false;
  std::uint64_t last_step_ = 0;
};

}  // namespace silt
