// SPDX-License-Identifier: MIT
// The law between the two sides of a contact, and its evaluation for a batch of contacts.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact/block_evaluator.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/materials.hpp>

namespace silt::dem::detail {

/// The law of a contact of a list.
template <class List, class Law, class Walls>
const Law& law_between(const List& list, const Materials<Law>& materials, const Walls& walls,
                       Index c) {
  const ContactList& contacts = list.contacts;
  const std::vector<std::uint32_t>& of_grains = list.constants.materials;
  const Index second = contacts.second(c);
  return materials.between(
      of_grains[contacts.first(c)],
      contacts.is_of_wall(c) ? walls.material(walls.number_of(second)) : of_grains[second]);
}

/// The walls of a WallSet at the time N of a step.
template <class P, class Walls>
auto walls_at(const Walls& walls, const StepTime& step) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = step.time, .velocities = step.time});
}
/// The same with the velocities of N − ½, as used by the law.
template <class P, class Walls>
auto walls_in_law(const Walls& walls, const StepTime& step) {
  return walls.template at<P::dimension, typename P::Real>(
      {.positions = step.time, .velocities = step.of_velocities()});
}

/// evaluate(lanes, count, touching, contacts) of a BlockEvaluator; refers to its arguments.
template <class P, class Evaluation, class Law, class Walls>
auto law_evaluation(const Evaluation& evaluation, const Materials<Law>& materials,
                    const Walls& walls) {
  using Real = typename P::Real;
  return [&evaluation, &materials, &walls](auto* eights, Index count, const unsigned* touching,
                                           const EightNumbers* contacts) {
    const auto times = evaluation.step.template of_contacts<Real>();
    if constexpr (LawInLanes<Law, P::dimension, Real>) {
      if (materials.count() == 1) {
        return evaluate_in_lanes(materials.between(0, 0), eights, static_cast<int>(count), times);
      }
    }
    for (Index e = 0; e < count; ++e) {
      for (int lane = 0; lane < lanes; ++lane) {
        if ((touching[e] >> lane & 1) == 0) continue;
        const Index c = contacts[e][static_cast<Index>(lane)];
        eights[e].template evaluate<Real>(law_between(*evaluation.list, materials, walls, c), times,
                                          lane);
      }
    }
  };
}

/// The BlockEvaluator of a step: the grains as in the step, and a WallsAtTime.
template <class P, class Evaluation, class Walls, class Evaluate>
auto block_evaluator(const Evaluation& evaluation,
                     const GrainRows<P::dimension, typename P::Real>& grains, const Walls& walls,
                     const ContactSettings& settings, const Evaluate& evaluate) {
  using Real = typename P::Real;
  using Evaluator =
      BlockEvaluator<typename Evaluation::Lanes, typename Evaluation::Histories, Walls, Evaluate>;
  return Evaluator(
      typename Evaluator::Input{
          .contacts = evaluation.contacts(),
          .grains = grains,
          .image = NearestImage<P::dimension, Real>(evaluation.box),
          .before = *evaluation.before,
          .walls = walls,
          .reduction_per_overlap = settings.lever_arm == LeverArm::radius ? Real(0) : Real(0.5),
          .max_overlap = Real(settings.max_overlap)},
      evaluate);
}

}  // namespace silt::dem::detail
