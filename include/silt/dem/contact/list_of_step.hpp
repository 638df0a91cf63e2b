// SPDX-License-Identifier: MIT
// The list of contacts that a step uses, and the histories of its contacts before the step: those
// of the last step, the same with grains that were added since (added_grains.hpp), a new list
// (list_rebuild.hpp), or one of a checkpoint (saved_list.hpp).
#pragma once

#include <silt/core/own_memory.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/added_grains.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/lasting_contacts.hpp>
#include <silt/dem/contact/law_between.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/contact/saved_list.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/contact/walls_at_sides.hpp>
#include <silt/dem/contact/work_division.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

namespace silt::dem::detail {

/// What grains touch. Walls is a WallSet.
template <class Law, class Walls>
struct ContactSetup {
  const Materials<Law>& materials;
  const Walls& walls;
};

/// The evaluation of the last step, and that of the next one up to its forces. Walls is a WallSet.
template <class P, class Law, class Walls>
class ListOfStep {
  using Real = typename P::Real;
  using Evaluation = detail::Evaluation<P, Law>;
  using History = typename Evaluation::LawHistory::type;
  using List = typename Evaluation::List;
  using Histories = typename Evaluation::Histories;
  using Setup = ContactSetup<Law, Walls>;
  using SavedList = detail::SavedList<P::dimension, Real>;

 public:
  ListOfStep() { state_.last = Evaluation::of_no_step(); }

  const Evaluation& last() const noexcept { return state_.last; }
  /// From set_history(), until the next step; nullptr otherwise.
  const PairHistory<History>* given_history() const noexcept { return state_.given_history.get(); }
  void set_history(const PairHistory<History>& history) {
    state_.given_history = std::make_shared<const PairHistory<History>>(history);
  }

  /// From the next step on, keeps what a step is evaluated from: its results are asked for.
  void keep_input() const { is_input_kept_.set(); }

  /// Whether the list has to be rebuilt, which begin_step() of the same step then does.
  bool needs_rebuild(const P& grains, const Setup& setup, double time) const {
    is_rebuild_announced_ = state_.given_history != nullptr ||
                            have_constants_changed(grains, *state_.last.list,
                                                   state_.last.lifetime.constants_revision) ||
                            !has_usable_list(grains, setup, time);
    return *is_rebuild_announced_;
  }

  /// An evaluation with the list and the histories before it; reach() returns the
  /// ContactReach.
  template <class S, class Reach>
  Evaluation begin_step(P& grains, const S& search, const Setup& setup, const Reach& reach,
                        const StepTime& step) {
    // Other parts of Forces may have had access to the masses since needs_rebuild(); a rebuild then
    // has to wait for the next step, as the search has not been updated.
    const bool may_rebuild = is_rebuild_announced_.value_or(true);
    const bool rebuilds = may_rebuild ? needs_rebuild(grains, setup, step.time)
                                      : !has_usable_list(grains, setup, step.time);
    is_rebuild_announced_.reset();
    Evaluation evaluation;
    evaluation.step = step;
    evaluation.box = grains.box();
    if (rebuilds) {
      begin_with_new_list(grains, search, setup, reach, evaluation);
    } else {
      if (state_.last.contacts().grains() < grains.size()) add_to_list(grains, setup, step);
      evaluation.list = evaluation.list_before = state_.last.list;
      evaluation.lifetime = state_.last.lifetime;
      ++evaluation.lifetime.steps;
      evaluation.before = state_.last.after;
    }
    evaluation.added_blocks = evaluation.contacts().added_blocks();
    return evaluation;
  }
  /// Of the list among threads.
  WorkDivision& division() { return memory_->division; }
  /// Memory for the histories after the step.
  std::shared_ptr<Histories> take_histories() { return memory_->histories.take(); }
  /// The evaluation is complete.
  void finish_step(Evaluation evaluation) {
    state_.last = std::move(evaluation);
    state_.given_history.reset();
  }

