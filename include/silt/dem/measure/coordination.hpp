// SPDX-License-Identifier: MIT
// Coordination number: contacts per grain.
#pragma once

#include <silt/core/types.hpp>

#include <vector>

namespace silt::dem {

struct Coordination {
  double mean = 0;  ///< Z: contacts per grain; a contact counts for each of its grains [-]
  /// Z_m of [Thornton2000]: without grains that have one contact or none, which cannot bear a load,
  /// and without the contacts of the former; 0 if there are no other grains [-].
  double mechanical = 0;
  double rattlers = 0;  ///< fraction of grains with one contact or none [-]
};

/// Coordination in the last step; all 0 without grains.
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
