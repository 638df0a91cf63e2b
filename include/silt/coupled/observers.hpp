// SPDX-License-Identifier: MIT
// Observers of one of the two simulations of Coupled.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/run.hpp>
#include <silt/core/transfer.hpp>

#include <type_traits>
#include <utility>

namespace silt::coupled {

namespace detail {

struct GrainsOf {
  template <class Both>
  static auto& in(Both& both) {
    return both.grains();
  }
};
struct FluidOf {
  template <class Both>
  static auto& in(Both& both) {
    return both.fluid();
  }
};

template <class Which, class O>
class ObserverOfOne {
  template <class Both>
  using One = std::remove_reference_t<decltype(Which::in(std::declval<Both&>()))>;

 public:
  explicit ObserverOfOne(O observer) : inner_(std::move(observer)) {}

  const O& observer() const noexcept { return inner_; }

  template <class Both>
    requires ObservesOutputs<O, One<Both>>
  void operator()(const Both& both) {
    inner_(Which::in(both));
  }
  template <class Both>
    requires ActsBeforeSteps<O, One<Both>>
  void before_step(Both& both) {
    inner_.before_step(Which::in(both));
  }
  template <class Both>
    requires ObservesSteps<O, One<Both>>
  void after_step(const Both& both, const Run& run) {
    inner_.after_step(Which::in(both), run);
  }
  template <class Both>
    requires ActsBetweenSteps<O, One<Both>>
  void between_steps(const Both& both) {
    inner_.between_steps(Which::in(both));
  }
  bool stop_requested()
    requires EndsRuns<O>
  {
    return inner_.stop_requested();
  }
  template <class Archive>
    requires Transferable<O, Archive>
  void transfer(Archive& archive) {
    inner_.transfer(archive);
  }

 private:
  O inner_;
};

}  // namespace detail

/// Observer of Coupled: an observer of the grains, called before and after each step of the flow.
template <class Observer>
struct OfGrains : detail::ObserverOfOne<detail::GrainsOf, Observer> {
  using detail::ObserverOfOne<detail::GrainsOf, Observer>::ObserverOfOne;
};
template <class Observer>
OfGrains(Observer) -> OfGrains<Observer>;

/// The same of the fluid.
template <class Observer>
struct OfFluid : detail::ObserverOfOne<detail::FluidOf, Observer> {
  using detail::ObserverOfOne<detail::FluidOf, Observer>::ObserverOfOne;
};
template <class Observer>
OfFluid(Observer) -> OfFluid<Observer>;

}  // namespace silt::coupled
