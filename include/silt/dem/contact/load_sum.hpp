// SPDX-License-Identifier: MIT
// The sums of the forces and torques of contacts on a grain, [SahChoi2004] (13), (14).
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_LOAD_SUM
#define SILT_DEM_CONTACT_LOAD_SUM

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/load_row.hpp>

#define SILT_KERNELS <silt/dem/contact/load_sum.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Σ F and Σ M on one grain. On the second of two grains the force is the opposite; the torque,
/// (R − arm_reduction) F × n, is in the same direction on both.
template <int Dim, class Real, bool has_couple>
class LoadSum {
  using Row = LoadRow<Dim, has_couple>;
  // Force and torque in one register, or the torque in a second one.
  static constexpr bool is_one_pack = Dim == 2 || 8 * sizeof(Real) <= simd::width;
  static constexpr int N = Dim == 3 && is_one_pack ? 8 : 4;
  using Pack = simd::Pack<Real, N>;

 public:
  explicit LoadSum(Real R) : R_(R) {
    for (int second = 0; second < 2; ++second) {
      const Real sign = second == 0 ? 1 : -1;
      if constexpr (!is_one_pack) {
        factors_[second] = Pack{sign, sign, sign, 0};
      } else if constexpr (Dim == 2) {
        factors_[second] = Pack{sign, sign, R, 0};
      } else {
        factors_[second] = Pack{sign, sign, sign, 0, R, R, R, 0};
      }
    }
  }

  /// Adds the row of a contact; `second`: 1 if the grain is the second one, 0 if it is the first.
  [[gnu::always_inline]] void add(const Real* row, unsigned second) {
    const Pack zero{};
    // Not simd::load(), because how packs are returned depends on the processor flags.
    const Pack load = *reinterpret_cast<const typename simd::UnalignedPackOf<Real, N>::type*>(row);
    if constexpr (Dim == 2) {
      sum_ += load * (factors_[second] - __builtin_shufflevector(load, zero, 4, 4, 3, 4));
    } else if constexpr (is_one_pack) {
      sum_ +=
          load * (factors_[second] - __builtin_shufflevector(load, zero, 8, 8, 8, 8, 3, 3, 3, 8));
    } else {
      sum_ += load * factors_[second];
      Four<Real> F_x_n;
      simd::load_pack(row + Row::F_x_n, F_x_n);
      moment_ += (R_ - row[Row::arm_reduction]) * F_x_n;
    }
    if constexpr (has_couple) {
      Four<Real> couple;
      simd::load_pack(row + Row::couple, couple);
      couple_ += (second == 0 ? Real(1) : Real(-1)) * couple;
    }
  }

  template <class Force, class Torque>
  [[gnu::always_inline]] void add_to(Force& force, Torque& torque) const {
    for (int k = 0; k < Dim; ++k) force[k] += sum_[k];
    for (int k = 0; k < angular_size<Dim>; ++k) {
      Real M;
      if constexpr (is_one_pack) {
        M = sum_[Row::F_x_n + k];
      } else {
        M = moment_[k];
      }
      if constexpr (has_couple) M += couple_[k];
      component(torque, k) += M;
    }
  }

 private:
  Pack factors_[2];
  Real R_;
  Pack sum_{};
  Four<Real> moment_{};
  Four<Real> couple_{};
};

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
