// SPDX-License-Identifier: MIT
// Type-erased Touches: their dimension and precision are known only when grains are given.
#pragma once

#include <silt/core/types.hpp>

#include <array>
#include <type_traits>
#include <utility>

namespace silt::dem {

namespace detail {
// Touches of one type, or none yet. Operations are instantiated together with get<T>(), so that
// unused dimensions and precisions are not compiled.
class TouchesOnDemand {
 public:
  TouchesOnDemand() = default;
  TouchesOnDemand(const TouchesOnDemand& other) : ways_(other.ways_) {
    if (other.touches_ != nullptr) touches_ = ways_->copy(other.touches_);
  }
  TouchesOnDemand(TouchesOnDemand&& other) noexcept { swap(other); }
  TouchesOnDemand& operator=(TouchesOnDemand other) noexcept {
    swap(other);
    return *this;
  }
  ~TouchesOnDemand() {
    if (touches_ != nullptr) ways_->destroy(touches_);
  }

  /// T is the same at every call.
  template <class T>
  T& get() {
    if (touches_ == nullptr) {
      touches_ = new T;
      ways_ = &ways_of<T>;
    }
    return *static_cast<T*>(touches_);
  }
  template <class T>
  const T& get() const {
    if (touches_ != nullptr) return *static_cast<const T*>(touches_);
    static const T none;
    return none;
  }

  Index count() const noexcept { return touches_ != nullptr ? ways_->count(touches_) : 0; }

  void save() noexcept {
    if (touches_ != nullptr) ways_->save(touches_);
  }
  void restore() noexcept {
    if (touches_ != nullptr) ways_->restore(touches_);
  }

 private:
  struct Ways {
    void* (*copy)(const void*);
    void (*destroy)(void*) noexcept;
    Index (*count)(const void*) noexcept;
    void (*save)(void*) noexcept;
    void (*restore)(void*) noexcept;
  };
  template <class T>
  static constexpr Ways ways_of{
      .copy = [](const void* all) -> void* { return new T(*static_cast<const T*>(all)); },
      .destroy = [](void* all) noexcept { delete static_cast<T*>(all); },
      .count = [](const void* all) noexcept { return static_cast<const T*>(all)->seen().count; },
      .save = [](void* all) noexcept { static_cast<T*>(all)->save(); },
      .restore = [](void* all) noexcept { static_cast<T*>(all)->restore(); }};

  void swap(TouchesOnDemand& other) noexcept {
    std::swap(touches_, other.touches_);
    std::swap(ways_, other.ways_);
  }

  void* touches_ = nullptr;
  const Ways* ways_ = nullptr;
};
}  // namespace detail

/// One Touches for each dimension and precision of grains, created on first use.
class AnyTouches {
 public:
  template <class T>
  T& of() {
    return all_[place_of<T>].template get<T>();
  }
  template <class T>
  const T& of() const {
    return all_[place_of<T>].template get<T>();
  }

  /// Number of contacts in the last step.
  Index count() const noexcept {
    Index count = 0;
    for (const auto& each : all_) count += each.count();
    return count;
  }

  void save() noexcept {
    for (auto& each : all_) each.save();
  }
  void restore() noexcept {
    for (auto& each : all_) each.restore();
  }

 private:
  template <class T>
  static constexpr Index place_of =
      (T::dimension == 2 ? 0 : 2) + (std::is_same_v<typename T::Real, float> ? 0 : 1);

  std::array<detail::TouchesOnDemand, 4> all_;
};

}  // namespace silt::dem
