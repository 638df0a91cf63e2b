// SPDX-License-Identifier: MIT
// What a list of contacts is built from, when it has to be rebuilt, and how.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/shared_array.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/lasting_contacts.hpp>
#include <silt/dem/contact/list_constants.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace silt::dem::detail {

/// When and with which margin a list was built; kept in checkpoints.
template <int Dim, class Real>
struct ListOrigin {
  /// Positions of the grains, with the halo, when it was built [m].
  SharedArray<Vec<Dim, Real>> since;
  /// Largest gap of its pairs beyond which they are no contacts [m]: how far grains may approach.
  Real margin = 0;
  double time = 0;                    ///< of these positions and of the walls [s]
  Box<Dim, Real> extent;              ///< contains all grains while the list is valid [m]
  double stable_time_step = 0;        ///< stable even if all its pairs touch; 0 if not known [s]
  Index added = 0;                    ///< number of grains added to it, see added_grains.hpp
};

/// A list of contacts, used by all steps until pairs that it does not contain may touch.
template <int Dim, class Real>
struct ReusableList : ListOrigin<Dim, Real> {
  ContactList contacts;
  std::uint64_t rows_revision = 0;   ///< of the grains
  std::uint64_t walls_revision = 0;  ///< of the WallSet
  ListConstants<Real> constants;     ///< of the grains when it was built
  Real largest_radius = 0;           ///< of them [m]
  Real contact_gap = 0;              ///< the largest one of a contact [m], see ContactLaw::max_gap

  /// The gap of a pair up to which it is in the list [m].
  Real reach_of_pairs() const { return contact_gap + this->margin; }
  Buffer<Box<Dim, Real>> boxes;      ///< around `since` by block, see added_grains.hpp

  /// Gives up what others may share, when nobody uses the list.
  void release() noexcept {
    this->since = {};
    constants = {};
  }
};

/// How far grains may travel before it is uncertain, without a loop over them, that a list is
/// valid, the last revision of their constants for which it is, and how many steps have used it.
struct ListLifetime {
  Travel since;
  double distance = 0;  ///< [m]
  /// The list is valid only because displacements are close to their mean.
  bool is_of_mean = false;
  std::uint64_t constants_revision = 0;
  Index steps = 0;  ///< after the one that built it
};

/// The constants of a grain, and which of them cannot be.
struct GrainConstants {
  double radius;   ///< [m]
  double mass;     ///< [kg]
  double inertia;  ///< [kg m²]
  bool is_radius_valid;
  bool is_mass_valid;
  bool is_inertia_valid;
};
[[noreturn, gnu::cold]] inline void refuse_grain(const GrainConstants& grain, const Where& where) {
  const auto refuse = [&where](const char* name, double value, const char* unit_and_rule) {
    fail({"dem::Contacts: ", name, " = ", value, " ", unit_and_rule,
          "; set it, or add grains by add_grain()"},
         where);
  };
  if (!grain.is_radius_valid) {
    refuse("radius", grain.radius,
           "m of a grain must be positive and finite, and so must its square");
  }
  if (!grain.is_mass_valid) {
    refuse("mass", grain.mass, "kg of a grain must be a positive, finite and normal number");
  }
  if (!grain.is_inertia_valid) {
    refuse("inertia", grain.inertia,
           "kg m² of a grain must be a positive, finite and normal number");
  }
  fail({"dem::Contacts: radius = ", grain.radius, " m and mass = ", grain.mass,
        " kg of a grain have products that underflow or overflow; use other units, or double"},
       where);
}

/// Whether the mass of a clump is positive, and that of a grain that belongs to none its own.
template <class P>
bool is_clump_mass_valid([[maybe_unused]] const P& grains, [[maybe_unused]] Index i) {
  if constexpr (HasFields<P, clump_mass_t>) {
    const auto M = grains[clump_mass][i];
    return is_positive_normal(M) && (grains[clump][i] != 0 || M == grains[mass][i]);
  } else {
    return true;
  }
}