  /// restore() undoes all steps since save().
  void save() noexcept {
    if (!is_input_kept_.is_set()) state_.last.forget_input();
    saved_ = state_;
    if (Memory* const memory = memory_.get()) {
      memory->lists.for_each_unused([](List& list) { list.release(); });
    }
  }
  void restore() noexcept {
    state_ = saved_;
    is_rebuild_announced_.reset();
  }

  /// The list of the last step for a checkpoint, if it is of the grains as they are.
  SavedList saved_list(const P& grains, const Walls& walls) const {
    const List& last = *state_.last.list;
    const bool is_of_these =
        !state_.given_history && last.rows_revision == grains.rows_revision() &&
        last.contacts.grains() <= grains.size() && last.walls_revision == walls.revision() &&
        last.constants.are_those_of(grains);
    return is_of_these ? SavedList(last) : SavedList();
  }
  /// The next step uses this list, with the histories of set_history().
  void restore_list(const SavedList& saved, const P& grains, const Setup& setup) {
    if (!saved.fits(setup.walls.elements())) return;
    const auto list = take_list();
    saved.restore(grains, *list);
    const auto& radii = list->constants.radii;  // without those of grains added since
    RadiusRange<Real> range{.smallest = std::numeric_limits<Real>::infinity()};
    for (Index i = 0; i < radii.size(); ++i) {
      range = {.smallest = std::min(range.smallest, radii[i]),
               .largest = std::max(range.largest, radii[i])};
    }
    list->contact_gap = largest_gap<P::dimension>(setup.materials, range);
    list->walls_revision = setup.walls.revision();
    Evaluation last;
    last.list = last.list_before = list;
    last.before = last.after = histories_on(list->contacts, grains);
    finish_step(std::move(last));
  }

 private:
  static constexpr bool knows_stiffness = KnowsStiffness<Law, P::dimension, Real>;

  // Replaced, not changed, by every step.
  struct State {
    Evaluation last;
    std::shared_ptr<const PairHistory<History>> given_history;
  };
  // Used again in every step.
  struct Memory {
    Pool<List> lists;
    Pool<Histories> histories;
    WorkDivision division;
  };

  // Whether the list is valid, perhaps after grains that were added are added to it.
  bool has_usable_list(const P& grains, const Setup& setup, double time) const {
    const List& list = *state_.last.list;
    return can_be_extended(grains, setup.materials, setup.walls, time, list) &&
           !is_stale(grains, setup.walls, time, list, state_.last.lifetime);
  }

  std::shared_ptr<List> take_list() {
    memory_->division.reset();
    return memory_->lists.take();
  }

  template <class S, class Reach>
  void begin_with_new_list(P& grains, const S& search, const Setup& setup, const Reach& reach,
                           Evaluation& evaluation) {
    refuse_unnoticed_changes(grains, *state_.last.list, state_.last.lifetime);
    check_grains(grains, setup.materials);
    silt::detail::check_digits_of_positions(
        "dem::Contacts", grains, "radius",
        [R = std::as_const(grains)[radius]](Index i) { return R[i]; });
    const auto list = take_list();
    rebuild(grains, search, setup, reach(), evaluation.step, *list);
    evaluation.list = list;
    evaluation.lifetime = {.since = grains.travel(),
                           .distance = double(list->margin / 2),
                           .constants_revision = grains.constants_revision()};
    evaluation.list_before = state_.last.list;
    evaluation.before = state_.last.after;
    if (state_.given_history || is_input_kept_.is_set()) {
      evaluation.before = histories_on(list->contacts, grains);
      evaluation.list_before = list;
    }
  }

  template <class S>
  void rebuild(const P& grains, const S& search, const Setup& setup,
               const ContactReach<Real>& reach, const StepTime& step, List& list) {
    begin_list(grains, search, setup.walls, step, reach, state_.last, list);
    const auto walls = walls_at<P>(setup.walls, step);
    if constexpr (decltype(walls)::count > 0)
      check_walls_at_sides(grains, walls, list.reach_of_pairs());
    find_contacts(grains, search, walls, list);
    list.stable_time_step = stable_time_step_of(
        grains, setup, walls, list,
        [&](const auto& bounds_of) { return stable_for_all(list.contacts, bounds_of); });
  }

