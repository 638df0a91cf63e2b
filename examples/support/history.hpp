// SPDX-License-Identifier: MIT
// Quantities recorded during a run, in memory and in a file.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/io/csv.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace support {

/// Quantities recorded during a run: one row per time, one column per quantity. The first column is
/// the time.
class History {
 public:
  explicit History(std::vector<std::string> names)
      : names_(std::move(names)), columns_(names_.size()) {}

  const std::vector<std::string>& names() const { return names_; }
  void add(const std::vector<double>& row) {
    for (silt::Index c = 0; c < columns_.size(); ++c) columns_[c].push_back(row[c]);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    for (silt::Index c = 0; c < columns_.size(); ++c) archive(names_[c], columns_[c]);
  }
  const std::vector<double>& operator[](const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) silt::fail("History: no column " + name);
    return columns_[static_cast<silt::Index>(found - names_.begin())];
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

/// Mean of y over time from `begin` [s] on.
inline double mean_from(double begin, const std::vector<double>& t, const std::vector<double>& y) {
  double sum = 0, weight = 0;
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] < begin) continue;
    sum += y[k] * (t[k] - t[k - 1]);
    weight += t[k] - t[k - 1];
  }
  return sum / weight;
}

/// Observer that records measure(simulation), the values of all columns but the time, at the
/// beginning and after every step, and writes them to a file.
template <class Measure>
class Recorder {
 public:
  /// The columns after "t". The measure must outlive the recorder.
  Recorder(const std::string& path, const std::vector<std::string>& names, const Measure& measure)
      : measure_(&measure), file_(path, with_time(names)), history_(with_time(names)) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) add(simulation);
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    add(simulation);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    file_.transfer(archive);
    history_.transfer(archive);
  }

  const History& history() const { return history_; }

 private:
  static std::vector<std::string> with_time(std::vector<std::string> names) {
    names.insert(names.begin(), "t");
    return names;
  }
  template <class Sim>
  void add(const Sim& simulation) {
    std::vector<double> row = (*measure_)(simulation);
    row.insert(row.begin(), simulation.time());
    file_.row(row);
    history_.add(row);
  }

  const Measure* measure_;  // not a copy: checkpoints assign their parts, and a lambda cannot be
  silt::CsvFile file_;
  History history_;
};

}  // namespace support