/// Whether radius, mass and inertia of a grain are positive and finite, products of radius and mass
/// neither underflow nor overflow, and its material exists.
template <class P, class Law>
bool is_valid(const P& grains, const Materials<Law>& materials, Index i) {
  const auto R = grains[radius][i];
  const auto m = grains[mass][i];
  return is_clump_mass_valid(grains, i) && is_radius(R) && is_positive_normal(m) &&
         is_positive_normal(grains[inertia][i]) && has_products(R, m) &&
         grains[material][i] < materials.count();
}

/// Throws if a radius, mass or inertia is not positive and finite, if products of radius and mass
/// underflow or overflow, or if a grain's material does not exist.
template <class P, class Law>
void check_grains(const P& grains, const Materials<Law>& materials) {
  const auto R = grains[radius];
  const auto m = grains[mass];
  const auto inertias = grains[inertia];
  const auto numbers = grains[material];
  const Index odd =
      first_where(grains.size(), [&](Index i) { return !is_valid(grains, materials, i); });
  if (odd == no_index) return;
  const Where where{.particle = odd, .id = grains.id(odd)};
  materials.check(numbers[odd], "of a grain", where);
  if (!is_clump_mass_valid(grains, odd) && is_positive_normal(m[odd])) {
    fail(
        "dem::Contacts: clump_mass of a grain that belongs to no clump must be its mass, and that "
        "of a "
        "sphere of a clump positive; set both, or add grains by add_grain() and Clumps::add()",
        where);
  }
  refuse_grain({.radius = double(R[odd]),
                .mass = double(m[odd]),
                .inertia = double(inertias[odd]),
                .is_radius_valid = is_radius(R[odd]),
                .is_mass_valid = is_positive_normal(m[odd]),
                .is_inertia_valid = is_positive_normal(inertias[odd])},
               where);
}

/// Half of the shortest period of the box [m]; infinite if no side is periodic.
template <int Dim, class Real>
Real half_period(const Box<Dim, Real>& box) {
  Real shortest = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < Dim; ++k) {
    if (box.periodic[Index(k)]) shortest = std::min(shortest, box.upper[k] - box.lower[k]);
  }
  return shortest / 2;
}
/// The longest period of the box [m]; 0 if no side is periodic.
template <int Dim, class Real>
Real longest_period(const Box<Dim, Real>& box) {
  Real longest = 0;
  for (int k = 0; k < Dim; ++k) {
    if (box.periodic[Index(k)]) longest = std::max(longest, box.upper[k] - box.lower[k]);
  }
  return longest;
}

