// SPDX-License-Identifier: MIT
// Memory that an object uses again from step to step.
#pragma once

#include <memory>

namespace silt::detail {

/// A T that only saves time: a copy of its owner has a new one.
template <class T>
class OwnMemory {
 public:
  OwnMemory() = default;
  OwnMemory(OwnMemory&&) noexcept = default;
  OwnMemory& operator=(OwnMemory&&) noexcept = default;
  OwnMemory(const OwnMemory&) {}
  OwnMemory& operator=(const OwnMemory&) {
    memory_.reset();
    return *this;
  }
  ~OwnMemory() = default;

  T* operator->() {
    if (!memory_) memory_ = std::make_unique<T>();
    return memory_.get();
  }
  /// nullptr if nothing was kept.
  T* get() noexcept { return memory_.get(); }
  const T* get() const noexcept { return memory_.get(); }

 private:
  std::unique_ptr<T> memory_;
};

}  // namespace silt::detail
