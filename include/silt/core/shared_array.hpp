// SPDX-License-Identifier: MIT
// An array that several owners keep without copying it: it is replaced, not changed, while another
// has it too.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

namespace silt {

/// Values one after the other. A copy shares their memory until one of the two is changed.
template <class T>
class SharedArray {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  SharedArray() = default;
  // No moves: an array moved from would keep the size of memory that it no longer owns.
  SharedArray(const SharedArray&) = default;
  SharedArray& operator=(const SharedArray&) = default;
  ~SharedArray() = default;

  Index size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  const T* data() const noexcept { return data_; }
  const T* begin() const noexcept { return data_; }
  const T* end() const noexcept { return data_ + size_; }
  const T& operator[](Index i) const noexcept { return data_[i]; }

  /// The first n values, or all if there are fewer, in the same memory.
  SharedArray first(Index n) const {
    SharedArray part = *this;
    part.size_ = std::min(n, size_);
    return part;
  }

  /// n values to be written. Those before are lost, except to other owners. If it throws, nothing
  /// has changed.
  T* renew(Index n) {
    if (is_shared() || memory_->capacity() < n) {
      auto memory = std::make_shared<Buffer<T>>();
      resize_tightly(*memory, n);
      memory_.swap(memory);
    } else {
      memory_->resize(n);
    }
    return use(n);
  }
  /// Replaces them by those of [first, last), in the memory of `other` if it has the same.
  template <class Iterator>
  void assign(Iterator first, Iterator last, const SharedArray& other = {}) {
    const auto n = static_cast<Index>(last - first);
    const auto is_same = [](const T& a, const T& b) {
      return std::memcmp(static_cast<const void*>(&a), &b, sizeof(T)) == 0;
    };
    if (other.size() == n && std::equal(first, last, other.begin(), is_same)) {
      *this = other;
    } else {
      std::copy(first, last, renew(n));
    }
  }
  /// Memory of their own for n values: push_back() does not throw until there are so many. If it
  /// throws, nothing has changed.
  void reserve_own(Index n) {
    if (is_shared()) {
      auto memory = std::make_shared<Buffer<T>>();
      reserve_tightly(*memory, std::max(n, size_));
      memory->assign(begin(), end());
      memory_.swap(memory);
    } else {
      memory_->resize(size_);  // it may have more than the first values
      reserve_tightly(*memory_, n);
    }
    use(size_);
  }
  /// Adds a value.
  void push_back(const T& value) {
    const T copy = value;  // may be one of these
    reserve_own(size_);
    memory_->push_back(copy);
    use(size_ + 1);
  }
  /// Changes their number to n; those that are added are to be written.
  T* resize(Index n) {
    reserve_own(n);
    memory_->resize(n);
    return use(n);
  }
  /// Exchanges all values.
  void swap(SharedArray& other) noexcept {
    memory_.swap(other.memory_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }

 private:
  // Or has no memory.
  bool is_shared() const noexcept {
    if (memory_.use_count() != 1) return true;
    // The last other owner may have read them in another thread.
    std::atomic_thread_fence(std::memory_order_acquire);
    return false;
  }
  T* use(Index n) noexcept {
    size_ = n;
    data_ = memory_->data();
    return memory_->data();
  }

  std::shared_ptr<Buffer<T>> memory_;
  const T* data_ = nullptr;
  Index size_ = 0;
};

}  // namespace silt
