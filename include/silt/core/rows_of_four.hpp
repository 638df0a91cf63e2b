// SPDX-License-Identifier: MIT
// Rows of four numbers, as in {x y z R} of a grain: which particles are stored in them, and how
// they become packs, row by row or number by number.
//
// Included once for each instruction set, see each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_CORE_ROWS_OF_FOUR
#define SILT_CORE_ROWS_OF_FOUR

#include <silt/core/fields.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <type_traits>
#include <utility>

namespace silt {

/// Whether the particles are stored in these rows, see Bundle in core/field_storage.hpp:
/// {position, a scalar, velocity, mass} and {spin, inertia}; in 2D {position, a scalar, mass,
/// velocity, spin, inertia}, and they have a force and a torque. `Mass` is the field in the place
/// of the mass.
template <class P, class Mass = mass_t>
constexpr bool in_rows_of_four() {
  if constexpr (requires(const P p) {
                  p.storage(position).rows();
                  p.storage(spin).rows();
                  p.storage(force);
                  p.storage(torque);
                }) {
    using Linear = std::remove_cvref_t<decltype(std::declval<const P&>().storage(position))>;
    using Angular = std::remove_cvref_t<decltype(std::declval<const P&>().storage(spin))>;
    if constexpr (Linear::template has<velocity_t> && Linear::template has<Mass> &&
                  Angular::template has<inertia_t> && Linear::width == 8) {
      constexpr bool is_linear =
          Linear::template offset<position_t> == 0 && Linear::template offset<velocity_t> == 4;
      if constexpr (P::dimension == 2) {
        return is_linear && std::same_as<Linear, Angular> && Linear::template offset<Mass> == 3 &&
               Linear::template offset<spin_t> == 6 && Linear::template offset<inertia_t> == 7;
      } else {
        return is_linear && Linear::template offset<Mass> == 7 && Angular::width == 4 &&
               Angular::template offset<spin_t> == 0 && Angular::template offset<inertia_t> == 3;
      }
    }
  }
  return false;
}

/// The same with the radius after the position, as in dem::Grains.
template <class P, class Mass = mass_t>
constexpr bool in_rows_with_radius() {
  if constexpr (in_rows_of_four<P, Mass>()) {
    using Linear = std::remove_cvref_t<decltype(std::declval<const P&>().storage(position))>;
    if constexpr (Linear::template has<radius_t>) {
      return Linear::template offset<radius_t> == P::dimension;
    }
  }
  return false;
}

}  // namespace silt

#define SILT_KERNELS <silt/core/rows_of_four.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::simd::SILT_INSTRUCTION_SET {

// One or two rows in a pack, which is passed by reference, because how it is returned depends on the
// processor flags. Where `Pack` has only four numbers, the second row is not used.

/// Whether Pack has eight numbers.
template <class Pack>
inline constexpr bool is_two_fours = sizeof(Pack) == 8 * sizeof(std::declval<Pack>()[0]);

/// Reads four numbers at `first`, and for a pack of eight four more at `second`.
template <class Real, class Pack>
void load_fours(const Real* first, [[maybe_unused]] const Real* second, Pack& to) {
  if constexpr (is_two_fours<Pack>) {
    Four<Real> a, b;
    load_pack(first, a);
    load_pack(second, b);
    to = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    load_pack(first, to);
  }
}
/// Three numbers and 0 each.
template <class Real, class Pack>
void load_threes(const Real* first, [[maybe_unused]] const Real* second, Pack& to) {
  if constexpr (is_two_fours<Pack>) {
    Four<Real> a, b;
    load_three(first, a);
    load_three(second, b);
    to = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  } else {
    load_three(first, to);
  }
}
/// Writes the first four numbers to `first`, and those after them, if there are any, to `second`.
template <class Real, class Pack>
void store_fours(const Pack& p, Real* first, [[maybe_unused]] Real* second) {
  if constexpr (is_two_fours<Pack>) {
    store<Real, 4>(first, __builtin_shufflevector(p, p, 0, 1, 2, 3));
    store<Real, 4>(second, __builtin_shufflevector(p, p, 4, 5, 6, 7));
  } else {
    store<Real, 4>(first, p);
  }
}
/// Lanes i, j, k and l of each four, where 0 to 3 are those of a and 4 to 7 those of b.
template <int i, int j, int k, int l, class Pack>
void shuffle_fours(const Pack& a, const Pack& b, Pack& to) {
  if constexpr (is_two_fours<Pack>) {
    constexpr int first[] = {i + i / 4 * 4, j + j / 4 * 4, k + k / 4 * 4, l + l / 4 * 4};
    to = __builtin_shufflevector(a, b, first[0], first[1], first[2], first[3], first[0] + 4,
                                 first[1] + 4, first[2] + 4, first[3] + 4);
  } else {
    to = __builtin_shufflevector(a, b, i, j, k, l);
  }
}

