// SPDX-License-Identifier: MIT
// The unknown pressures of a flow that several processes share.
#pragma once

#include <silt/core/shared_particles.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/shared_unknowns.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace silt::mps {

/// The columns of the pressures of a process are the unknowns of its own particles, then those of its
/// halo. The particles and column_of, of particles and halo, must outlive this object.
template <class P>
class SharedPressures final : public SharedUnknowns {
 public:
  SharedPressures(const P& particles, const std::vector<std::uint32_t>& column_of, Index columns)
      : particles_(particles), column_of_(column_of), columns_(columns) {}

  void refresh(std::vector<double>& x) const override {
    particles_.template exchange<double>(
        [&](Index i) { return has_column(i) ? x[column_of_[i]] : 0.0; },
        [&](Index row, double value) {
          if (has_column(row)) x[column_of_[row]] = value;
        });
  }
  void sum(std::span<double> values) const override {
    by_parts(values, [&](const auto& own) { return particles_.sum(own); });
  }
  void largest(std::span<double> values) const override {
    by_parts(values, [&](const auto& own) { return particles_.largest(own); });
  }
  const void* processes() const override { return &particles_.world(); }

 private:
  template <class F>
  static void by_parts(std::span<double> values, const F& reduced) {
    constexpr Index size = 12;
    for (Index first = 0; first < values.size(); first += size) {
      const auto some = values.subspan(first, std::min(size, values.size() - first));
      std::array<double, size> own{};
      std::ranges::copy(some, own.begin());
      const auto result = reduced(own);
      std::copy_n(result.begin(), some.size(), some.begin());
    }
  }
  bool has_column(Index i) const { return column_of_[i] < columns_; }

  const P& particles_;
  const std::vector<std::uint32_t>& column_of_;
  Index columns_;
};

}  // namespace silt::mps
