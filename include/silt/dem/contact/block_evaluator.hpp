// SPDX-License-Identifier: MIT
// Evaluates the law for the contacts of a block of grains, in batches: the geometry of 16 groups of
// eight contacts, then the law for all of them, then their results. One group after the other takes
// half as long again, because the law reads what the geometry has just stored.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_BLOCK_EVALUATOR
#define SILT_DEM_CONTACT_BLOCK_EVALUATOR

#include <silt/core/lane.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/block_input.hpp>
#include <silt/dem/contact/contact_geometry.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/contact_results.hpp>
#include <silt/dem/contact/law_between.hpp>
#include <silt/dem/contact/law_lanes.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/contact.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

#define SILT_KERNELS <silt/dem/contact/block_evaluator.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::dem::detail {

/// Evaluates the contacts of a block; returns how many of them touch. If it is dense, contacts that
/// do not touch are evaluated, too; the results are the same.
template <class P, class Law, class Walls>
Index evaluate_block(const BlockInput<P, Law, Walls>& input, Index block, bool is_dense,
                     const typename BlockInput<P, Law, Walls>::Results& to) {
  return SILT_FOR_PROCESSOR(evaluate_block<P, Law, Walls>)(input, block, is_dense, to);
}

}  // namespace silt::dem::detail

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Evaluates a law for `count` times eight contacts.
template <class Law, class Times, class Lanes>
SILT_VECTORISES [[gnu::flatten, gnu::noinline]] void evaluate_in_lanes(const Law& for_all,
                                                                       const Times& of_all,
                                                                       Lanes* groups, Index count) {
  // Copies that no store below can change.
  const Law law = for_all;
  const Times times = of_all;
  for (Index e = 0; e < count; ++e) {
    Lanes& eight = groups[e];
    SILT_INDEPENDENT_ITERATIONS
    for (int lane = 0; lane < lanes; ++lane) {
      eight.template evaluate<Lane<typename Lanes::Real>>(law, times, lane);
    }
  }
}

/// Goes through the contacts of a block, group by group, and passes what the law returns for those
/// that touch to a ContactResults:
///
///   auto remaining = evaluator.contacts_of(block, is_dense);
///   while (evaluator.fill(batch, remaining, results)) evaluator.evaluate(batch, results);
///
/// Refers to its arguments; Walls is a WallSet.
///
/// In a dense block, groups are evaluated as a whole, including contacts that do not touch. In
/// other blocks, the contacts that touch are collected until there are eight. The results are the
/// same.
template <class P, class Law, class Walls>
class BlockEvaluator {
  using Input = BlockInput<P, Law, Walls>;
  using Lanes = typename Input::Lanes;
  using Histories = typename Input::Histories;
  using Real = typename P::Real;
  static constexpr int dimension = P::dimension;
  using Vec = typename P::Vec;
  using Grains = GrainPacks<dimension, Real>;
  // Pairs or walls of a block: those that are left, and the last ones that touch, until there are
  // eight. Twice as many, because those of a further group are added before eight are removed.
  struct Collection {
    explicit Collection(const ContactList::Range& range) : left(range) {}

    ContactList::Range left;
    std::array<std::uint32_t, 2 * lanes> contacts;
    std::array<std::uint32_t, 2 * lanes> first;
    std::array<std::uint32_t, 2 * lanes> second;
    Index count = 0;
  };

 public:
  using Results = ContactResults<Lanes, Histories>;

  explicit BlockEvaluator(const Input& input)
      : in_(input), grains_(input.grains), image_(input.evaluation.box) {}

  /// Groups of contacts whose law is evaluated together.
  class Batch {
    friend class BlockEvaluator;
    static constexpr Index size = 16;
    bool is_full() const { return count_ == size; }

    std::array<Lanes, size> lanes_;
    std::array<EightNumbers, size> contacts_;
    std::array<unsigned, size> touching_;
    std::array<std::uint32_t, size> group_;  // `collected`: from several groups
    Index count_ = 0;
  };
  /// The contacts of a block that are not in a batch yet.
  class Remaining {
   public:
    /// Number of contacts that touch, of those that are no longer among them.
    Index touching() const { return touching_; }

   private:
    friend class BlockEvaluator;
    Remaining(const ContactList::Block& block, bool is_dense)
        : pairs_(block.pairs), walls_(block.walls), is_dense_(is_dense) {}

    Collection pairs_;
    Collection walls_;
    bool is_dense_;
    Index touching_ = 0;
  };

