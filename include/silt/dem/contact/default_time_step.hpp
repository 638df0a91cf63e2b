// SPDX-License-Identifier: MIT
// The default time step of contacts: a fraction of the shortest contact that may occur. Only
// materials that grains or walls have count, and no pair of two walls, which never touch.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/elementary_time_steps.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace silt::dem::detail {

/// Overlap over radius at which the stiffness of non-linear springs is evaluated.
inline constexpr double usual_overlap = 0.01;

/// A contact of one of the lightest grains, and how long it lasts.
struct TypicalContact {
  double duration = std::numeric_limits<double>::infinity();  ///< [s]; infinite without stiffness
  std::uint32_t material = 0;                                 ///< of the grain
  std::uint32_t other = 0;                                    ///< of the other grain or the wall
  Index wall = no_index;                                      ///< `no_index`: another grain

  std::string name() const {
    if (wall != no_index) {
      return message_of({"a contact of a grain of material ", material, " with wall ", wall,
                         " of material ", other});
    }
    if (material == other) return message_of({"a contact of two grains of material ", material});
    return message_of(
        {"a contact of a grain of material ", material, " with one of material ", other});
  }
};

/// The shortest contact between grains, and that of all; the second may be the first.
struct ShortestContacts {
  TypicalContact of_grains;
  TypicalContact of_all;
  /// Of all lightest grains.
  struct {
    double mass = 0;     ///< [kg]
    double radius = 0;   ///< the smallest [m]
    double inertia = 0;  ///< the smallest [kg m²]
  } lightest{};
  Buffer<std::uint32_t> materials;  ///< that grains have, in ascending order

  /// Whether they are the same with a further grain.
  template <class P>
  bool hold_for(const P& grains, Index i) const {
    const double m = double(grains[mass][i]);
    const bool is_not_lighter =
        m > lightest.mass || (m == lightest.mass && double(grains[radius][i]) >= lightest.radius &&
                              double(grains[inertia][i]) >= lightest.inertia);
    return is_not_lighter &&
           std::binary_search(materials.begin(), materials.end(), grains[material][i]);
  }
};

/// The numbers, in ascending order, of the materials that at least one grain has, of all processes.
template <class P, class Law>
[[gnu::cold]] Buffer<std::uint32_t> materials_of(const P& grains, const Materials<Law>& materials) {
  const auto of_grain = grains[material];
  Buffer<double> is_present(materials.count());
  for (std::uint32_t a = 0; a < materials.count(); ++a) {
    const auto is_it = [&](Index i) { return of_grain[i] == a; };
    is_present[a] = first_where(grains.size(), is_it) != no_index;
  }
  silt::detail::replace_by_largest(grains, is_present);
  Buffer<std::uint32_t> result;
  for (std::uint32_t a = 0; a < materials.count(); ++a) {
    if (is_present[a] > 0) result.push_back(a);
  }
  return result;
}

/// The shortest contacts of the lightest grains, π √(m*/k) with the largest stiffness at
/// usual_overlap. Of grains that processes share, all call it. The grains are valid, see
/// check_grains(); `walls` is a WallSet. Throws if a law returns a stiffness that is not possible.
template <class P, class Law, class Walls>
[[gnu::cold]] ShortestContacts shortest_contacts(const P& grains, const Materials<Law>& materials,
                                                 const Walls& walls) {
  using Real = typename P::Real;
  ShortestContacts shortest;
  constexpr double none = -std::numeric_limits<double>::infinity();
  const auto m = grains[mass];
  const auto minus_m = largest(m.size(), none, [&](Index i) { return -double(m[i]); });
  const double lightest = -silt::detail::largest_of_all(grains, std::array{minus_m})[0];
  if (!is_finite(lightest)) return shortest;
  const auto minus_least = [&](const auto& values) {
    return largest(m.size(), none, [&](Index i) {
      return double(m[i]) == lightest ? -double(values[i]) : none;
    });
  };
  const auto [minus_R, minus_I] = silt::detail::largest_of_all(
      grains, std::array{minus_least(grains[radius]), minus_least(grains[inertia])});
  const double R = -minus_R;
  const double m_over_I = lightest / -minus_I;
  shortest.lightest = {.mass = lightest, .radius = R, .inertia = -minus_I};
  // `share` is ½ between two such grains and 1 at a wall.
  const auto add = [&](TypicalContact& to, const Law& law, double share, TypicalContact typical) {
    Contact<P::dimension, Real> contact{};
    contact.effective_mass = static_cast<Real>(share * lightest);
    contact.effective_radius = static_cast<Real>(share * R);
    contact.overlap = static_cast<Real>(usual_overlap * R);
    const Stiffness k = law.stiffness(contact);
    check_stiffness(k, [&] { return typical.name(); });
    // A tangential spring also rotates the grain: 1 + m R²/I is 3 for discs and 3.5 for spheres.
    const double stiffest = std::max({k.normal, 3.5 * k.tangential, k.rolling * m_over_I});
    if (!(stiffest > 0)) return;
    typical.duration = contact_duration({.mass = share * lightest, .stiffness = stiffest});
    if (typical.duration < to.duration) to = typical;
  };
  shortest.materials = materials_of(grains, materials);
  const auto& present = shortest.materials;
  for (const std::uint32_t a : present) {
    for (const std::uint32_t b : present) {
      add(shortest.of_grains, materials.between(a, b), 0.5, {.material = a, .other = b});
    }
  }
  shortest.of_all = shortest.of_grains;
  for (Index w = 0; w < walls.size(); ++w) {
    const std::uint32_t b = walls.material(w);
    for (const std::uint32_t a : present) {
      add(shortest.of_all, materials.between(a, b), 1, {.material = a, .other = b, .wall = w});
    }
  }
  return shortest;
}

/// Throws if a wall makes the default time step, a fraction 1/steps_per_contact of the shortest
/// contact, less than a thousandth of that for the grains alone.
inline void check_walls_are_not_too_stiff(const ShortestContacts& shortest,
                                          double steps_per_contact) {
  constexpr double least = 1e-3;
  const double alone = shortest.of_grains.duration;
  if (!is_finite(alone) || !(shortest.of_all.duration < least * alone)) return;
  fail({"dem::Contacts: the default time step, ", shortest.of_all.duration / steps_per_contact,
        " s for ", shortest.of_all.name(), ", is less than a thousandth of the ",
        alone / steps_per_contact,
        " s for contacts between grains; use a softer wall, or pass a time step"});
}

}  // namespace silt::dem::detail
