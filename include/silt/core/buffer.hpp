// SPDX-License-Identifier: MIT
// An array with the most frequent functions of std::vector. A program has arrays of dozens of
// types, and std::vector compiles about fifty functions for each of them; here, what allocates and
// moves memory is compiled once, for bytes.
#pragma once

#include <silt/core/aligned_memory.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace silt {

namespace detail {

/// Bytes in memory that grows.
class GrowingBytes {
 public:
  /// Moves values, `size` bytes in all, to other memory; nullptr: their bytes are copied.
  using Move = void (*)(std::byte* to, std::byte* from, std::size_t size) noexcept;

  GrowingBytes() = default;
  [[gnu::noinline]] GrowingBytes(const GrowingBytes& other) { assign(other); }
  [[gnu::noinline]] GrowingBytes(GrowingBytes&& other) noexcept { swap(other); }
  GrowingBytes& operator=(const GrowingBytes& other) {
    if (this != &other) assign(other);
    return *this;
  }
  [[gnu::noinline]] GrowingBytes& operator=(GrowingBytes&& other) noexcept {
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

  /// The place after the last byte, with memory for `count` more.
  std::byte* place_for(std::size_t count, Move move = nullptr) {
    if (count > capacity_ - size_)
      reserve(size_ + std::max({size_, count, array_alignment}), move);
    return data_ + size_;
  }
  void set_size(std::size_t size) noexcept { size_ = size; }
  [[gnu::noinline]] void reserve(std::size_t capacity, Move move = nullptr) {
    if (capacity <= capacity_) return;
    std::byte* const data = new_array(capacity);
    if (move) {
      move(data, data_, size_);
    } else if (size_ > 0) {
      std::memcpy(data, data_, size_);
    }
    release();
    data_ = data;
    capacity_ = capacity;
  }

 private:
  [[gnu::noinline]] void assign(const GrowingBytes& other) {
    if (other.size_ > capacity_) {
      GrowingBytes larger;
      larger.reserve(other.size_);  // if this throws, nothing has changed
      swap(larger);
    }
    if (other.size_ > 0) std::memcpy(data_, other.data_, other.size_);
    size_ = other.size_;
  }
  [[gnu::noinline]] void release() noexcept {
    if (data_) delete_array(data_);
  }

  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// What Buffer does with values that own something. Others are copied as bytes.
template <class T>
struct OwningValues {
  static_assert(std::is_nothrow_move_constructible_v<T>,
                "silt::Buffer: moving a value that owns something must not throw");
  static void move(std::byte* to, std::byte* from, std::size_t size) noexcept {
    for (std::size_t at = 0; at < size; at += sizeof(T)) {
      T& value = *reinterpret_cast<T*>(from + at);
      ::new (static_cast<void*>(to + at)) T(std::move(value));
      value.~T();
    }
  }
};

}  // namespace detail

/// Values one after the other. As in std::vector: capacity(), resize(), assign(), push_back(),
/// pop_back(), swap(). append() adds all values of a span; they, and those that assign() copies,
/// must not be its own. Values with a trivial destructor are copied as bytes, which must be a copy
/// of them.
template <class T>
class Buffer {
  static_assert(alignof(T) <= detail::array_alignment,
                "silt::Buffer: values are aligned to at most 64 bytes");

 public:
  using value_type = T;

