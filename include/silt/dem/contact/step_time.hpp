// SPDX-License-Identifier: MIT
// The time and the time steps of an evaluation of contacts.
#pragma once

namespace silt::dem::detail {

/// What all contacts of an evaluation have in common; see Contact.
template <class Real>
struct ContactTimes {
  Real time_step = 0;        ///< [s]
  Real first_time_step = 0;  ///< [s]
};

struct StepTime {
  double time = 0;            ///< of the positions [s]
  double time_step = 0;       ///< Δt of the step that begins [s]
  double last_time_step = 0;  ///< Δt since the last evaluation [s]; 0 before the first step

  /// Time of the velocities, N − ½ [s].
  double of_velocities() const { return time - (is_first() ? time_step : last_time_step) / 2; }

  /// From N − ½ to N + ½ [s].
  double between_velocities() const {
    return is_first() ? time_step : (last_time_step + time_step) / 2;
  }

  template <class Real>
  ContactTimes<Real> of_contacts() const {
    return {.time_step = static_cast<Real>(last_time_step),
            .first_time_step = static_cast<Real>(is_first() ? time_step : 0)};
  }

 private:
  bool is_first() const { return !(last_time_step > 0); }
};

}  // namespace silt::dem::detail
