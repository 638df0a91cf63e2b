// SPDX-License-Identifier: MIT
// What a list of contacts depends on besides positions, and steps do not change: radii, masses,
// moments of inertia and materials. Any access to them that is not const begins a new
// constants_revision() of the grains, even if it changes nothing; then their values decide whether
// the list remains valid.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cstdint>

namespace silt::dem::detail {

/// Copies these fields of the grains to a new list.
template <class P, class List>
void keep_constants(const P& grains, List& list) {
  const auto keep = [&](auto field, auto& values) {
    const auto now = grains[field];
    values.assign(now.begin(), now.end());
  };
  keep(radius, list.radii);
  keep(mass, list.masses);
  keep(inertia, list.inertias);
  keep(material, list.materials);
}

/// Whether the grains have other values than those kept. `known` is the last constants_revision()
/// with the values kept; updated.
template <class P, class List>
bool have_constants_changed(const P& grains, const List& list, std::uint64_t& known) {
  const std::uint64_t revision = grains.constants_revision();
  if (known == revision) return false;
  const auto R = grains[radius];
  const auto m = grains[mass];
  const auto inertias = grains[inertia];
  const auto materials = grains[material];
  const auto is_changed = [&](Index i) {
    return R[i] != list.radii[i] || m[i] != list.masses[i] || inertias[i] != list.inertias[i] ||
           materials[i] != list.materials[i];
  };
  if (list.radii.size() != R.size() || first_where(R.size(), is_changed) != no_index) return true;
  known = revision;
  return false;
}

}  // namespace silt::dem::detail
