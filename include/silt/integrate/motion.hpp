// SPDX-License-Identifier: MIT
// The equations of motion of the leapfrog, [SahChoi2004] (15)–(33).
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_INTEGRATE_MOTION
#define SILT_INTEGRATE_MOTION

#include <silt/core/instruction_set.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/damping.hpp>
#include <silt/integrate/motion_in_columns.hpp>
#include <silt/integrate/motion_in_rows.hpp>

#include <optional>
#include <type_traits>

namespace silt::detail {

/// The fields of particles before a step and after it: in rows if the particles are stored in them
/// and a register holds four numbers, else in columns, which is then faster.
template <class P>
struct FieldsOfMotion {
  /// Begins a step.
  explicit FieldsOfMotion(P& particles);

  struct NoRows {};
  std::optional<MotionInColumns<P>> columns;
  std::optional<std::conditional_t<in_rows_of_four<P>(), RowsOfMotion<P>, NoRows>> rows;
};

// What a step does to each particle; the equations are below, in MotionOf.

/// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33).
template <class D>
struct Kick {
  D damping;
  double dt = 0;  ///< [s]
};
/// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28).
template <class D>
struct KickToMean {
  D damping;
  double dt = 0;  ///< [s]
};
/// v^N → v^{N−½}.
template <class D>
struct StepBack {
  D damping;
  double dt = 0;  ///< [s]
};
// clang 14 does not deduce the arguments of aggregates.
template <class D>
Kick(D, double) -> Kick<D>;
template <class D>
KickToMean(D, double) -> KickToMean<D>;
template <class D>
StepBack(D, double) -> StepBack<D>;
/// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
struct Drift {
  double dt = 0;  ///< [s]
};

}  // namespace silt::detail

#define SILT_KERNELS <silt/integrate/motion.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

template <class P>
FieldsOfMotion<P>::FieldsOfMotion(P& particles) {
  if constexpr (in_rows_of_four<P>()) {
    if (SILT_FOR_PROCESSOR(is_motion_in_rows<P>)()) {
      rows.emplace(particles);
      return;
    }
  }
  columns.emplace(particles);
}

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {

// See FieldsOfMotion.
template <class P>
inline constexpr bool moves_in_rows =
    in_rows_of_four<P>() && 4 * sizeof(typename P::Real) <= silt::simd::SILT_INSTRUCTION_SET::width;
template <class P>
bool is_motion_in_rows() {
  return moves_in_rows<P>;
}
template <class P>
using MotionInStorage = std::conditional_t<moves_in_rows<P>, MotionInRows<P>, MotionInColumns<P>>;

/// The motion of particles, from the fields before a step to those after it: MotionInRows or
/// MotionInColumns, with the equations that are the same in both.
template <class P>
class MotionOf : public MotionInStorage<P> {
  using Storage = MotionInStorage<P>;
  using Real = typename P::Real;

 public:
  using State = typename Storage::State;

  explicit MotionOf(const FieldsOfMotion<P>& fields) : Storage(form_of(fields)) {}

  template <class D>
  [[gnu::always_inline]] void change(State& p, const Kick<D>& by) const {
    Storage::change_velocities(
        p, [&](Real& v, Real a) { v = static_cast<Real>(by.damping.kicked(v, a, Real(by.dt))); });
  }
  template <class D>
  [[gnu::always_inline]] void change(State& p, const KickToMean<D>& by) const {
    Storage::change_velocities(
        p, [&](Real& v, Real a) { v = kicked_to_mean(by.damping, v, a, Real(by.dt)); });
  }
  template <class D>
  [[gnu::always_inline]] void change(State& p, const StepBack<D>& by) const {
    Storage::change_velocities(
        p, [&](Real& v, Real a) { v = half_step_back(by.damping, v, a, Real(by.dt)); });
  }
  [[gnu::always_inline]] void change(State& p, const Drift& by) const { Storage::drift(p, by.dt); }

 private:
  static const auto& form_of(const FieldsOfMotion<P>& fields) {
    if constexpr (moves_in_rows<P>) {
      return *fields.rows;
    } else {
      return *fields.columns;
    }
  }
};

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
