// SPDX-License-Identifier: MIT
// The friction of a particle with its neighbours, see PairFriction.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_MPS_POLICY_FRICTION_OF_PAIRS
#define SILT_MPS_POLICY_FRICTION_OF_PAIRS

#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>

#include <algorithm>

namespace silt::mps {

/// The strain of the flow around a particle, and a_i/2: in fours of numbers, the rates of strain,
/// lower half of a symmetric matrix, and the share.
template <int Dim, class Real>
struct StrainForFriction {
  static constexpr int place_of_share = Dim * (Dim + 1) / 2;  ///< in the numbers
  static constexpr int size = (place_of_share + 4) / 4 * 4;   ///< a multiple of four
  /// Place of a rate, b ≤ a.
  static constexpr int place(int a, int b) { return a * (a + 1) / 2 + b; }

  Real numbers[size] = {};

  Real& rate(int a, int b) { return numbers[place(a, b)]; }  ///< [1/s]
  Real& share() { return numbers[place_of_share]; }          ///< [-]
  Real share() const { return numbers[place_of_share]; }
  /// A share of which no sum with another one is positive.
  void set_unknown() {
    std::fill_n(numbers, size, Real(0));
    share() = -1;
  }
  /// Whether it is none of these.
  bool is_known() const { return share() >= 0; }
};

}  // namespace silt::mps

#define SILT_KERNELS_UP_TO_AVX2
#define SILT_KERNELS <silt/mps/policy/friction_of_pairs.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::mps::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// The sum of the δu_i of PairFriction over the neighbours of a particle, times n0/d [m/s], from
/// the strains of all particles.
template <int Dim, class Real, class View>
[[gnu::flatten, gnu::noinline]] Vec<Dim, Real> friction_of_pairs(
    const View& at, const StrainForFriction<Dim, Real>* strains) {
  using Strain = StrainForFriction<Dim, Real>;
  const Index i = at.index();
  const Strain& own = strains[i];
  const auto u = at.velocities();
  const Vec<Dim, Real> u_i = at.velocity();
  FourVectors<Dim, Real> change{};
  NeighbourPack<Dim, Real>::for_each(at.neighbourhood(), i, [&](const auto& j) {
    Four<Real> others[Strain::size / 4][4];
    for (int k = 0; k < Strain::size / 4; ++k) {
      simd::columns_from<Real, 4>([&](int lane) { return strains[j.index[lane]].numbers + 4 * k; },
                                  others[k]);
    }
    const auto of_others = [&](int place) -> const Four<Real>& {
      return others[place / 4][place % 4];
    };
    FourVectors<Dim, Real> u_j{};
    j.get(u, u_j);
    Four<Real> along{}, linear{};
    for (int a = 0; a < Dim; ++a) {
      along += (u_j[a] - u_i[a]) * j.r_ij[a];
      for (int b = 0; b <= a; ++b) {
        const int place = Strain::place(a, b);
        linear += (of_others(place) + own.numbers[place]) * (j.r_ij[a] * j.r_ij[b]);
      }
    }
    const Four<Real> none{};
    const Four<Real> least = along < none ? along : none, most = along < none ? none : along;
    const Four<Real> bounded = linear < least ? least : (most < linear ? most : linear);
    const Four<Real> shares = of_others(Strain::place_of_share) + own.share();
    Four<Real> factor = (shares > none ? shares : none) * j.weight_over_square * (along - bounded);
    if constexpr (!View::have_equal_volumes) {
      for (int lane = 0; lane < 4; ++lane) factor[lane] *= at.of_pair(j.index[lane]);
    }
    for (int a = 0; a < Dim; ++a) change[a] += factor * j.r_ij[a];
  });
  Vec<Dim, Real> sum;
  for (int a = 0; a < Dim; ++a) sum[a] = sum_of(change[a]);
  return sum;
}

}  // namespace silt::mps::SILT_INSTRUCTION_SET

#endif
