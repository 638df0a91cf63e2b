// SPDX-License-Identifier: MIT
// Period and slope of sampled signals.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluid_cases {

/// Times of the zero crossings of y, by linear interpolation. An initial zero counts.
inline std::vector<double> zero_crossings(const std::vector<double>& t,
                                          const std::vector<double>& y) {
  std::vector<double> times;
  if (!y.empty() && y.front() == 0) times.push_back(t.front());
  for (std::size_t k = 1; k < y.size(); ++k) {
    if (y[k - 1] * y[k] < 0 || (y[k] == 0 && k + 1 < y.size())) {
      times.push_back(t[k - 1] + (t[k] - t[k - 1]) * y[k - 1] / (y[k - 1] - y[k]));
    }
  }
  return times;
}

/// Mean of the first `count` whole periods; nan if there are fewer.
inline double mean_period(const std::vector<double>& times, std::size_t count) {
  if (times.size() <= 2 * count) return std::nan("");
  return (times[2 * count] - times[0]) / double(count);
}

/// Least-squares slope of y over t.
inline double slope(const std::vector<double>& t, const std::vector<double>& y) {
  const double n = double(t.size());
  double st = 0, sy = 0, stt = 0, sty = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    st += t[k], sy += y[k], stt += t[k] * t[k], sty += t[k] * y[k];
  }
  return (n * sty - st * sy) / (n * stt - st * st);
}

}  // namespace fluid_cases