  /// All contacts of a block.
  Remaining contacts_of(Index block, bool is_dense) const {
    return {in_.contacts.block(block), is_dense};
  }
  /// Fills a batch with the next contacts that touch; returns false if there are none.
  [[gnu::noinline]] bool fill(Batch& batch, Remaining& of, Results& results) const {
    batch.count_ = 0;
    if (of.is_dense_) {
      add_groups(batch, of, results);
    } else {
      add_touching<false>(batch, of.pairs_, of.touching_, results);
    }
    // Grains may come near to several elements of a wall, but touch few of them.
    add_touching<true>(batch, of.walls_, of.touching_, results);
    return batch.count_ > 0;
  }
  /// Evaluates the law for the contacts of a batch, and possibly for others in its lanes.
  [[gnu::flatten, gnu::noinline]] void evaluate(Batch& batch, Results& results) const {
    const Index count = batch.count_;
    for (Index e = 0; e < count; ++e) {
      if (batch.group_[e] != collected) {
        load_histories(batch.group_[e], batch.lanes_[e]);
      } else {
        load_histories(batch.contacts_[e], batch.lanes_[e]);
      }
    }
    if (LawInLanes<Law, dimension, Real> && in_.materials.count() == 1) {
      if constexpr (LawInLanes<Law, dimension, Real>) {
        evaluate_in_lanes(in_.materials.between(0, 0), in_.times, batch.lanes_.data(), count);
      }
    } else {
      for (Index e = 0; e < count; ++e) {
        in_.evaluate_one_by_one(batch.lanes_[e], batch.contacts_[e], batch.touching_[e]);
      }
    }
    for (Index e = 0; e < count; ++e) {
      if (batch.group_[e] != collected) {
        results.store_group(batch.group_[e], batch.lanes_[e], batch.touching_[e]);
      } else {
        const auto touching = static_cast<Index>(std::popcount(batch.touching_[e]));
        results.store_contacts(batch.contacts_[e], touching, batch.lanes_[e]);
      }
    }
  }

 private:
  static constexpr std::uint32_t collected = ~std::uint32_t(0);

  void add_groups(Batch& batch, Remaining& of, Results& results) const {
    const auto [begin, last] = of.pairs_.left;
    Index c = begin;
    for (; c < last && !batch.is_full(); c += lanes) {
      const std::uint32_t* const first = in_.contacts.first_of_group(c);
      const std::uint32_t* const second = in_.contacts.second_of_group(c);
      Lanes& next = batch.lanes_[batch.count_];
      ContactGeometry<Lanes> geometry;
      const unsigned touching =
          find_contacts<false>(geometry, c, next) & simd::first_lanes<lanes>(last - c);
      results.begin(c / lanes, touching, true);
      of.touching_ += static_cast<Index>(std::popcount(touching));
      compute<false>(geometry, first, second, touching, next);
      batch.contacts_[batch.count_] = eight_from(c);
      batch.touching_[batch.count_] = touching;
      batch.group_[batch.count_++] = static_cast<std::uint32_t>(c / lanes);
    }
    of.pairs_.left.first = c;
  }

