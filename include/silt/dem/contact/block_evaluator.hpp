// SPDX-License-Identifier: MIT
// Evaluates the law for the contacts of a block of grains, in batches: the geometry of 16 groups of
// eight contacts, then the law for all of them, then their results. One group after the other takes
// half as long again, because the law reads what the geometry has just stored.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_geometry.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/evaluation.hpp>
#include <silt/dem/contact/law_lanes.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string>

namespace silt::dem::detail {

/// The numbers of eight contacts.
using EightNumbers = std::array<std::uint32_t, lanes>;

/// Goes through the contacts of a block, group by group, and passes the law's results for those
/// that touch to a Results object:
///
///   results.begin(group, touching, is_whole)        once for each group; bit l of `touching` is
///                                                   set if contact l touches
///   results.store_group(group, lanes, touching)     the results of a group that is whole
///   results.store_contacts(contacts, count, lanes)  those of contacts of other groups
/// evaluate(lanes, count, touching, contacts) evaluates the law for lane l of lanes[e] if bit l of
/// touching[e] is set, and possibly for other lanes; contacts[e] are its contacts. `walls` is a
/// WallsAtTime.
///
/// In a dense block, groups are evaluated as a whole, including contacts that do not touch. In
/// other blocks, the contacts that touch are collected until there are eight. The results are the
/// same.
template <class Lanes, class Histories, class Walls, class Evaluate>
class BlockEvaluator {
  using Real = typename Lanes::Real;
  static constexpr int dimension = Lanes::dimension;
  using Vec = silt::Vec<dimension, Real>;
  using Grains = GrainRows<dimension, Real>;
  static constexpr Index batch_size = 16;

 public:
  struct Input {
    const ContactList& contacts;
    Grains grains;
    NearestImage<dimension, Real> image;
    const Histories& before;
    const Walls& walls;
    /// Fraction of δ by which the lever arms of two grains are shorter than R; at a wall it is
    /// twice as large.
    Real reduction_per_overlap;
    Real max_overlap;  ///< see ContactSettings
  };

  BlockEvaluator(const Input& input, const Evaluate& evaluate)
      : input_(input), evaluate_(evaluate) {}

  /// Returns the number of contacts that touch.
  template <class Results>
  Index operator()(Index block, bool is_dense, Results& results) const {
    const ContactList::Block& of = input_.contacts.block(block);
    Batch batch;
    const Index pairs = is_dense ? evaluate_groups<false>(of.pairs, batch, results)
                                 : evaluate_collected<false>(of.pairs, batch, results);
    // Grains may come near to several elements of a wall, but touch few of them.
    return pairs + evaluate_collected<true>(of.walls, batch, results);
  }
  /// Whether a block with so many contacts that touch should be evaluated as a dense one.
  bool is_dense(Index block, Index touching) const {
    const ContactList::Range pairs = input_.contacts.block(block).pairs;
    return touching * 3 > pairs.last - pairs.first;
  }

 private:
  static constexpr std::uint32_t collected = ~std::uint32_t(0);
  struct Batch {
    std::array<Lanes, batch_size> lanes;
    std::array<EightNumbers, batch_size> contacts;
    std::array<unsigned, batch_size> touching;
    std::array<std::uint32_t, batch_size> group;  // `collected`: from several groups
    Index count = 0;
  };
  // Contacts that touch, until there are eight. Twice as large, because those of a further group
  // are added before eight are removed.
  struct Collection {
    std::array<std::uint32_t, 2 * lanes> contacts;
    std::array<std::uint32_t, 2 * lanes> first;
    std::array<std::uint32_t, 2 * lanes> second;
    Index count = 0;
  };

  template <bool of_walls, class Results>
  Index evaluate_groups(ContactList::Range range, Batch& batch, Results& results) const {
    Index count = 0;
    for (Index c = range.first; c < range.last; c += lanes) {
      const auto group = static_cast<std::uint32_t>(c / lanes);
      const std::uint32_t* const first = input_.contacts.first_of_group(c);
      const std::uint32_t* const second = input_.contacts.second_of_group(c);
      Lanes& next = batch.lanes[batch.count];
      ContactGeometry<Lanes> geometry;
      const unsigned touching = find_touching<of_walls>(geometry, first, second, next) &
                                simd::first_lanes<lanes>(range.last - c);
      results.begin(group, touching, true);
      count += static_cast<Index>(std::popcount(touching));
      compute<of_walls>(geometry, first, second, touching, next);
      EightNumbers& contacts = batch.contacts[batch.count];
      for (Index lane = 0; lane < lanes; ++lane) {
        contacts[lane] = static_cast<std::uint32_t>(c + lane);
      }
      add_to_batch(batch, group, touching, results);
    }
    flush(batch, results);
    return count;
  }