  // Adds the grains that were added since the last step to the list, in place if no copy of these
  // contacts refers to it. A step that fails leaves it as it is then, for the grains as they are.
  void add_to_list(const P& grains, const Setup& setup, StepTime step) {
    if (!are_list_and_histories_own()) {
      const auto list = take_list();
      const auto histories = memory_->histories.take();
      *list = *state_.last.list;
      *histories = *state_.last.after;
      state_.last.list = state_.last.list_before = list;
      state_.last.after = histories;
    }
    List& list = *std::const_pointer_cast<List>(state_.last.list);
    auto& histories = *std::const_pointer_cast<Histories>(state_.last.after);
    step.time = list.time;
    const auto walls = walls_at<P>(setup.walls, step);
    if constexpr (decltype(walls)::count > 0) {
      check_walls_at_sides(grains, walls, list.reach_of_pairs(), list.contacts.grains());
    }
    if (list.boxes.empty()) {
      reserve_tightly(list.boxes, block_count(grains.size()));
      extend_boxes(list.boxes, list.since, 0);
    }
    const auto found = find_added(grains, walls, list);
    histories.resize(list.contacts.groups_with(found));
    const Index first = list.contacts.size();
    detail::add_to_list(grains, found, list);
    const double stable_before = std::exchange(list.stable_time_step, 0.0);  // until it is known
    const double stable = stable_time_step_of(
        grains, setup, walls, list,
        [&](const auto& bounds_of) { return stable_for_added(list.contacts, first, bounds_of); });
    list.stable_time_step = std::min(stable_before, stable);
  }

  // f(BoundsOfGrains); 0 if the law does not know a stiffness.
  template <class WallsNow, class F>
  double stable_time_step_of(const P& grains, const Setup& setup, const WallsNow& walls,
                             const List& list, F&& f) const {
    if constexpr (knows_stiffness) {
      const auto law_of = [&](Index c) -> const Law& {
        return law_between(list, setup.materials, setup.walls, c);
      };
      return f(BoundsOfGrains(grains, list.contacts, walls, list.margin, law_of));
    } else {
      return 0;
    }
  }

  // Whether no copy of these contacts refers to them.
  bool are_list_and_histories_own() const {
    const Memory* const memory = memory_.get();
    if (memory == nullptr) return false;
    const auto is_own = [](const auto& shared, const auto& pool, const auto&... references) {
      return shared.use_count() == pool.has(shared.get()) + (... + long(references == shared));
    };
    const Evaluation& last = state_.last;
    const bool are_own = is_own(last.list, memory->lists, last.list, last.list_before,
                                saved_.last.list, saved_.last.list_before) &&
                         is_own(last.after, memory->histories, last.after, last.before,
                                saved_.last.after, saved_.last.before);
    // The last other owner may have read them in another thread.
    std::atomic_thread_fence(std::memory_order_acquire);
    return are_own;
  }

  // The histories that contacts of a new list had in the last step.
  std::shared_ptr<const Histories> histories_on(const ContactList& list, const P& grains) {
    const auto histories = memory_->histories.take();
    if (state_.given_history) {
      histories->fill(list, *state_.given_history);
    } else {
      histories->fill(
          list, [&](Id id) { return grains.index_of(id); }, state_.last.contacts(),
          *state_.last.after);
    }
    return histories;
  }

  State state_;
  State saved_;
  // Then the memory of three steps is in use, where two fit the cache better.
  mutable silt::detail::Mark is_input_kept_{false};
  mutable std::optional<bool> is_rebuild_announced_;  // by needs_rebuild(), for the next evaluation
  silt::detail::OwnMemory<Memory> memory_;
};

}  // namespace silt::dem::detail
