// SPDX-License-Identifier: MIT
// What contacts keep of a step: the list, the histories before and after, and the grains as the law
// saw them. From these, the results of single contacts are computed again when they are asked for.
// Nothing of it is changed by later steps, so that a failed step is rolled back by returning to the
// evaluation before it, and a copy of a simulation shares it.
#pragma once

#include <silt/core/columns.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/list_renewal.hpp>
#include <silt/dem/law/law_history.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace silt::dem {

/// The histories of all contacts of a list after a step, in groups of eight, number by number, and
/// which of them touch. Those of contacts that do not touch are unspecified. Kept is a LawHistory.
template <class Real, class KeptType>
class Histories {
 public:
  using Kept = KeptType;
  static constexpr int words = Kept::words;

  void resize(Index groups) {
    resize_tightly(numbers_, groups * words * lanes);
    resize_tightly(touching_, groups);
  }
  /// None touches.
  void clear() { std::fill(touching_.begin(), touching_.end(), std::uint8_t(0)); }

  unsigned touching_in_group(Index group) const noexcept { return touching_[group]; }
  void set_touching_in_group(Index group, unsigned touching) noexcept {
    touching_[group] = static_cast<std::uint8_t>(touching);
  }
  bool touches(Index contact) const noexcept {
    return (touching_[contact / lanes] >> (contact % lanes) & 1) != 0;
  }
  /// May be called for contacts of the same group by several threads.
  void set_touching(Index contact) noexcept {
    const auto bit = static_cast<std::uint8_t>(1u << (contact % lanes));
    std::atomic_ref(touching_[contact / lanes]).fetch_or(bit, std::memory_order_relaxed);
  }

  Real* group(Index number) noexcept { return numbers_.data() + number * words * lanes; }
  const Real* group(Index number) const noexcept {
    return numbers_.data() + number * words * lanes;
  }
  /// Number k of contact c.
  Real& at(Index contact, int k) noexcept {
    return group(contact / lanes)[k * lanes + int(contact % lanes)];
  }
  Real at(Index contact, int k) const noexcept {
    return group(contact / lanes)[k * lanes + int(contact % lanes)];
  }
  /// The history of a contact; that of a new one if it does not touch.
  typename Kept::type of(Index contact) const {
    if constexpr (words == 0) {
      return {};
    } else {
      if (!touches(contact)) return {};
      Real own[words];
      for (int k = 0; k < words; ++k) own[k] = at(contact, k);
      return Kept::from(own);
    }
  }
  void set(Index contact, const typename Kept::type& history) {
    set_touching(contact);
    if constexpr (words > 0) {
      Real own[words];
      Kept::put(history, own);
      for (int k = 0; k < words; ++k) at(contact, k) = own[k];
    }
  }

 private:
  std::vector<Real, silt::detail::CacheAligned<Real>> numbers_;
  std::vector<std::uint8_t> touching_;  // a bit for each contact of a group
};

/// Objects that are used again when no other owner is left. A copy is empty.
template <class T>
class Pool {
 public:
  Pool() = default;
  Pool(Pool&&) = default;
  Pool& operator=(Pool&&) = default;
  Pool(const Pool&) {}
  Pool& operator=(const Pool&) { return *this; }

  std::shared_ptr<T> take() {
    for (const auto& each : all_) {
      if (each.use_count() > 1) continue;
      // The last other owner may have read it in another thread.
      std::atomic_thread_fence(std::memory_order_acquire);
      return each;
    }
    return all_.emplace_back(std::make_shared<T>());
  }

 private:
  std::vector<std::shared_ptr<T>> all_;
};

/// The rows of grains, owned together with their container; see GrainRows.
template <class P>
class SharedGrains {
  using Real = typename P::Real;
  using Numbers = std::vector<Real, silt::detail::CacheAligned<Real>>;

 public:
  using Pools = Pool<Numbers>;

  SharedGrains() = default;
  /// Copies the grains, unless a step of their integrator leaves them unchanged.
  SharedGrains(const P& grains, Pools& copies) {
    const auto share = [&](auto field) -> std::shared_ptr<const Numbers> {
      const auto shared = grains.storage(field).share();
      if (grains.is_advancing(field)) return shared;
      const auto copy = copies.take();
      *copy = *shared;
      return copy;
    };
    rows_ = share(position);
    if constexpr (P::dimension == 2) {
      spins_ = rows_;
    } else {
      spins_ = share(spin);
    }
  }

  GrainRows<P::dimension, Real> rows() const {
    return {rows_ ? rows_->data() : nullptr, spins_ ? spins_->data() : nullptr};
  }

 private:
  std::shared_ptr<const Numbers> rows_;
  std::shared_ptr<const Numbers> spins_;
};

/// An evaluation of all contacts in one step. Kept is a LawHistory.
template <class P, class Kept, bool has_couple>
struct Evaluation {
  using Real = typename P::Real;
  using Lanes = LawLanes<P::dimension, Real, Kept::words, has_couple>;
  using List = ListOfStep<P::dimension, Real>;
  using Histories = dem::Histories<Real, Kept>;

  std::shared_ptr<const List> list = std::make_shared<List>();
  std::shared_ptr<const Histories> before = std::make_shared<Histories>();
  std::shared_ptr<const Histories> after = std::make_shared<Histories>();
  SharedGrains<P> grains;
  Box<P::dimension, Real> box;
  Index count = 0;  ///< of contacts that touch
  StepTime step;
  mutable ListLifetime lifetime;  ///< of the list

  const ContactList& contacts() const noexcept { return list->contacts; }
};

}  // namespace silt::dem