  template <bool of_walls>
  void add_touching(Batch& batch, Collection& collection, Index& count, Results& results) const {
    const Index last = collection.left.last;
    Index c = collection.left.first;
    for (; c < last && !batch.is_full(); c += lanes) {
      const std::uint32_t* const first = in_.contacts.first_of_group(c);
      const std::uint32_t* const second = in_.contacts.second_of_group(c);
      ContactGeometry<Lanes> geometry;
      const unsigned touching = find_contacts<of_walls>(geometry, c, batch.lanes_[batch.count_]) &
                                simd::first_lanes<lanes>(last - c);
      results.begin(c / lanes, touching, false);
      count += static_cast<Index>(std::popcount(touching));
      const EightNumbers numbers = eight_from(c);
      append(numbers.data(), collection.contacts, collection.count, touching);
      append(first, collection.first, collection.count, touching);
      collection.count += append(second, collection.second, collection.count, touching);
      if (collection.count < Index(lanes)) continue;
      add_collected<of_walls>(batch, collection);
      collection.count -= Index(lanes);
      for (auto* const column : {&collection.contacts, &collection.first, &collection.second}) {
        std::copy_n(column->begin() + lanes, lanes, column->begin());
      }
    }
    collection.left.first = c;
    if (collection.count > 0 && c >= last && !batch.is_full()) {
      add_collected<of_walls>(batch, collection);
      collection.count = 0;
    }
  }
  static EightNumbers eight_from(Index first) {
    EightNumbers numbers;
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(first));
    return numbers;
  }
  static Index append(const std::uint32_t* values, std::array<std::uint32_t, 2 * lanes>& to,
                      Index count, unsigned chosen) {
    return simd::compress<std::uint32_t, lanes>(to.data() + count, values, chosen);
  }

  template <bool of_walls>
  [[gnu::always_inline]] unsigned find_touching(ContactGeometry<Lanes>& geometry,
                                                const std::uint32_t* first,
                                                const std::uint32_t* second, Lanes& into) const {
    if constexpr (of_walls) {
      const auto nearest = [this](std::uint32_t element, const Vec& x) {
        return in_.walls_now.nearest(ContactList::unscaled(element), x);
      };
      return geometry.find_touching_walls(grains_, first, second, nearest, into);
    } else {
      return geometry.find_touching(grains_, image_, first, second);
    }
  }

  // The same for the contacts from c on, with those that last although they do not touch any more.
  template <bool of_walls>
  [[gnu::always_inline]] unsigned find_contacts(ContactGeometry<Lanes>& geometry, Index c,
                                                Lanes& into) const {
    const std::uint32_t* const first = in_.contacts.first_of_group(c);
    const std::uint32_t* const second = in_.contacts.second_of_group(c);
    unsigned found = find_touching<of_walls>(geometry, first, second, into);
    if constexpr (LastsBeyondTouch<Law, dimension, Real>) {
      for (unsigned left = in_.before.touching_in_group(c / lanes) & ~found; left != 0;
           left &= left - 1) {
        const int lane = std::countr_zero(left);
        const auto gap = geometry.template gap_of<of_walls>(lane);
        const Law& law =
            law_between(*in_.evaluation.list, in_.materials, in_.walls, c + Index(lane));
        if (gap.length < law.max_gap(gap.effective_radius)) found |= 1u << lane;
      }
    }
    return found;
  }

  // Computes the contacts after find_touching().
  template <bool of_walls>
  [[gnu::always_inline]] void compute(const ContactGeometry<Lanes>& geometry,
                                      const std::uint32_t* first, const std::uint32_t* second,
                                      unsigned touching, Lanes& into) const {
    if constexpr (of_walls) {
      const unsigned refused = geometry.too_deep_in_walls(in_.max_overlap) & touching;
      if (refused != 0) in_.template refuse<true>(first, second, refused);
      if constexpr (Walls::move) {
        const auto velocity = [this](std::uint32_t element) {
          return in_.walls_now.velocity(ContactList::unscaled(element));
        };
        geometry.compute_walls(grains_, first, second, 2 * in_.reduction_per_overlap, velocity,
                               into);
      } else {
        geometry.compute_walls(grains_, first, second, 2 * in_.reduction_per_overlap, nullptr,
                               into);
      }
    } else {
      const unsigned refused = geometry.too_close(in_.max_overlap) & touching;
      if (refused != 0) in_.template refuse<false>(first, second, refused);
      geometry.compute_pairs(grains_, first, second, in_.reduction_per_overlap, into);
    }
  }

  template <bool of_walls>
  [[gnu::noinline]] void add_collected(Batch& batch, Collection& collection) const {
    const Index number = std::min<Index>(collection.count, lanes);
    for (Index lane = number; lane < Index(lanes); ++lane) {
      collection.contacts[lane] = collection.contacts[0];
      collection.first[lane] = collection.first[0];
      collection.second[lane] = collection.second[0];
    }
    const unsigned touching = simd::first_lanes<lanes>(number);
    Lanes& next = batch.lanes_[batch.count_];
    ContactGeometry<Lanes> geometry;
    find_touching<of_walls>(geometry, collection.first.data(), collection.second.data(), next);
    compute<of_walls>(geometry, collection.first.data(), collection.second.data(), touching, next);
    std::copy_n(collection.contacts.begin(), lanes, batch.contacts_[batch.count_].begin());
    batch.touching_[batch.count_] = touching;
    batch.group_[batch.count_++] = collected;
  }

  [[gnu::always_inline]] void load_histories(Index group, Lanes& into) const {
    constexpr int N = Grains::N;
    const unsigned known = in_.before.touching_in_group(group);
    const Real* const from = in_.before.group(group);
    for (int k = 0; k < Lanes::words; ++k) {
      const auto fresh = simd::broadcast<Real, N>(in_.new_history[Index(k)]);
      for (int first = 0; first < lanes; first += N) {
        const auto kept = simd::load<Real, N>(from + k * lanes + first);
        simd::store<Real, N>(into.history[k] + first,
                             simd::select<Real, N>(known >> first, kept, fresh));
      }
    }
  }
  [[gnu::always_inline]] void load_histories(const EightNumbers& contacts, Lanes& into) const {
    for (Index lane = 0; lane < lanes; ++lane) {
      const bool is_known = in_.before.touches(contacts[lane]);
      for (int k = 0; k < Lanes::words; ++k) {
        into.history[k][lane] =
            is_known ? in_.before.at(contacts[lane], k) : in_.new_history[Index(k)];
      }
    }
  }

  const Input& in_;
  Grains grains_;
  NearestImage<dimension, Real> image_;
};

/// Evaluates a block with all that it needs; returns how many contacts touch.
template <class P, class Law, class Walls>
Index evaluate_block(const BlockInput<P, Law, Walls>& input, Index block, bool is_dense,
                     const typename BlockInput<P, Law, Walls>::Results& to) {
  using Evaluator = BlockEvaluator<P, Law, Walls>;
  const Evaluator evaluator(input);
  typename Evaluator::Results results(to);
  typename Evaluator::Batch batch;
  auto contacts = evaluator.contacts_of(block, is_dense);
  while (evaluator.fill(batch, contacts, results)) evaluator.evaluate(batch, results);
  return contacts.touching();
}

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
