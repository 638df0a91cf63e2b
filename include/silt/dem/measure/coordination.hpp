// SPDX-License-Identifier: MIT
// Coordination number: contacts per grain.
#pragma once

#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <vector>

namespace silt::dem {

/// What coordination() returns.
struct Coordination {
  double mean = 0;  ///< Z: contacts per grain; a contact counts for each of its grains [-]
  /// Z_m of [Thornton2000]: without grains that have one contact or none, which cannot bear a load,
  /// and without the contacts of the former; 0 if there are no other grains [-].
  double mechanical = 0;
  double rattlers = 0;  ///< fraction of grains with one contact or none [-]
};

/// Coordination in the last step; all 0 without grains. Of grains that processes share, all call it.
template <class P, class C>
Coordination coordination(const P& grains, const C& contacts) {
  std::vector<Index> number(grains.local());
  contacts.for_each_contact(grains, [&](Index i, Index j, const auto&, const auto&) {
    ++number[i];
    if (j != no_index) ++number[j];
  });
  silt::detail::add_to_owners(grains, number);
  double own = 0;
  double own_with_one = 0;
  double own_with_none = 0;
  for (Index i = 0; i < grains.size(); ++i) {
    own += double(number[i]);
    own_with_one += number[i] == 1;
    own_with_none += number[i] == 0;
  }
  const auto [sum, with_one, with_none, all] = silt::detail::sum_of_all(
      grains, std::array{own, own_with_one, own_with_none, double(grains.size())});
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
