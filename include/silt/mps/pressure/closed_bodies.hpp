// SPDX-License-Identifier: MIT
// Bodies of fluid without a free surface, as in a closed full tank: their pressure is defined up to a
// constant.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace silt::mps {

/// Finds those of an assembled pressure equation, makes their sources solvable, and chooses their
/// constants. In each step, find(), join() if processes share the particles, and balance() are called
/// in this order.
class ClosedBodies {
 public:
  /// Numbers them, LinearSystem::closed_body, from 1. `last_column` of each row is the last one with an
  /// entry, or the row itself.
  void find(LinearSystem& system, const Buffer<std::uint32_t>& last_column) {
    find_open_rows(system, last_column);
    const Index n = system.size();
    auto& body = system.closed_body;
    system.closed_bodies = 0;
    body.clear();
    for (Index row = 0; row < n; ++row) {
      if (is_open_[row]) continue;
      if (body.empty()) body.assign(n, 0);
      if (body[row] > 0) continue;
      const auto number = static_cast<std::uint32_t>(++system.closed_bodies);
      flood(
          system, row, [&](Index r) { return body[r] == 0; }, [&](Index r) { body[r] = number; });
    }
  }

  /// Numbers those of all processes, of which one may be a part here and a part there; `rank` is that of
  /// this process.
  static void join(LinearSystem& system, int rank) {
    auto& body = system.closed_body;
    if (!(system.sum_of_all(double(system.closed_bodies)) > 0)) return;
    body.resize(system.size(), 0);
    // A label for each of the own bodies: the lowest of its parts.
    std::vector<double> label(system.closed_bodies + 1, infinity);
    for (Index k = 1; k < label.size(); ++k) label[k] = 0x1p32 * rank + double(k);
    std::vector<double> labels(system.columns());
    double lowered = 0;
    system.sum_of_all(0);
    do {
      for (Index row = 0; row < body.size(); ++row) labels[row] = label[body[row]];
      system.refresh(labels);
      lowered = 0;
      for (Index row = 0; row < body.size(); ++row) {
        if (body[row] == 0) continue;
        double& own = label[body[row]];
        system.off_diagonal.for_each_entry(row, [&](Index column, double) {
          if (column < body.size() || !(labels[column] < own)) return;
          own = labels[column];
          lowered = 1;
        });
      }
    } while (system.sum_of_all(lowered) > 0);
    // From the lowest label on.
    Buffer<std::uint32_t> number(label.size(), 0);
    std::uint32_t bodies = 0;
    for (double last = -infinity;;) {
      double next = infinity;
      for (const double each : label) {
        if (each > last) next = std::min(next, each);
      }
      double minus_next = -next;
      system.shared->largest(std::span(&minus_next, 1));
      if (minus_next == -infinity) break;
      last = -minus_next;
      ++bodies;
      for (Index k = 1; k < label.size(); ++k) {
        if (label[k] == last) number[k] = bodies;
      }
    }
    for (std::uint32_t& each : body) each = number[each];
    system.closed_bodies = bodies;
  }

  /// A closed body cannot expand: shifts its sources so that they sum to zero.
  static void balance(LinearSystem& system) {
    if (system.closed_bodies == 0) return;
    auto& b = system.right_side;
    const auto& body = system.closed_body;
    const auto size_of_source = [&](Index row) { return std::abs(b[row]); };
    const auto original = largest_of_bodies(system, 0, size_of_source);
    system.remove_constants(b);
    system.remove_constants(b);  // removes the round-off of the first call
    // If all sources were equal, only round-off is left.
    const auto balanced = largest_of_bodies(system, 0, size_of_source);
    for (Index row = 0; row < b.size(); ++row) {
      if (body[row] > 0 && balanced[body[row]] <= 1e-14 * original[body[row]]) b[row] = 0;
    }
  }

  /// Shifts the pressures x of each closed body so that their minimum is zero.
  static void set_minimum_to_zero(const LinearSystem& system, std::vector<double>& x) {
    if (system.closed_bodies == 0) return;
    const auto& body = system.closed_body;
    const auto minus_minimum =
        largest_of_bodies(system, -infinity, [&](Index row) { return -x[row]; });
    for (Index row = 0; row < body.size(); ++row) {
      if (body[row] > 0) x[row] += minus_minimum[body[row]];
    }
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  // The largest value(row) of each body, or `none`, of all processes; by number.
  template <class Value>
  static std::vector<double> largest_of_bodies(const LinearSystem& system, double none,
                                               Value&& value) {
    std::vector<double> largest(system.closed_bodies + 1, none);
    for (Index row = 0; row < system.closed_body.size(); ++row) {
      double& of_body = largest[system.closed_body[row]];
      of_body = std::max(of_body, value(row));
    }
    if (system.shared) system.shared->largest(largest);
    return largest;
  }

  // Those that can be reached from the free surface.
  void find_open_rows(const LinearSystem& system, const Buffer<std::uint32_t>& last_column) {
    const Index n = system.size();
    const auto& entries = system.off_diagonal;
    is_open_.assign(system.columns(), 0);
    // Free surfaces are mostly at the top, with the last rows: one pass downwards, which follows
    // the last connection of each row, reaches nearly all rows.
    for (Index row = n; row-- > 0;) {
      is_open_[row] = system.geometry.to_surface[row] > 0 || is_open_[last_column[row]];
    }
    do {
      for (Index row = 0; row < n; ++row) {
        if (is_open_[row] || !entries.has_entry_in(row, is_open_)) continue;
        flood(
            system, row, [&](Index r) { return !is_open_[r]; },
            [&](Index r) { is_open_[r] = true; });
      }
    } while (others_have_opened(system));
  }
  // Whether rows of other processes are open that were not.
  bool others_have_opened(const LinearSystem& system) {
    if (!system.shared) return false;
    std::vector<double> marks(is_open_.begin(), is_open_.end());
    system.sum_of_all(0);
    system.refresh(marks);
    double opened = 0;
    for (Index column = system.size(); column < marks.size(); ++column) {
      if (marks[column] > 0 && !is_open_[column]) ++opened;
      is_open_[column] = marks[column] > 0;
    }
    return system.sum_of_all(opened) > 0;
  }
  // Marks the row and all rows that can be reached from it over rows for which is_new is true.
  template <class IsNew, class Mark>
  void flood(const LinearSystem& system, Index row, IsNew&& is_new, Mark&& mark) {
    mark(row);
    front_.assign(1, static_cast<std::uint32_t>(row));
    while (!front_.empty()) {
      const Index next = front_.back();
      front_.pop_back();
      system.off_diagonal.for_each_entry(next, [&](Index column, double) {
        if (column >= system.size() || !is_new(column)) return;
        mark(column);
        front_.push_back(static_cast<std::uint32_t>(column));
      });
    }
  }

  Buffer<std::uint8_t> is_open_;  // columns connected with a free surface
  Buffer<std::uint32_t> front_;   // of flood()
};

}  // namespace silt::mps
