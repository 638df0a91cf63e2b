// SPDX-License-Identifier: MIT
// The integrator's part of a step for a range of particles.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_INTEGRATE_UPDATE_OF_RANGE
#define SILT_INTEGRATE_UPDATE_OF_RANGE

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/motion.hpp>
#include <silt/integrate/outcome_of_step.hpp>

#include <tuple>

#define SILT_KERNELS <silt/integrate/update_of_range.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

/// Changes the particles of a range by Kick, Drift, … Its type does not depend on these, so that
/// the loop over the forces, which takes long to compile, is compiled only once.
template <class P>
class UpdateOfRange {
 public:
  /// The changes must outlive this object.
  template <class... Changes>
  explicit UpdateOfRange(const std::tuple<Changes...>& changes)
      : changes_(&changes), run_(SILT_FOR_PROCESSOR(update_range<P, Changes...>)) {}

  OutcomeOfRange operator()(const FieldsOfMotion<P>& fields, Index first, Index last) const {
    return run_(changes_, fields, first, last);
  }

 private:
  const void* changes_;
  OutcomeOfRange (*run_)(const void*, const FieldsOfMotion<P>&, Index, Index);
};

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {

// Copies, so that the compiler knows that no store changes them.
template <class P, class... Changes>
[[gnu::flatten, gnu::noinline]] OutcomeOfRange update_range(const void* from,
                                                            const FieldsOfMotion<P>& fields,
                                                            Index first, Index last) {
  using Motion = MotionOf<P>;
  const auto changes = *static_cast<const std::tuple<Changes...>*>(from);
  const Motion motion(fields);
  typename Motion::Outcome outcome;
  const auto update_from = [&](Index i) {
    auto particle = motion.load(i, last);
    motion.begin(outcome, particle);
    std::apply([&](const auto&... each) { (motion.change(particle, each), ...); }, changes);
    motion.end(outcome, particle);
    motion.store(i, last, particle);
  };
  if constexpr (Motion::is_in_rows) {
    for (Index i = first; i < last; i += Motion::at_once) update_from(i);
  } else {
    SILT_INDEPENDENT_ITERATIONS
    for (Index i = first; i < last; ++i) update_from(i);
  }
  return {outcome.is_valid(motion), double(outcome.squared_displacement()), outcome.energy_before(),
          outcome.energy_after()};
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
