// SPDX-License-Identifier: MIT
// Rows of equal size in contiguous memory: the values of one field, or of a bundle, of all
// particles. Not a template over the type of the values, which a RowType describes: a program has
// many fields, and each would compile all of this.
#pragma once

#include <silt/core/aligned_memory.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace silt::detail {

/// Functions of a type of values that are no numbers, for n of them.
struct ValueFunctions {
  void (*construct_zeros)(std::byte* to, Index n);
  void (*construct_copies)(std::byte* to, const std::byte* from, Index n);
  void (*assign)(std::byte* to, const std::byte* from, Index n);
  void (*destroy)(std::byte* first, Index n);
};
template <class Value>
inline constexpr ValueFunctions functions_of{
    [](std::byte* to, Index n) {
      std::uninitialized_fill_n(reinterpret_cast<Value*>(to), n, zero_of<Value>());
    },
    [](std::byte* to, const std::byte* from, Index n) {
      std::uninitialized_copy_n(reinterpret_cast<const Value*>(from), n,
                                reinterpret_cast<Value*>(to));
    },
    [](std::byte* to, const std::byte* from, Index n) {
      std::copy_n(reinterpret_cast<const Value*>(from), n, reinterpret_cast<Value*>(to));
    },
    [](std::byte* first, Index n) { std::destroy_n(reinterpret_cast<Value*>(first), n); }};

/// Whether a value consists of numbers, so that its bytes may be copied, and are 0 if it is zero.
template <class Value>
inline constexpr bool is_of_numbers = [] {
  if constexpr (requires {
                  typename Value::Scalar;
                  Value::SizeAtCompileTime;
                }) {
    return Value::SizeAtCompileTime > 0 && std::is_arithmetic_v<typename Value::Scalar>;
  } else {
    return std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
  }
}();

/// What a column must know of its rows.
struct RowType {
  Index size;         ///< [bytes]
  Index number_size;  ///< of each number in it [bytes]; of a column, its size
  const ValueFunctions* functions = nullptr;  ///< unless it consists of numbers
};
template <class Value>
inline constexpr RowType row_type_of{sizeof(Value), sizeof(Value),
                                     is_of_numbers<Value> ? nullptr : &functions_of<Value>};

/// Copies bytes; for the sizes of most rows without a call.
inline void copy_bytes(std::byte* to, const std::byte* from, Index size) {
  if (size == 8) {
    std::memcpy(to, from, 8);
  } else if (size == 16) {
    std::memcpy(to, from, 16);
  } else if (size == 64) {
    std::memcpy(to, from, 64);
  } else if (size > 0) {
    std::memcpy(to, from, size);
  }
}

/// Its functions are not inlined, for short programs: they are called for every column.
class Column {
 public:
  explicit Column(const RowType& type) noexcept : type_(&type) {}
  [[gnu::noinline]] Column(const Column& other) : type_(other.type_) {
    reserve(other.size_);
    append(other.data(), other.size_);
  }
  Column(Column&& other) noexcept : type_(other.type_) { swap(other); }
  [[gnu::noinline]] Column& operator=(const Column& other) {
    if (type_->functions || is_shared() || other.size_ > capacity_) {
      Column copy(other);
      swap(copy);
    } else if (this != &other) {
      copy_bytes(data(), other.data(), other.size_ * type_->size);
      size_ = other.size_;
    }
    return *this;
  }
  Column& operator=(Column&& other) noexcept {
    swap(other);
    return *this;
  }
  [[gnu::noinline]] ~Column() { destroy_from(0); }
  /// Of the same type.
  void swap(Column& other) noexcept {
    memory_.swap(other.memory_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  const RowType& type() const noexcept { return *type_; }
  /// Number of rows, and for how many there is memory.
  Index size() const noexcept { return size_; }
  Index capacity() const noexcept { return capacity_; }
  std::byte* data() noexcept { return memory_.get(); }
  const std::byte* data() const noexcept { return memory_.get(); }
  std::byte* row(Index i) noexcept { return data() + i * type_->size; }
  const std::byte* row(Index i) const noexcept { return data() + i * type_->size; }

  /// The rows, which must not be changed while they are shared; only for numbers.
  std::shared_ptr<const std::byte> share() const { return memory_; }
  bool is_shared() const noexcept {
    if (memory_.use_count() > 1) return true;
    // The last other owner may have read them in another thread.
    std::atomic_thread_fence(std::memory_order_acquire);
    return false;
  }

  [[gnu::noinline]] void reserve(Index n) {
    if (n <= capacity_) return;
    std::shared_ptr<std::byte> memory(new_array(n * type_->size), delete_array);
    construct(memory.get(), data(), size_);
    const Index size = size_;
    destroy_from(0);
    memory_.swap(memory);
    size_ = size;
    capacity_ = n;
  }
  /// New rows are zero.
  [[gnu::noinline]] void resize(Index n) {
    if (n <= size_) return destroy_from(n);
    if (n > capacity_) reserve(n + n / 16);
    if (type_->functions) {
      type_->functions->construct_zeros(row(size_), n - size_);
    } else {
      std::memset(row(size_), 0, (n - size_) * type_->size);
    }
    size_ = n;
  }
  /// Adds a copy of row i.
  void push_copy(Index i) {
    if (size_ == capacity_) reserve(2 * size_ + 1);
    append(row(i), 1);
  }
  void copy(Index from, Index to) { assign(row(to), row(from), 1); }
  /// Replaces rows [first, last) by those of another column.
  void copy_from(const Column& other, Index first, Index last) {
    if (first < last) assign(row(first), other.row(first), last - first);
  }
  /// Replaces number k of the first n rows by those of another column.
  void copy_numbers(const Column& other, Index k, Index n) {
    if (n == 0) return;
    const Index stride = type_->size, size = type_->number_size;
    for_each(n, [=, to = data() + k * size, from = other.data() + k * size](Index i) {
      copy_bytes(to + i * stride, from + i * stride, size);
    });
  }
  /// Replaces the bytes [place, place + size) of the rows from `first` on by those of `others`.
  void copy_to_rows(Index first, std::span<const Index> others, Index place, Index size) {
    for_each(others.size(), [=, this](Index k) {
      if (type_->functions) return copy(others[k], first + k);
      copy_bytes(row(first + k) + place, row(others[k]) + place, size);
    });
  }
  /// A copy with row order[i] in row i.
  Column in_order(std::span<const Index> order) const {
    Column sorted(*type_);
    sorted.reserve(capacity_);  // ghosts need it again
    sorted.append(data(), size_);
    for_each(order.size(), [&](Index i) { sorted.assign(sorted.row(i), row(order[i]), 1); });
    return sorted;
  }

 private:
  void construct(std::byte* to, const std::byte* from, Index n) const {
    if (type_->functions) {
      type_->functions->construct_copies(to, from, n);
    } else {
      copy_bytes(to, from, n * type_->size);
    }
  }
  void append(const std::byte* from, Index n) {
    if (n > 0) construct(row(size_), from, n);
    size_ += n;
  }
  void assign(std::byte* to, const std::byte* from, Index n) const {
    if (type_->functions) {
      type_->functions->assign(to, from, n);
    } else {
      copy_bytes(to, from, n * type_->size);
    }
  }
  void destroy_from(Index n) {
    if (type_->functions && n < size_) type_->functions->destroy(row(n), size_ - n);
    size_ = n;
  }

  const RowType* type_;
  std::shared_ptr<std::byte> memory_;
  Index size_ = 0;
  Index capacity_ = 0;
};

}  // namespace silt::detail
