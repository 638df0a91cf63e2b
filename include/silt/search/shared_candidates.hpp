// SPDX-License-Identifier: MIT
// Candidates shared by the particles of one block (a few cells in a row): collected once and tested
// by each particle. In a dense block, candidates beyond the radius from the bounding box of the
// block, which no particle of the block can reach, are dropped:
//
//     . ┌─────────┐ .      x  dropped
//   x   │ o ┌───┐ │        o  kept
//       │   │i i│ │ o      i  of the block
//     x └───┴───┴─┘   x
//
// Positions are stored relative to the block and in single precision, so that a register tests
// twice as many. At such distances the rounding error of a position is smaller than the tolerance
// added to the radius. A candidate that passes the test is a neighbour, or is farther than the
// radius by a rounding error.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_SEARCH_SHARED_CANDIDATES
#define SILT_SEARCH_SHARED_CANDIDATES

#include <silt/core/buffer.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace silt {

namespace detail {
/// The candidates of a block as columns, and what is needed to test them.
template <int Dim, class Real>
struct CandidateColumns {
  simd::Columns<Dim, Real> x{};  // of all points, by slot
  const std::uint32_t* items = nullptr;
  Index first = 0;  // slots of the block
  Index last = 0;
  bool is_dense = false;
  std::array<Real, Dim> origin{};  // centre of the block
  std::array<float, Dim> half{};   // half its size
  float reach = 0;                 // squared
  Index own = 0;                   // index of the first slot of the block among the candidates
  Index count = 0;
  std::array<Buffer<float>, Dim> near_x;
  Buffer<std::uint32_t> near_items;
};
}  // namespace detail

}  // namespace silt

#define SILT_KERNELS <silt/search/shared_candidates.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt {

namespace detail {
/// Those of CandidatePacks for the instruction set.
template <int Dim, class Real>
struct CandidateFunctions {
  using Data = CandidateColumns<Dim, Real>;
  using Add = void(Data&, Index, Index);
  using Near = std::uint32_t*(const Data&, Index, std::uint32_t*);

  Add* add_all = SILT_FOR_PROCESSOR(CandidatePacks<Dim, Real>::add_all);
  Add* add_close = SILT_FOR_PROCESSOR(CandidatePacks<Dim, Real>::add_close);
  Near* near = SILT_FOR_PROCESSOR(CandidatePacks<Dim, Real>::template near<false>);
  Near* near_forward = SILT_FOR_PROCESSOR(CandidatePacks<Dim, Real>::template near<true>);
};
}  // namespace detail

/// The candidates of one block at a time.
template <int Dim, class Real>
class SharedCandidates {
  using Data = detail::CandidateColumns<Dim, Real>;

 public:
  using Columns = simd::Columns<Dim, Real>;

  /// Begins a block with the slots [first, last) of the columns x, whose particles are `items`.
  void begin(const Columns& x, const std::uint32_t* items, Index first, Index last, Real reach) {
    functions_ = {};  // chosen once for a block
    data_.x = x;
    data_.items = items;
    data_.first = first;
    data_.last = last;
    data_.count = 0;
    data_.reach = static_cast<float>(squared(double(reach)) * (1 + 0x1p-15));
    data_.is_dense = last - first >= dense;
    for (std::size_t k = 0; k < Dim; ++k) {
      Real lower = x[k][first];
      Real upper = lower;
      for (Index s = first + 1; data_.is_dense && s < last; ++s) {
        lower = std::min(lower, x[k][s]);
        upper = std::max(upper, x[k][s]);
      }
      data_.origin[k] = lower + (upper - lower) / 2;
      data_.half[k] = static_cast<float>(upper - lower) * (0.5f + 0x1p-20f);
    }
  }

  /// Adds the slots [first, last) as candidates, or those that may be near. A range that overlaps
  /// with the block must contain it.
  void add(Index first, Index last) {
    reserve(data_.count + (last - first) + 2 * simd::most_lanes<float>);
    const bool is_own = first <= data_.first && data_.first < last;
    if (!data_.is_dense) {
      if (is_own) data_.own = data_.count + (data_.first - first);
      functions_.add_all(data_, first, last);
    } else if (is_own) {
      functions_.add_close(data_, first, data_.first);
      data_.own = data_.count;
      functions_.add_close(data_, data_.first, last);
    } else {
      functions_.add_close(data_, first, last);
    }
  }

  /// Ends the block: there are no more candidates.
  void end() {
    // The last register is completed with points that are not near.
    reserve(data_.count + simd::most_lanes<float>);
    std::fill_n(data_.near_x[0].data() + data_.count, simd::most_lanes<float>,
                std::numeric_limits<float>::max());
  }

  Index size() const noexcept { return data_.count; }

  /// Writes the candidates near slot `slot` of the block, or only those after it (`forward`), to
  /// `to`, and returns their end. There must be space for all candidates and one more register.
  template <bool forward>
  std::uint32_t* near(Index slot, std::uint32_t* to) const {
    return (forward ? functions_.near_forward : functions_.near)(data_, slot, to);
  }

