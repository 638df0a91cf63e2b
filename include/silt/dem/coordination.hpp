// SPDX-License-Identifier: MIT
// How many contacts grains have.
#pragma once

#include <silt/core/types.hpp>

#include <vector>

namespace silt::dem {

struct Coordination {
  double mean = 0;  ///< Z: contacts per grain, each counted at both of its grains, walls at one [-]
  /// Z_m of [Thornton2000]: the same among the contacts and grains that may bear a load, so
  /// without grains that have one contact or none, and without the former's contacts; 0 if there
  /// are no others [-].
  double mechanical = 0;
  double rattlers = 0;  ///< share of grains with one contact or none [-]
};

/// Of the contacts of the last step among these grains; all 0 without grains.
template <class P, class C>
Coordination coordination(const P& grains, const C& contacts) {
  std::vector<Index> number(grains.size());
  contacts.for_each_contact(grains, [&](Index i, Index j, const auto&, const auto&) {
    ++number[i];
    if (j != no_index) ++number[j];
  });
  double sum = 0;
  double with_one = 0;
  double with_none = 0;
  for (const Index each : number) {
    sum += double(each);
    with_one += each == 1;
    with_none += each == 0;
  }
  const double all = double(grains.size());
  const double bearing = all - with_one - with_none;
  Coordination coordination;
  if (all > 0) {
    coordination.mean = sum / all;
    coordination.rattlers = (with_one + with_none) / all;
  }
  if (bearing > 0) coordination.mechanical = (sum - with_one) / bearing;
  return coordination;
}

}  // namespace silt::dem
