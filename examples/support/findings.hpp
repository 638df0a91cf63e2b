// SPDX-License-Identifier: MIT
// Results of a run and their reference values.
#pragma once

#include <silt/core/error.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace support {

/// For findings that are reported, but not checked.
inline constexpr double stated = std::numeric_limits<double>::infinity();
/// The reference of findings without one.
inline constexpr double no_reference = std::numeric_limits<double>::quiet_NaN();

/// One result of a run and its reference value.
struct Finding {
  std::string quantity;  ///< with its unit
  double reference = 0;
  double measured = 0;
  double allowed = 0;  ///< maximum error over the scale; `stated`: any
  double scale = 0;    ///< of the error; 0: the reference

  double error() const {
    return std::abs(measured - reference) / (scale > 0 ? scale : std::abs(reference));
  }
  bool holds() const { return silt::is_finite(measured) && error() <= allowed; }
};

}  // namespace support
