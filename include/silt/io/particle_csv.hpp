// SPDX-License-Identifier: MIT
// Particles as a CSV file, one row per particle; dem::grains_from(read_csv(path)) reads grains.
#pragma once

#include <silt/core/field_numbers.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/file.hpp>
#include <silt/io/replace_file.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace silt {

/// Writes all numeric fields except those that every step computes (forces), with the fewest digits
/// that read back as the same number: x, y[, z], velocity_x, …, radius. Rows are in the order of
/// the ids. The file is written atomically. Throws silt::Error if it cannot be written.
template <class P>
void write_csv(const std::filesystem::path& path, const P& particles) {
  static_assert(detail::are_of_one_process<P>,
                "silt::write_csv: a file has the particles of one process; use VtkSeries, or "
                "write_checkpoint and a program of one process that reads it");
  std::vector<Id> ids(particles.ids().begin(), particles.ids().end());
  std::sort(ids.begin(), ids.end());
  std::string head;
  std::vector<std::string> rows(ids.size());
  detail::for_each_number(particles, [&](const std::string& name, Index k, auto field) {
    const char* const comma = head.empty() ? "" : ",";
    head += comma + name;
    for (Index row = 0; row < rows.size(); ++row) {
      const auto& value = particles[field][particles.index_of(ids[row])];
      rows[row] += comma + file::digits(detail::number_of(value, k));
    }
  });
  std::string text = head + "\n";
  for (const std::string& row : rows) text += row + "\n";
  file::replace("write_csv", path, text);
}

}  // namespace silt
