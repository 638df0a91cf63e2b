// SPDX-License-Identifier: MIT
// The contacts of the benchmarks of [ChungOoi2011], for comparisons with them and with codes that
// have the same form.
#pragma once

#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/elastic.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/slider.hpp>

namespace silt::dem {

/// Parameters of chung_ooi_law().
struct ChungOoiMaterial {
  Elastic elastic = {};               ///< of a rigid wall E = 1e30 Pa
  Restitution restitution = {};       ///< e [-] in (0, 1]
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)
};

/// The contacts of [ChungOoi2011]: Hertz's and Mindlin's springs with Tsuji's dashpots; the
/// tangential spring keeps its displacement, F_s = −k_t ξ, also while the contact area grows. Use
/// it with chung_ooi_settings:
///
///   dem::Contacts{dem::Materials{chung_ooi_law(sphere), chung_ooi_law(rigid)}, plane}
///       .with(dem::chung_ooi_settings)
///
/// Unlike the default of Mindlin it may create energy, and R as lever arm changes the angular
/// momentum.
inline Law<Hertz, Mindlin> chung_ooi_law(const ChungOoiMaterial& values) {
  return {Hertz{.elastic = values.elastic, .restitution = values.restitution},
          Mindlin{.elastic = values.elastic,
                  .friction_angle = values.friction_angle,
                  .keeps_displacement = true}};
}

/// The lever arm is R; all else is the default.
inline constexpr ContactSettings chung_ooi_settings{.lever_arm = LeverArm::radius};

}  // namespace silt::dem