/// Whether pairs other than those of the list may touch at this time [s]: two grains approach by at
/// most the sum of their displacements relative to the mean of all, a grain and a wall by at most
/// the sum of theirs. The answer does not depend on `lifetime`, which saves time, and not on grains
/// that were added to those of the list. `walls` is a WallSet.
template <class P, class Walls, class List>
bool is_stale(const P& grains, const Walls& walls, double time, const List& list,
              ListLifetime& lifetime) {
  using Real = typename P::Real;
  if (list.rows_revision != grains.rows_revision()) return true;
  if (list.walls_revision != walls.revision()) return true;
  if (grains.empty()) return false;
  const Real half = list.margin / 2;
  if constexpr (Walls::move) {
    const auto moved = walls.max_displacement({.from = list.time, .to = time}, list.extent);
    if (!(moved <= half)) return true;
  }
  const Travel travel = grains.travel();
  // An added grain has not moved with the mean: a list that is valid relative to it is not for
  // them.
  const bool are_any_added = grains.size() > list.contacts.grains();
  if (travel.is_within(lifetime.distance, lifetime.since) &&
      !(are_any_added && lifetime.is_of_mean)) {
    return false;
  }
  const auto x = grains.with_halo(position);
  const Index n = list.since.size();
  const auto& box = grains.box();
  const NearestImage<P::dimension, Real> image(box);
  const auto displacement = [&](Index i) { return image(typename P::Vec(x[i] - list.since[i])); };
  const auto max_relative_to = [&](const typename P::Vec& mean) {
    return std::sqrt(largest(n, Real(0), [&](Index i) {
      const Real squared = (displacement(i) - mean).squaredNorm();
      // A search moves grains that have gone beyond the periodic box back into it.
      const bool is_inside = !image.any() || box.wrap(x[i]) == x[i];
      return squared >= 0 && is_inside ? squared : std::numeric_limits<Real>::infinity();
    }));
  };
  const Real displaced = max_relative_to(P::Vec::Zero());
  const Real left_to_walls = walls.size() == 0 ? std::numeric_limits<Real>::infinity()
                                               : (Walls::move ? half : list.margin) - displaced;
  // How far grains may travel until this loop would find the list stale.
  Real safe = half - displaced;
  lifetime.is_of_mean = safe < 0;
  if (safe < 0 && left_to_walls >= 0) {
    if (are_any_added) return true;
    const typename P::Vec sum = ordered_sum(n, typename P::Vec(P::Vec::Zero()), displacement);
    const Real left = half - max_relative_to(sum / Real(n));
    if (!(left >= 0)) return true;
    // The mean moves as well, and beyond half a period another image is the nearest.
    safe = std::min({left / 2, left_to_walls, half_period(box) - displaced});
  } else if (!(safe >= 0)) {
    return true;
  }
  // Runs that do not know the travel, such as a resumed one, must rebuild in the same step.
  // The last term is that of the mean, a sum over chunks.
  const Real rounding = std::numeric_limits<Real>::epsilon() *
                        (16 * half + 4 * longest_period(box) + 2048 * displaced);
  lifetime.since = travel;
  lifetime.distance = double(safe - rounding);
  return false;
}

/// The box around all grains.
template <class P>
auto extent_of(const P& grains) {
  using Real = typename P::Real;
  const auto x = grains[position];
  Box<P::dimension, Real> box;
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < P::dimension; ++k) {
    box.upper[k] = largest(x.size(), -infinity, [&](Index i) { return x[i][k]; });
    box.lower[k] = -largest(x.size(), -infinity, [&](Index i) { return -x[i][k]; });
  }
  return box;
}

/// Records the positions of a rebuild in this step and chooses the margin; `last` is the Evaluation
/// before, with whose list memory is shared.
template <class P, class S, class Walls, class Last, class List>
void begin_list(const P& grains, const S& search, const Walls& walls, const StepTime& step,
                const ContactReach<typename P::Real>& reach, const Last& last, List& list) {
  using Real = typename P::Real;
  const Real diameter = 2 * reach.largest_radius;
  if (grains.box().any_periodic()) {
    walls.check_in(grains.box(), reach.largest_radius + reach.gap);
  }
  // A small margin gives few pairs, a large one few rebuilds; the search limits it.
  constexpr double lasting_steps = 40;
  const auto v = grains.with_halo(velocity);
  Real fastest = std::sqrt(largest(v.size(), Real(0), [&](Index i) { return v[i].squaredNorm(); }));
  if constexpr (Walls::move) {
    if (grains.size() > 0) {
      list.extent = extent_of(grains);
      for (int k = 0; k < P::dimension; ++k) {
        if (!grains.box().periodic[static_cast<std::size_t>(k)]) continue;
        list.extent.lower[k] = grains.box().lower[k];
        list.extent.upper[k] = grains.box().upper[k];
      }
      fastest = std::max(fastest, walls.max_speed(step.time, list.extent));
    }
  }
  const Real wanted = std::clamp<Real>(Real(2 * lasting_steps * step.time_step) * fastest,
                                       Real(0.006) * diameter, Real(0.1) * diameter);
  list.largest_radius = reach.largest_radius;
  list.contact_gap = reach.gap;
  const Real seen = search.radius() + margin_of<Real>(search) - reach.distance();
  list.margin = std::clamp<Real>(wanted, 0, std::max<Real>(seen, 0));
  list.rows_revision = grains.rows_revision();
  list.added = 0;
  list.boxes.clear();
  list.walls_revision = walls.revision();
  list.time = step.time;
  list.extent.lower.array() -= list.margin;
  list.extent.upper.array() += list.margin;
  const auto x = grains.with_halo(position);
  list.since.assign(x.begin(), x.end(), last_positions_of<typename P::Vec>(search).first(x.size()));
  const List& before = *last.list;
  // All were compared, see refuse_unnoticed_changes().
  const bool are_known = before.rows_revision == grains.rows_revision() &&
                         before.constants.radii.size() == grains.size() &&
                         grains.local() == grains.size() &&
                         last.lifetime.constants_revision == grains.constants_revision();
  if (are_known) {
    list.constants = before.constants;
  } else {
    list.constants.keep(grains, x.size(), before.constants);
  }
}