  Buffer() = default;
  /// With `count` values, these values, or those of a range.
  explicit Buffer(Index count) : Buffer() { resize(count); }
  Buffer(Index count, const T& value) : Buffer() { resize(count, value); }
  Buffer(std::initializer_list<T> values) : Buffer() { append(values); }
  template <std::input_iterator Iterator>
  Buffer(Iterator first, Iterator last) : Buffer() {
    assign(first, last);
  }
  // Once the constructor to which it delegates has returned, the destructor is called if the rest
  // throws.
  Buffer(const Buffer& other) : Buffer(copy_of(other.bytes_)) {
    if constexpr (owns()) append(other);
  }
  Buffer(Buffer&&) noexcept = default;
  Buffer& operator=(const Buffer& other) {
    if constexpr (!owns()) {
      bytes_ = other.bytes_;
    } else if (this != &other) {
      Buffer copy(other);
      swap(copy);
    }
    return *this;
  }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer old(std::move(other));
    swap(old);
    return *this;
  }
  ~Buffer() {
    if constexpr (owns()) destroy_from(0);
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

  void clear() noexcept { shrink(0); }
  void reserve(Index count) { bytes_.reserve(bytes_of(count), move_of()); }
  void resize(Index count) {
    if (count <= size()) return shrink(count);
    [[maybe_unused]] T* const place = place_for(count - size());
    if constexpr (owns()) {
      while (size() < count) emplace_back();
    } else {
      T* const end = place + (count - size());
      for (T* at = place; at != end; ++at) ::new (static_cast<void*>(at)) T{};
      bytes_.set_size(bytes_of(count));
    }
  }
  void resize(Index count, const T& value) {
    if (count <= size()) return shrink(count);
    const T copy = value;  // may be one of these
    [[maybe_unused]] T* const place = place_for(count - size());
    if constexpr (owns()) {
      while (size() < count) emplace_back(copy);
    } else {
      T* const end = place + (count - size());
      for (T* at = place; at != end; ++at) ::new (static_cast<void*>(at)) T(copy);
      bytes_.set_size(bytes_of(count));
    }
  }
  void assign(Index count, const T& value) {
    const T copy = value;
    reserve(count);
    clear();
    resize(count, copy);
  }
  void assign(std::span<const T> values) {
    reserve(values.size());
    clear();
    append(values);
  }
  template <std::input_iterator Iterator>
  void assign(Iterator first, Iterator last) {
    if constexpr (std::contiguous_iterator<Iterator> &&
                  std::is_same_v<std::iter_value_t<Iterator>, T>) {
      assign(std::span<const T>(first, last));
    } else {
      if constexpr (std::random_access_iterator<Iterator>) reserve(Index(last - first));
      clear();
      for (; first != last; ++first) push_back(*first);
    }
  }
  void push_back(T value) { emplace_back(std::move(value)); }
  /// The added value. The arguments must not be of one of these values.
  template <class... Arguments>
  T& emplace_back(Arguments&&... arguments) {
    std::byte* const place = bytes_.place_for(sizeof(T), move_of());
    T* added;
    if constexpr (std::is_aggregate_v<T>) {
      added = ::new (static_cast<void*>(place)) T{std::forward<Arguments>(arguments)...};
    } else {
      added = ::new (static_cast<void*>(place)) T(std::forward<Arguments>(arguments)...);
    }
    bytes_.set_size(bytes_.size() + sizeof(T));
    return *added;
  }
  void append(std::span<const T> values) {
    if constexpr (owns()) {
      bytes_.place_for(bytes_of(values.size()), move_of());
      for (const T& value : values) emplace_back(value);
    } else if (!values.empty()) {
      std::memcpy(bytes_.place_for(values.size_bytes()), static_cast<const void*>(values.data()),
                  values.size_bytes());
      bytes_.set_size(bytes_.size() + values.size_bytes());
    }
  }
  void pop_back() noexcept {
    check(size() - 1);
    shrink(size() - 1);
  }
  void swap(Buffer& other) noexcept { bytes_.swap(other.bytes_); }

 private:
  explicit Buffer(detail::GrowingBytes bytes) noexcept : bytes_(std::move(bytes)) {}
  static detail::GrowingBytes copy_of(const detail::GrowingBytes& bytes) {
    if constexpr (owns()) {
      return {};
    } else {
      return bytes;
    }
  }
  static constexpr bool owns() { return !std::is_trivially_destructible_v<T>; }
  static constexpr detail::GrowingBytes::Move move_of() {
    if constexpr (owns()) {
      return &detail::OwningValues<T>::move;
    } else {
      return nullptr;
    }
  }
  T* place_for(Index added) {
    return reinterpret_cast<T*>(bytes_.place_for(bytes_of(added), move_of()));
  }
  static std::size_t bytes_of(Index count) {
    if (count > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(T)) throw std::bad_alloc();
    return count * sizeof(T);
  }
  void shrink(Index count) noexcept {
    if constexpr (owns()) destroy_from(count);
    bytes_.set_size(count * sizeof(T));
  }
  void destroy_from(Index count) noexcept {
    for (T& value : std::span(data(), size()).subspan(count)) value.~T();
  }
  void check([[maybe_unused]] Index i) const noexcept {
#ifdef _GLIBCXX_ASSERTIONS  // as std::vector
    if (i >= size()) std::terminate();
#endif
  }

  detail::GrowingBytes bytes_;
};

}  // namespace silt
