// SPDX-License-Identifier: MIT
// What the evaluation of the contacts of a block needs, the same for each instruction set, and how a
// contact is refused.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/contact_results.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/law_between.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/wall/moving.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace silt::dem::detail {

/// A contact that is refused.
struct DeepOverlap {
  double overlap = 0;      ///< [m]
  double radius = 0;       ///< the smaller one [m]
  double max_overlap = 0;  ///< see ContactSettings
  bool has_normal = true;  ///< the centres do not coincide to round-off
};
/// `names` are those of the two, and `where` the first grain.
[[noreturn, gnu::cold]] inline void refuse_overlap(const DeepOverlap& deep,
                                                   const std::string& names, const Where& where) {
  if (!deep.has_normal) {
    fail({"dem::Contacts: the centres of ", names, " coincide; place them apart"}, where);
  }
  fail({"dem::Contacts: ", names, " overlap by ", deep.overlap,
        " m, more than max_overlap = ", deep.max_overlap, " of the radius ", deep.radius,
        " m; place them apart, use a stiffer material or a shorter time step, or raise "
        "ContactSettings::max_overlap"},
       where);
}

/// What the evaluation of blocks needs. Refers to its arguments; Walls is a WallSet.
template <class P, class Law, class Walls>
struct BlockInput {
  using Evaluation = detail::Evaluation<P, Law>;
  using Lanes = typename Evaluation::Lanes;
  using Histories = typename Evaluation::Histories;
  using Results = ResultsTo<Lanes, Histories>;
  using Real = typename P::Real;
  using Grains = GrainRows<P::dimension, Real>;

  /// `known` are the histories before the step, `rows` as in the step of the evaluation.
  BlockInput(const Evaluation& of, const typename Evaluation::Known& known, const Grains& rows,
             const Materials<Law>& laws, const Walls& all_walls, const ContactSettings& settings)
      : evaluation(of),
        contacts(of.contacts()),
        before(known),
        grains(rows),
        materials(laws),
        walls(all_walls),
        walls_now(walls_in_law<P>(all_walls, of.step)),
        times(of.step.template of_contacts<Real>()),
        reduction_per_overlap(settings.lever_arm == LeverArm::radius ? Real(0) : Real(0.5)),
        max_overlap(Real(settings.max_overlap)) {
    if constexpr (Lanes::words > 0) Histories::LawHistory::put({}, new_history.data());
  }

  /// Whether a block with so many contacts that touch should be evaluated as a dense one.
  bool is_dense(Index block, Index touching) const {
    const ContactList::Range pairs = contacts.block(block).pairs;
    return touching * 3 > pairs.last - pairs.first;
  }

  /// For laws that are not written for lanes, or that depend on the materials. Contact l is in lane
  /// l if bit l of `touching` is set.
  [[gnu::noinline]] void evaluate_one_by_one(Lanes& eight, const EightNumbers& numbers,
                                             unsigned touching) const {
    for (int lane = 0; lane < lanes; ++lane) {
      if ((touching >> lane & 1) == 0) continue;
      const Index c = numbers[static_cast<Index>(lane)];
      eight.template evaluate<Real>(law_between(*evaluation.list, materials, walls, c), times,
                                    lane);
    }
  }

  /// The first contact in the lanes `refused` is too deep: throws.
  template <bool of_walls>
  [[noreturn, gnu::cold, gnu::noinline]] void refuse(const std::uint32_t* first,
                                                     const std::uint32_t* second,
                                                     unsigned refused) const {
    const int lane = std::countr_zero(refused);
    const Index i = ContactList::unscaled(first[lane]);
    const Index other = ContactList::unscaled(second[lane]);
    const Id id = contacts.id(i);
    const Where where{.particle = i, .id = id};
    const Real R = grains.radius_of(i);
    const auto x = grains.position_of(i);
    if constexpr (of_walls) {
      refuse_overlap({.overlap = double(R - walls_now.nearest(other, x).distance),
                      .radius = double(R),
                      .max_overlap = double(max_overlap)},
                     message_of({"grain ", id, " and wall ", walls_now.number_of(other)}), where);
    } else {
      const NearestImage<P::dimension, Real> image(evaluation.box);
      const Real R_j = grains.radius_of(other);
      const Real distance = image(grains.position_of(other) - x).norm();
      refuse_overlap({.overlap = double(R + R_j - distance),
                      .radius = double(std::min(R, R_j)),
                      .max_overlap = double(max_overlap),
                      .has_normal = distance > std::numeric_limits<Real>::epsilon() * (R + R_j)},
                     message_of({"grains ", id, " and ", contacts.id(other)}), where);
    }
  }

  const Evaluation& evaluation;
  const ContactList& contacts;
  typename Evaluation::Known before;
  Grains grains;
  const Materials<Law>& materials;
  const Walls& walls;
  decltype(walls_in_law<P>(std::declval<const Walls&>(), StepTime{})) walls_now;
  ContactTimes<Real> times;
  /// Fraction of δ by which the lever arms of two grains are shorter than R; at a wall it is twice
  /// as large.
  Real reduction_per_overlap;
  Real max_overlap;                                              ///< see ContactSettings
  std::array<Real, std::max(Lanes::words, 1)> new_history = {};  ///< of a new contact
};

}  // namespace silt::dem::detail