/// Adds the elements of walls with a gap to a grain below that of pairs of the list; `walls` is a
/// WallsAtTime.
template <class P, class Walls, class List>
void add_walls_near(const P& grains, const Walls& walls, const List& list, Index i,
                    ContactList::PairsOfBlock& pairs) {
  using Real = typename P::Real;
  const Real R = grains[radius][i];
  const auto first = std::ptrdiff_t(pairs.walls.size());
  auto of_other_images = first;
  // Also near the images of a grain that may cross a periodic side while the list is valid.
  const typename P::Vec x = grains[position][i];
  for_each_image(grains.box(), x, list.margin, [&](const auto& at) {
    walls.for_each_element_near(at, Real(R + list.reach_of_pairs()), [&](Index element) {
      const auto begin = pairs.walls.begin();
      if (std::any_of(begin + first, begin + of_other_images,
                      [element](const auto& pair) { return pair.second == element; })) {
        return;
      }
      pairs.add_wall(i, element);
    });
    of_other_images = std::ptrdiff_t(pairs.walls.size());
  });
}

/// Finds all pairs of grains, and of grains and walls, with a gap below reach_of_pairs(); `walls`
/// is a WallsAtTime.
template <class P, class S, class Walls, class List>
void find_contacts(const P& grains, const S& search, const Walls& walls, List& list) {
  using Real = typename P::Real;
  const auto x = grains.with_halo(position);
  const auto R = grains.with_halo(radius);
  const NearestImage<P::dimension, Real> image(grains.box());
  const auto add_pairs = [&grains, &search, x, R, image, reach = list.reach_of_pairs()](
                             Index i, ContactList::PairsOfBlock& pairs) {
    for_each_candidate(search, i, [&](Index found_j) {
      const Index j = grains.owner(found_j);
      // A pair across a periodic side is found at both grains, if both are owned; one is enough.
      if (j != found_j && j < grains.size() && grains.id(j) < grains.id(i)) return;
      if (are_of_one_clump(grains, i, j)) return;
      const Real limit = R[i] + R[j] + reach;
      if (!(image(typename P::Vec(x[j] - x[i])).squaredNorm() < squared(limit))) return;
      const bool in_order = grains.id(i) < grains.id(j);
      pairs.add_pair(in_order ? i : j, in_order ? j : i);
    });
  };
  list.contacts.build(grains.ids_with_halo(), grains.size(),
                      [&](Index first, Index last, ContactList::PairsOfBlock& pairs) {
                        for (Index i = first; i < last; ++i) {
                          add_pairs(i, pairs);
                          if (Walls::count > 0) add_walls_near(grains, walls, list, i, pairs);
                        }
                      });
}

}  // namespace silt::dem::detail
