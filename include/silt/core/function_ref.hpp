// SPDX-License-Identifier: MIT
// A reference to a function object, for functions that are compiled once instead of once for each
// function object that is passed to them. A call costs as much as one of a function pointer: suited
// for work on many particles, not for that on one.
#pragma once

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

namespace silt {

/// A reference to any object that can be called like a function Result(Arguments…).
template <class Signature>
class FunctionRef;

/// Refers to an object that can be called with these arguments, and must outlive the reference.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  /// Refers to this object; no copy is made.
  template <class F>
    requires(!std::same_as<std::remove_cvref_t<F>, FunctionRef> &&
             std::is_invocable_r_v<Result, F&, Arguments...>)
  FunctionRef(F&& function) noexcept
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* object, Arguments... arguments) -> Result {
          return (*static_cast<std::remove_reference_t<F>*>(object))(
              std::forward<Arguments>(arguments)...);
        }) {}

  Result operator()(Arguments... arguments) const {
    return call_(object_, std::forward<Arguments>(arguments)...);
  }

 private:
  void* object_;
  Result (*call_)(void*, Arguments...);
};

}  // namespace silt
