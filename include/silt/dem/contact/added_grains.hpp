// SPDX-License-Identifier: MIT
// Grains that are added while a list of contacts is in use: their contacts are added to it, so that
// it need not be rebuilt for an inflow.
//
// A list is valid because no grain or wall has moved by more than half its margin since it was
// built, see is_stale(): pairs whose gap was larger then do not touch. An added grain is treated as
// if it had been at its place since then.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/lasting_contacts.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <cstdint>

namespace silt::dem::detail {

/// The extent of the list, see ListOrigin, with the grains that were added.
template <class P, class List>
auto extent_with_added(const P& grains, const List& list) {
  auto extent = list.extent;
  for (Index i = list.contacts.grains(); i < grains.size(); ++i) {
    extent.lower = extent.lower.cwiseMin((grains[position][i].array() - list.margin).matrix());
    extent.upper = extent.upper.cwiseMax((grains[position][i].array() + list.margin).matrix());
  }
  return extent;
}

/// Whether the list is of these grains, or can be extended to those that were added: they are few,
/// no larger than the others, valid, and within a periodic box. `time` is that of the step [s],
/// `walls` a WallSet.
template <class P, class Law, class Walls, class List>
bool can_be_extended(const P& grains, const Materials<Law>& materials, const Walls& walls,
                     double time, const List& list) {
  using Real = typename P::Real;
  const Index known = list.contacts.grains();
  const Index n = grains.size();
  if (list.rows_revision != grains.rows_revision() || known > n) return false;
  if (known == n) return true;
  // Added contacts are evaluated by one thread, in blocks of few.
  const Index most = 64 + known / 256;
  if (list.added + (n - known) > most || grains.local() != n || list.since.size() != known) {
    return false;
  }
  const auto x = grains[position];
  const auto R = grains[radius];
  for (Index i = known; i < n; ++i) {
    const bool is_inside = !grains.box().any_periodic() || grains.box().wrap(x[i]) == x[i];
    const RadiusRange<Real> own{.smallest = R[i], .largest = R[i]};
    if (!is_finite(max_norm(x[i])) || !is_inside || !(R[i] <= list.largest_radius) ||
        !(largest_gap<P::dimension>(materials, own) <= list.contact_gap) ||
        !is_valid(grains, materials, i) || !silt::detail::has_digits<Real>(x[i], R[i])) {
      return false;
    }
  }
  if constexpr (Walls::move) {
    const auto moved =
        walls.max_displacement({.from = list.time, .to = time}, extent_with_added(grains, list));
    if (!(moved <= list.margin / 2)) return false;
  }
  return true;
}

/// Extends boxes, around the grains of a block each, by the grains from `first` on.
template <class Boxes, class Positions>
void extend_boxes(Boxes& boxes, const Positions& x, Index first) {
  for (Index i = first; i < x.size(); ++i) {
    if (i % block_size == 0) {
      auto& box = boxes.emplace_back();
      box.lower = box.upper = x[i];
    }
    auto& box = boxes.back();
    box.lower = box.lower.cwiseMin(x[i]);
    box.upper = box.upper.cwiseMax(x[i]);
  }
}

/// Finds the pairs and walls of the added grains; `walls` is a WallsAtTime, of the time of the
/// list.
template <class P, class Walls, class List>
ContactList::PairsOfBlock find_added(const P& grains, const Walls& walls, const List& list) {
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  const Index known = list.contacts.grains();
  const auto x = grains[position];
  const auto R = grains[radius];
  const NearestImage<P::dimension, Real> image(grains.box());
  ContactList::PairsOfBlock found;
  for (Index i = known; i < grains.size(); ++i) {
    const auto add_pair_with = [&](Index j, const Vec& since_j) {
      if (are_of_one_clump(grains, i, j)) return;
      const Real limit = R[i] + R[j] + list.reach_of_pairs();
      if (!(image(Vec(since_j - x[i])).squaredNorm() < squared(limit))) return;
      const bool in_order = grains.id(i) < grains.id(j);
      found.pairs.push_back({static_cast<std::uint32_t>(in_order ? i : j),
                             static_cast<std::uint32_t>(in_order ? j : i)});
    };
    const Real reach = R[i] + list.largest_radius + list.reach_of_pairs();
    for (Index b = 0; b < list.boxes.size(); ++b) {
      const auto& box = list.boxes[b];
      const Vec to_centre = image(Vec((box.lower + box.upper) / 2 - x[i]));
      const Vec gap = to_centre.cwiseAbs() - (box.upper - box.lower) / 2;
      if (gap.maxCoeff() > reach) continue;
      const Index end = std::min(known, (b + 1) * block_size);
      for (Index j = b * block_size; j < end; ++j) add_pair_with(j, list.since[j]);
    }
    for (Index j = known; j < i; ++j) add_pair_with(j, Vec(x[j]));
    if (Walls::count > 0) add_walls_near(grains, walls, list, i, found);
  }
  return found;
}

/// Adds them to the list. If it throws, the list is as before.
template <class P, class List>
void add_to_list(const P& grains, const ContactList::PairsOfBlock& found, List& list) {
  const Index known = list.contacts.grains();
  const auto x = grains[position];
  list.since.reserve_own(grains.size());
  reserve_tightly(list.boxes, block_count(grains.size()));
  list.constants.make_room(grains);
  const auto extent = extent_with_added(grains, list);
  list.contacts.add(grains.ids().subspan(known), found);
  list.extent = extent;
  for (Index i = known; i < grains.size(); ++i) list.since.push_back(x[i]);
  extend_boxes(list.boxes, list.since, known);
  list.constants.add(grains);
  list.added += grains.size() - known;
}

}  // namespace silt::dem::detail