 private:
  // Number of particles from which testing the bounding box saves time.
  static constexpr Index dense = 24;

  void reserve(Index size) {
    if (size <= data_.near_items.size()) return;
    for (auto& x : data_.near_x) x.resize(2 * size);
    data_.near_items.resize(2 * size);
  }

  Data data_;
  detail::CandidateFunctions<Dim, Real> functions_;
};

}  // namespace silt

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// The loops over the candidates; see SharedCandidates.
template <int Dim, class Real>
class CandidatePacks {
  using Data = CandidateColumns<Dim, Real>;
  static constexpr int lanes = simd::lanes<Real>;
  using Lanes = simd::Pack<float, lanes>;

 public:
  template <bool forward>
  static std::uint32_t* near(const Data& of, Index slot, std::uint32_t* to) {
    constexpr int N = simd::lanes<float>;
    const Index own = of.own + (slot - of.first);
    const Index count = of.count;
    const std::uint32_t own_item = of.items[slot];
    const std::uint32_t* const items = of.near_items.data();
    std::array<const float*, Dim> x;
    struct {
      simd::Pack<float, N> x;
    } centre[Dim];
    for (std::size_t k = 0; k < Dim; ++k) {
      x[k] = of.near_x[k].data();
      centre[k].x = simd::broadcast<float, N>(x[k][own]);
    }
    const auto limit = simd::broadcast<float, N>(of.reach);
    const auto is_near = [&](Index s) {
      simd::Pack<float, N> r2{};
      for (std::size_t k = 0; k < Dim; ++k) {
        const simd::Pack<float, N> d = simd::load<float, N>(x[k] + s) - centre[k].x;
        r2 = k == 0 ? d * d : r2 + d * d;
      }
      return simd::less<float, N>(r2, limit);
    };
    Index s = 0;
    if (forward) {
      // All particles of a block begin at the same few registers: a loop whose length differs from
      // row to row would be mispredicted.
      s = (own + 1) / N * N;
      const simd::Mask after = ~simd::first_lanes<N>(own + 1 - s);
      to += simd::compress<std::uint32_t, N>(to, simd::load<std::uint32_t, N>(items + s),
                                             is_near(s) & after);
      s += N;
    }
    for (; s < count; s += N) {
      const auto item = simd::load<std::uint32_t, N>(items + s);
      simd::Mask mask = is_near(s);
      if (!forward) mask &= simd::differs<N>(item, own_item);
      to += simd::compress<std::uint32_t, N>(to, item, mask);
    }
    return to;
  }

  static void add_all(Data& of, Index first, Index last) {
    const auto x = of.x;
    const std::array<Real, Dim> origin = of.origin;
    std::uint32_t* const items = of.near_items.data() + of.count;
    std::array<float*, Dim> to;
    for (std::size_t k = 0; k < Dim; ++k) to[k] = of.near_x[k].data() + of.count;
    for (Index s = first; s < last; s += lanes) {
      for (std::size_t k = 0; k < Dim; ++k) {
        simd::store<float, lanes>(to[k] + (s - first), relative(x[k] + s, origin[k]));
      }
      simd::store<std::uint32_t, lanes>(items + (s - first),
                                        simd::load<std::uint32_t, lanes>(of.items + s));
    }
    of.count += last - first;
  }

  static void add_close(Data& of, Index first, Index last) {
    const auto x = of.x;
    const std::array<Real, Dim> origin = of.origin;
    const std::array<float, Dim> half = of.half;
    const auto limit = simd::broadcast<float, lanes>(of.reach);
    std::array<float*, Dim> to;
    for (std::size_t k = 0; k < Dim; ++k) to[k] = of.near_x[k].data();
    Index count = of.count;
    for (Index s = first; s < last; s += lanes) {
      struct {
        Lanes x;
      } offset[Dim];
      Lanes r2{};
      for (std::size_t k = 0; k < Dim; ++k) {
        offset[k].x = relative(x[k] + s, origin[k]);
        const Lanes outside = simd::abs<float, lanes>(offset[k].x) - half[k];
        const Lanes distance = outside > 0 ? outside : Lanes{};
        r2 += distance * distance;
      }
      const simd::Mask close =
          simd::less<float, lanes>(r2, limit) & simd::first_lanes<lanes>(last - s);
      for (std::size_t k = 0; k < Dim; ++k) {
        simd::compress<float, lanes>(to[k] + count, offset[k].x, close);
      }
      count += simd::compress<std::uint32_t, lanes>(
          of.near_items.data() + count, simd::load<std::uint32_t, lanes>(of.items + s), close);
    }
    of.count = count;
  }

 private:
  static Lanes relative(const Real* x, Real origin) {
    return __builtin_convertvector(simd::load(x) - origin, Lanes);
  }
};

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
