// SPDX-License-Identifier: MIT
// What contacts keep of a step: the list, the histories before and after, and the grains as the law
// saw them. From these, the results of single contacts are computed again when they are asked for.
// No result in it is changed by later steps, so that a failed step is rolled back by returning to
// the evaluation before it, and a copy of a simulation shares it.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/histories.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/list_rebuild.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>

#include <algorithm>
#include <atomic>
#include <memory>

namespace silt::dem::detail {

/// Objects that are used again when no other owner is left.
template <class T>
class Pool {
 public:
  std::shared_ptr<T> take() {
    for (const auto& each : all_) {
      if (each.use_count() > 1) continue;
      // The last other owner may have read it in another thread.
      std::atomic_thread_fence(std::memory_order_acquire);
      return each;
    }
    return all_.emplace_back(std::make_shared<T>());
  }
  bool has(const T* object) const {
    return std::any_of(all_.begin(), all_.end(),
                       [object](const auto& each) { return each.get() == object; });
  }
  /// f(object) for those without another owner.
  template <class F>
  void for_each_unused(F&& f) const {
    for (const auto& each : all_) {
      if (each.use_count() > 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // as in take()
      f(*each);
    }
  }
  /// Frees those without another owner.
  void free_unused() {
    for (Index k = all_.size(); k-- > 0;) {
      if (all_[k].use_count() > 1) continue;
      all_[k].swap(all_.back());
      all_.pop_back();
    }
  }

 private:
  Buffer<std::shared_ptr<T>> all_;
};

/// The rows of grains, owned together with their container; see GrainRows.
template <class P>
class SharedGrains {
  using Real = typename P::Real;
  using Numbers = Buffer<Real>;

 public:
  using Pools = Pool<Numbers>;

  SharedGrains() = default;
  /// Copies the grains, unless a step of their integrator leaves them unchanged.
  SharedGrains(const P& grains, Pools& copies) {
    const auto share = [&](auto field) -> std::shared_ptr<const Real> {
      const auto stored = grains.storage(field);
      if (grains.is_advancing(field)) {
        copies.free_unused();
        return stored.share();
      }
      const auto copy = copies.take();
      copy->assign(stored.numbers());
      return {copy, copy->data()};
    };
    rows_ = share(position);
    if constexpr (P::dimension == 2) {
      spins_ = rows_;
    } else {
      spins_ = share(spin);
    }
  }

  GrainRows<P::dimension, Real> rows() const {
    return {rows_.get(), spins_.get()};
  }

 private:
  std::shared_ptr<const Real> rows_;
  std::shared_ptr<const Real> spins_;
};

/// An evaluation of all contacts in one step.
template <class P, class Law>
struct Evaluation {
  using Real = typename P::Real;
  using LawHistory = dem::LawHistory<Law, P::dimension, Real>;
  using Lanes =
      LawLanes<P::dimension, Real, LawHistory::words, GivesCouple<Law, P::dimension, Real>>;
  using List = ReusableList<P::dimension, Real>;
  using Histories = detail::Histories<Real, LawHistory>;

  using Known = KnownHistories<Real, LawHistory::words>;

  std::shared_ptr<const List> list;
  std::shared_ptr<const List> list_before;  ///< whose contacts `before` is of
  std::shared_ptr<const Histories> before;
  std::shared_ptr<const Histories> after;
  SharedGrains<P> grains;
  Box<P::dimension, Real> box;
  Index count = 0;  ///< of contacts that touch
  Index added_blocks = 0;  ///< of the list in this step; a later one may have added further
  StepTime step;
  mutable ListLifetime lifetime;  ///< of the list

  Evaluation() = default;
  // Not inlined, because each is used in several places.
  [[gnu::noinline]] Evaluation(const Evaluation&) = default;
  [[gnu::noinline]] Evaluation(Evaluation&&) noexcept = default;
  [[gnu::noinline]] Evaluation& operator=(const Evaluation&) = default;
  [[gnu::noinline]] Evaluation& operator=(Evaluation&&) noexcept = default;
  [[gnu::noinline]] ~Evaluation() = default;

  /// Before the first step: without contacts.
  static Evaluation of_no_step() {
    Evaluation evaluation;
    evaluation.list = evaluation.list_before = std::make_shared<List>();
    evaluation.before = evaluation.after = std::make_shared<Histories>();
    return evaluation;
  }

  const ContactList& contacts() const noexcept { return list->contacts; }

  /// The forces can be evaluated again, from the grains and histories before.
  bool is_repeatable() const noexcept { return before != nullptr; }
  /// Whether the list was built in this step, so that contacts had other numbers before it.
  bool is_of_new_list() const noexcept { return list_before != list; }
  /// The histories before the step, of contacts of the list; index_of(id) is the index of a grain
  /// in the list.
  template <class IndexOf>
  void move_before_to(Histories& histories, IndexOf&& index_of) const {
    histories.fill(list->contacts, index_of, list_before->contacts, *before);
  }
  /// Gives their memory to the next step.
  void forget_input() noexcept {
    grains = {};
    list_before.reset();
    before.reset();
  }
};

}  // namespace silt::dem::detail
