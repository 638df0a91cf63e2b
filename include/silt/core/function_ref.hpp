// SPDX-License-Identifier: MIT
// A reference to a function object, for functions that are compiled once instead of once for each
// function object that is passed to them. A call costs as much as one of a function pointer: suited
// for work on many particles, not for that on one.
#pragma once

#include <type_traits>

namespace silt {

/// A reference to any object that can be called like a function Result(Arguments…).
template <class Signature>
class FunctionRef;

/// Refers to an object that can be called with these arguments, and must outlive the reference.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
 public:
  /// Refers to this object, which is no plain function; no copy is made.
  template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> &&
             !std::is_function_v<std::remove_reference_t<F>> &&
             requires(F& function, Arguments&&... arguments) {
               function(static_cast<Arguments&&>(arguments)...);
             })
  FunctionRef(F&& function) noexcept
      : object_(const_cast<void*>(static_cast<const void*>(&function))),
        call_(&call<std::remove_reference_t<F>>) {}

  Result operator()(Arguments... arguments) const {
    return call_(object_, static_cast<Arguments&&>(arguments)...);
  }

 private:
  template <class F>
  static Result call(void* object, Arguments... arguments) {
    if constexpr (std::is_void_v<Result>) {
      (*static_cast<F*>(object))(static_cast<Arguments&&>(arguments)...);
    } else {
      return (*static_cast<F*>(object))(static_cast<Arguments&&>(arguments)...);
    }
  }

  void* object_;
  Result (*call_)(void*, Arguments...);
};

}  // namespace silt
