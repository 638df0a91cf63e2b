// SPDX-License-Identifier: MIT
// The integrator's part of a step for a range of particles.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/motion.hpp>
#include <silt/integrate/outcome_of_step.hpp>

namespace silt::detail {

/// Calls update(motion, particle) for the particles of a range. Its type does not depend on that of
/// `update`, so that the loop over the forces, which takes long to compile, is compiled only once.
template <class P>
class UpdateOfRange {
 public:
  /// The function must outlive this object.
  template <class Function>
  explicit UpdateOfRange(const Function& update) : update_(&update), run_(run<Function>) {}

  OutcomeOfRange<P> operator()(const MotionOf<P>& motion, Index first, Index last) const {
    return run_(update_, motion, first, last);
  }

 private:
  // Copies, so that the compiler knows that no store changes them.
  template <class Function>
  [[gnu::flatten, gnu::noinline]] static OutcomeOfRange<P> run(const void* from,
                                                               const MotionOf<P>& of, Index first,
                                                               Index last) {
    const Function update = *static_cast<const Function*>(from);
    const MotionOf<P> motion = of;
    typename MotionOf<P>::Outcome outcome;
    const auto update_from = [&](Index i) {
      auto particle = motion.load(i, last);
      motion.begin(outcome, particle);
      update(motion, particle);
      motion.end(outcome, particle);
      motion.store(i, last, particle);
    };
    if constexpr (MotionOf<P>::is_in_rows) {
      for (Index i = first; i < last; i += MotionOf<P>::at_once) update_from(i);
    } else {
      SILT_INDEPENDENT_ITERATIONS
      for (Index i = first; i < last; ++i) update_from(i);
    }
    return {outcome.is_valid(motion), outcome.squared_displacement(), outcome.energies()};
  }

  const void* update_;
  OutcomeOfRange<P> (*run_)(const void*, const MotionOf<P>&, Index, Index);
};

}  // namespace silt::detail
