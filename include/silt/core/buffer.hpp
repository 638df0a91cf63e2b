// SPDX-License-Identifier: MIT
// A std::vector for values that own nothing. A program has dozens of types of such values, and for
// each std::vector compiles about fifty functions; these share one class of bytes. Their memory
// begins at a cache line, so that no register is loaded across two.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <iterator>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace silt {

namespace detail {

/// Bytes in memory that grows.
class GrowingBytes {
 public:
  static constexpr std::align_val_t alignment{64};

  GrowingBytes() = default;
  [[gnu::noinline]] GrowingBytes(const GrowingBytes& other) { assign(other); }
  GrowingBytes(GrowingBytes&& other) noexcept { swap(other); }
  GrowingBytes& operator=(const GrowingBytes& other) {
    if (this != &other) assign(other);
    return *this;
  }
  GrowingBytes& operator=(GrowingBytes&& other) noexcept {
    GrowingBytes old(std::move(other));
    swap(old);
    return *this;
  }
  ~GrowingBytes() { release(); }
  void swap(GrowingBytes& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  std::byte* data() const noexcept { return data_; }
  std::size_t size() const noexcept { return size_; }
  std::size_t capacity() const noexcept { return capacity_; }

  /// Adds bytes without a value, and returns their place.
  std::byte* add(std::size_t count) {
    if (count > capacity_ - size_) reserve(size_ + std::max(size_, count));
    std::byte* const place = data_ + size_;
    size_ += count;
    return place;
  }
  void shrink(std::size_t size) noexcept { size_ = size; }
  [[gnu::noinline]] void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    auto* const data = static_cast<std::byte*>(::operator new(capacity, alignment));
    if (size_ > 0) std::memcpy(data, data_, size_);
    release();
    data_ = data;
    capacity_ = capacity;
  }

 private:
  [[gnu::noinline]] void assign(const GrowingBytes& other) {
    size_ = 0;
    reserve(other.size_);
    if (other.size_ > 0) std::memcpy(data_, other.data_, other.size_);
    size_ = other.size_;
  }
  [[gnu::noinline]] void release() noexcept {
    if (data_) ::operator delete(data_, alignment);
  }

  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace detail

/// Values that own nothing, whose bytes may therefore be copied, one after the other. As in
/// std::vector: capacity(), resize(), assign(), push_back(), pop_back(), swap(); append() adds all
/// values of a span. Memory that a resize() releases stays reserved.
template <class T>
class Buffer {
  static_assert(alignof(T) <= std::size_t(detail::GrowingBytes::alignment));

 public:
  using value_type = T;

  Buffer() = default;
  /// With `count` values, these values, or those of a range.
  explicit Buffer(Index count) { resize(count); }
  Buffer(Index count, const T& value) { resize(count, value); }
  Buffer(std::initializer_list<T> values) { append(values); }
  template <std::input_iterator Iterator>
  Buffer(Iterator first, Iterator last) {
    assign(first, last);
  }

  Index size() const noexcept { return bytes_.size() / sizeof(T); }
  bool empty() const noexcept { return bytes_.size() == 0; }
  Index capacity() const noexcept { return bytes_.capacity() / sizeof(T); }
  T* data() noexcept { return reinterpret_cast<T*>(bytes_.data()); }
  const T* data() const noexcept { return reinterpret_cast<const T*>(bytes_.data()); }
  T* begin() noexcept { return data(); }
  T* end() noexcept { return data() + size(); }
  const T* begin() const noexcept { return data(); }
  const T* end() const noexcept { return data() + size(); }
  T& operator[](Index i) noexcept {
    check(i);
    return data()[i];
  }
  const T& operator[](Index i) const noexcept {
    check(i);
    return data()[i];
  }
  T& front() noexcept { return (*this)[0]; }
  const T& front() const noexcept { return (*this)[0]; }
  T& back() noexcept { return (*this)[size() - 1]; }
  const T& back() const noexcept { return (*this)[size() - 1]; }

  void clear() noexcept { bytes_.shrink(0); }
  void reserve(Index count) { bytes_.reserve(count * sizeof(T)); }
  void resize(Index count) { resize(count, T{}); }
  void resize(Index count, const T& value) {
    static_assert(std::is_trivially_destructible_v<T>, "silt::Buffer: T must own nothing");
    if (count <= size()) return bytes_.shrink(count * sizeof(T));
    const T copy = value;  // may be one of these
    const Index added = count - size();
    auto* const place = reinterpret_cast<T*>(bytes_.add(added * sizeof(T)));
    for (Index k = 0; k < added; ++k) ::new (static_cast<void*>(place + k)) T(copy);
  }
  void assign(Index count, const T& value) {
    const T copy = value;
    clear();
    resize(count, copy);
  }
  void assign(std::span<const T> values) {
    clear();
    append(values);
  }
  template <std::input_iterator Iterator>
  void assign(Iterator first, Iterator last) {
    clear();
    for (; first != last; ++first) push_back(*first);
  }
  void push_back(const T& value) {
    const T copy = value;  // may be one of these
    ::new (static_cast<void*>(bytes_.add(sizeof(T)))) T(copy);
  }
  void append(std::span<const T> values) {
    if (values.empty()) return;
    std::memcpy(bytes_.add(values.size_bytes()), static_cast<const void*>(values.data()),
                values.size_bytes());
  }
  void pop_back() noexcept { bytes_.shrink(bytes_.size() - sizeof(T)); }
  void swap(Buffer& other) noexcept { bytes_.swap(other.bytes_); }

 private:
  void check([[maybe_unused]] Index i) const noexcept {
#ifdef _GLIBCXX_ASSERTIONS  // as std::vector
    if (i >= size()) std::terminate();
#endif
  }

  detail::GrowingBytes bytes_;
};

}  // namespace silt