  template <bool of_walls, class Results>
  Index evaluate_collected(ContactList::Range range, Batch& batch, Results& results) const {
    Collection collection;
    Index count = 0;
    for (Index c = range.first; c < range.last; c += lanes) {
      const std::uint32_t* const first = input_.contacts.first_of_group(c);
      const std::uint32_t* const second = input_.contacts.second_of_group(c);
      ContactGeometry<Lanes> geometry;
      const unsigned touching =
          find_touching<of_walls>(geometry, first, second, batch.lanes[batch.count]) &
          simd::first_lanes<lanes>(range.last - c);
      results.begin(static_cast<std::uint32_t>(c / lanes), touching, false);
      count += static_cast<Index>(std::popcount(touching));
      std::array<std::uint32_t, lanes> numbers;
      std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(c));
      append(numbers.data(), collection.contacts, collection.count, touching);
      append(first, collection.first, collection.count, touching);
      collection.count += append(second, collection.second, collection.count, touching);
      if (collection.count < Index(lanes)) continue;
      add_collected<of_walls>(batch, collection, results);
      collection.count -= Index(lanes);
      for (auto* const column : {&collection.contacts, &collection.first, &collection.second}) {
        std::copy_n(column->begin() + lanes, lanes, column->begin());
      }
    }
    if (collection.count > 0) add_collected<of_walls>(batch, collection, results);
    flush(batch, results);
    return count;
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
        return input_.walls.nearest(ContactList::unscaled(element), x);
      };
      return geometry.find_touching_walls(input_.grains, first, second, nearest, into);
    } else {
      return geometry.find_touching(input_.grains, input_.image, first, second);
    }
  }

  // Computes the contacts after find_touching().
  template <bool of_walls>
  [[gnu::always_inline]] void compute(const ContactGeometry<Lanes>& geometry,
                                      const std::uint32_t* first, const std::uint32_t* second,
                                      unsigned touching, Lanes& into) const {
    if constexpr (of_walls) {
      const unsigned refused = geometry.too_deep_in_walls(input_.max_overlap) & touching;
      if (refused != 0) refuse<true>(first, second, refused);
      if constexpr (Walls::move) {
        const auto velocity = [this](std::uint32_t element) {
          return input_.walls.velocity(ContactList::unscaled(element));
        };
        geometry.compute_walls(input_.grains, first, second, 2 * input_.reduction_per_overlap,
                               velocity, into);
      } else {
        geometry.compute_walls(input_.grains, first, second, 2 * input_.reduction_per_overlap,
                               nullptr, into);
      }
    } else {
      const unsigned refused = geometry.too_close(input_.max_overlap) & touching;
      if (refused != 0) refuse<false>(first, second, refused);
      geometry.compute_pairs(input_.grains, first, second, input_.reduction_per_overlap, into);
    }
  }

  template <bool of_walls, class Results>
  [[gnu::noinline]] void add_collected(Batch& batch, Collection& collection,
                                       Results& results) const {
    const Index number = std::min<Index>(collection.count, lanes);
    for (Index lane = number; lane < Index(lanes); ++lane) {
      collection.contacts[lane] = collection.contacts[0];
      collection.first[lane] = collection.first[0];
      collection.second[lane] = collection.second[0];
    }
    const unsigned touching = simd::first_lanes<lanes>(number);
    Lanes& next = batch.lanes[batch.count];
    ContactGeometry<Lanes> geometry;
    find_touching<of_walls>(geometry, collection.first.data(), collection.second.data(), next);
    compute<of_walls>(geometry, collection.first.data(), collection.second.data(), touching, next);
    std::copy_n(collection.contacts.begin(), lanes, batch.contacts[batch.count].begin());
    add_to_batch(batch, collected, touching, results);
  }

  template <class Results>
  void add_to_batch(Batch& batch, std::uint32_t group, unsigned touching, Results& results) const {
    batch.touching[batch.count] = touching;
    batch.group[batch.count] = group;
    if (++batch.count == batch_size) flush(batch, results);
  }

  template <class Results>
  [[gnu::noinline]] void flush(Batch& batch, Results& results) const {
    for (Index e = 0; e < batch.count; ++e) {
      if (batch.group[e] != collected) {
        load_histories(batch.group[e], batch.lanes[e]);
      } else {
        load_histories(batch.contacts[e], batch.lanes[e]);
      }
    }
    evaluate_(batch.lanes.data(), batch.count, batch.touching.data(), batch.contacts.data());
    for (Index e = 0; e < batch.count; ++e) {
      if (batch.group[e] != collected) {
        results.store_group(batch.group[e], batch.lanes[e], batch.touching[e]);
      } else {
        const auto count = static_cast<Index>(std::popcount(batch.touching[e]));
        results.store_contacts(batch.contacts[e], count, batch.lanes[e]);
      }
    }
    batch.count = 0;
  }

  [[gnu::always_inline]] void load_histories(Index group, Lanes& into) const {
    constexpr int N = Grains::N;
    const unsigned known = input_.before.touching_in_group(group);
    const Real* const from = input_.before.group(group);
    for (int k = 0; k < Lanes::words; ++k) {
      const auto fresh = simd::broadcast<Real, N>(new_history_.numbers[k]);
      for (int first = 0; first < lanes; first += N) {
        const auto kept = simd::load<Real, N>(from + k * lanes + first);
        simd::store<Real, N>(into.history[k] + first,
                             simd::select<Real, N>(known >> first, kept, fresh));
      }
    }
  }
  [[gnu::always_inline]] void load_histories(const EightNumbers& contacts, Lanes& into) const {
    for (Index lane = 0; lane < lanes; ++lane) {
      const bool is_known = input_.before.touches(contacts[lane]);
      for (int k = 0; k < Lanes::words; ++k) {
        into.history[k][lane] =
            is_known ? input_.before.at(contacts[lane], k) : new_history_.numbers[k];
      }
    }
  }

  // The first contact in the lanes `refused` is too deep. The geometry is computed again, because
  // one that is passed to a function cannot be kept in registers.
  template <bool of_walls>
  [[noreturn, gnu::cold, gnu::noinline]] void refuse(const std::uint32_t* first,
                                                     const std::uint32_t* second,
                                                     unsigned refused) const {
    const auto lane = static_cast<Index>(std::countr_zero(refused));
    const Index i = ContactList::unscaled(first[lane]);
    const Index other = ContactList::unscaled(second[lane]);
    const Where where{.particle = i, .id = input_.contacts.id(i)};
    Lanes unused;
    ContactGeometry<Lanes> geometry;
    find_touching<of_walls>(geometry, first, second, unused);
    DeepContact<Real> contact;
    std::string names;
    if constexpr (of_walls) {
      contact = geometry.deep_contact_at_wall(lane);
      names = "grain " + std::to_string(*where.id) + " and wall " +
              std::to_string(input_.walls.number_of(other));
    } else {
      contact = geometry.deep_contact(lane);
      names = "grains " + std::to_string(*where.id) + " and " +
              std::to_string(input_.contacts.id(other));
    }
    if (!contact.has_normal) {
      fail({"dem::Contacts: the centres of ", names, " coincide; place them apart"}, where);
    }
    fail({"dem::Contacts: ", names, " overlap by ", contact.overlap,
          " m, more than max_overlap = ", input_.max_overlap, " of the radius ", contact.radius,
          " m; place them apart, use a stiffer material or a shorter time step, or raise "
          "ContactSettings::max_overlap"},
         where);
  }

  // The history of a new contact.
  struct NewHistory {
    Real numbers[std::max(Lanes::words, 1)] = {};
    NewHistory() {
      if constexpr (Lanes::words > 0) Histories::LawHistory::put({}, numbers);
    }
  };

  Input input_;
  const Evaluate& evaluate_;
  NewHistory new_history_;
};

}  // namespace silt::dem::detail