/// 1/x of the fourth number of each four of a and b, in all lanes of that four; by one division in
/// as few lanes as possible.
template <class Pack>
void inverse_of_fourths(const Pack& a, const Pack& b, Pack& of_a, Pack& of_b) {
  if constexpr (is_two_fours<Pack>) {
    const auto inverse = 1 / __builtin_shufflevector(a, b, 3, 11, 7, 15);
    of_a = __builtin_shufflevector(inverse, inverse, 0, 0, 0, 0, 2, 2, 2, 2);
    of_b = __builtin_shufflevector(inverse, inverse, 1, 1, 1, 1, 3, 3, 3, 3);
  } else if constexpr (sizeof(Pack) == 32) {
    const auto inverse = 1 / __builtin_shufflevector(a, b, 3, 7);
    of_a = __builtin_shufflevector(inverse, inverse, 0, 0, 0, 0);
    of_b = __builtin_shufflevector(inverse, inverse, 1, 1, 1, 1);
  } else {
    const Pack inverse = 1 / __builtin_shufflevector(a, b, 3, 7, 3, 7);
    of_a = __builtin_shufflevector(inverse, inverse, 0, 0, 0, 0);
    of_b = __builtin_shufflevector(inverse, inverse, 1, 1, 1, 1);
  }
}
/// Sets the second of two fours to zero.
template <class Pack>
void keep_first_four(Pack& p) {
  static_assert(is_two_fours<Pack>);
  p = __builtin_shufflevector(p, Pack{}, 0, 1, 2, 3, 8, 9, 10, 11);
}

/// Transposes four numbers of each of N rows into columns: each lane of to[k] is number k of row
/// from(lane). Used to read data that are contiguous per grain in a loop over contacts, which takes
/// a third of the time of gather loads. Rows, or halves of them, are loaded into the lanes where
/// they are needed, because a processor shuffles registers at half the rate of such loads.
template <class Real, int N, class From>
[[gnu::always_inline]] inline void columns_from(From&& from, Pack<Real, N> (&to)[4]) {
  static_assert(N == 2 || N == 4 || N == 8);
  using Part = typename UnalignedPackOf<Real, N == 8 ? 4 : 2>::type;
  const auto part = [&](int row, int k) -> const Part& {
    return *reinterpret_cast<const Part*>(from(row) + k);
  };
  if constexpr (N == 2) {
    for (int k = 0; k < 4; k += 2) {
      to[k] = __builtin_shufflevector(part(0, k), part(1, k), 0, 2);
      to[k + 1] = __builtin_shufflevector(part(0, k), part(1, k), 1, 3);
    }
  } else if constexpr (N == 4) {
    for (int k = 0; k < 4; k += 2) {
      const Four<Real> even = __builtin_shufflevector(part(0, k), part(2, k), 0, 1, 2, 3);
      const Four<Real> odd = __builtin_shufflevector(part(1, k), part(3, k), 0, 1, 2, 3);
      to[k] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
      to[k + 1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
    }
  } else if constexpr (N == 8) {
    const auto rows = [&](int lower, int upper, Pack<Real, 8>& both) {
      both = __builtin_shufflevector(part(lower, 0), part(upper, 0), 0, 1, 2, 3, 4, 5, 6, 7);
    };
    Pack<Real, 8> a, b, c, d;
    rows(0, 2, a);
    rows(1, 3, b);
    rows(4, 6, c);
    rows(5, 7, d);
    const auto a_b_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto a_b_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const auto c_d_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const auto c_d_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    to[0] = __builtin_shufflevector(a_b_even, c_d_even, 0, 1, 4, 5, 8, 9, 12, 13);
    to[1] = __builtin_shufflevector(a_b_odd, c_d_odd, 0, 1, 4, 5, 8, 9, 12, 13);
    to[2] = __builtin_shufflevector(a_b_even, c_d_even, 2, 3, 6, 7, 10, 11, 14, 15);
    to[3] = __builtin_shufflevector(a_b_odd, c_d_odd, 2, 3, 6, 7, 10, 11, 14, 15);
  }
}

/// Transposes four columns into four numbers of each of eight rows, `stride` Reals apart.
template <class Real>
[[gnu::always_inline]] inline void rows_from(const Real (*from)[8], Real* to, int stride) {
  if constexpr (lanes<Real> >= 8) {
    using Eight = Pack<Real, 8>;
    const auto column = [=](int k) { return load<Real, 8>(from[k]); };
    const auto put_two = [&](int row, const Eight& rows) {
      Real* const numbers = to + row * stride;
      store<Real, 4>(numbers, __builtin_shufflevector(rows, rows, 0, 1, 2, 3));
      store<Real, 4>(numbers + 4 * stride, __builtin_shufflevector(rows, rows, 4, 5, 6, 7));
    };
    const Eight a = column(0), b = column(1), c = column(2), d = column(3);
    const Eight a_b_even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const Eight a_b_odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const Eight c_d_even = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const Eight c_d_odd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    put_two(0, __builtin_shufflevector(a_b_even, c_d_even, 0, 1, 8, 9, 4, 5, 12, 13));
    put_two(1, __builtin_shufflevector(a_b_odd, c_d_odd, 0, 1, 8, 9, 4, 5, 12, 13));
    put_two(2, __builtin_shufflevector(a_b_even, c_d_even, 2, 3, 10, 11, 6, 7, 14, 15));
    put_two(3, __builtin_shufflevector(a_b_odd, c_d_odd, 2, 3, 10, 11, 6, 7, 14, 15));
  } else if constexpr (lanes<Real> == 4) {
    using Numbers = Pack<Real, 4>;
    for (int lane = 0; lane < 8; lane += 4) {
      const auto column = [=](int k) { return load<Real, 4>(from[k] + lane); };
      const auto put = [&](int row, const Numbers& numbers) {
        store<Real, 4>(to + (lane + row) * stride, numbers);
      };
      const Numbers a = column(0), b = column(1), c = column(2), d = column(3);
      const Numbers a_b_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
      const Numbers a_b_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const Numbers c_d_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
      const Numbers c_d_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      put(0, __builtin_shufflevector(a_b_even, c_d_even, 0, 1, 4, 5));
      put(1, __builtin_shufflevector(a_b_odd, c_d_odd, 0, 1, 4, 5));
      put(2, __builtin_shufflevector(a_b_even, c_d_even, 2, 3, 6, 7));
      put(3, __builtin_shufflevector(a_b_odd, c_d_odd, 2, 3, 6, 7));
    }
  } else {
    for (int lane = 0; lane < 8; lane += 2) {
      for (int k = 0; k < 4; k += 2) {
        const auto a = load<Real, 2>(from[k] + lane);
        const auto b = load<Real, 2>(from[k + 1] + lane);
        Real* const numbers = to + lane * stride + k;
        store<Real, 2>(numbers, __builtin_shufflevector(a, b, 0, 2));
        store<Real, 2>(numbers + stride, __builtin_shufflevector(a, b, 1, 3));
      }
    }
  }
}

}  // namespace silt::simd::SILT_INSTRUCTION_SET

#endif
