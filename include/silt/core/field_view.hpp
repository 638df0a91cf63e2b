// SPDX-License-Identifier: MIT
// The values of one field that lie side by side with those of other fields; see
// core/field_storage.hpp.
#pragma once

#include <silt/core/types.hpp>

#include <compare>
#include <concepts>
#include <cstddef>
#include <iterator>
#include <type_traits>

namespace silt {

/// A range of n values, `width` numbers of type Real apart in memory: like a std::span, but without
/// data(). Value may be const.
template <class Value, class Real, Index width>
class FieldView {
  using Byte = std::conditional_t<std::is_const_v<Value>, const std::byte, std::byte>;

 public:
  /// Distance of two successive values [bytes].
  static constexpr std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(width * sizeof(Real));
  using value_type = std::remove_cv_t<Value>;

  class iterator {
   public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = std::remove_cv_t<Value>;
    using difference_type = std::ptrdiff_t;
    using reference = Value&;
    using pointer = Value*;

    iterator() = default;
    explicit iterator(Byte* at) : at_(at) {}
    reference operator*() const { return *reinterpret_cast<Value*>(at_); }
    pointer operator->() const { return reinterpret_cast<Value*>(at_); }
    reference operator[](difference_type n) const { return *(*this + n); }
    iterator& operator+=(difference_type n) { at_ += n * stride; return *this; }
    iterator& operator-=(difference_type n) { return *this += -n; }
    iterator& operator++() { return *this += 1; }
    iterator& operator--() { return *this -= 1; }
    iterator operator++(int) { const iterator before = *this; ++*this; return before; }
    iterator operator--(int) { const iterator before = *this; --*this; return before; }
    friend iterator operator+(iterator a, difference_type n) { return a += n; }
    friend iterator operator+(difference_type n, iterator a) { return a += n; }
    friend iterator operator-(iterator a, difference_type n) { return a -= n; }
    friend difference_type operator-(iterator a, iterator b) { return (a.at_ - b.at_) / stride; }
    friend bool operator==(iterator a, iterator b) { return a.at_ == b.at_; }
    friend auto operator<=>(iterator a, iterator b) { return a.at_ <=> b.at_; }

   private:
    Byte* at_ = nullptr;
  };

  FieldView() = default;
  /// From the first value, any pointer if there are none.
  FieldView(Byte* first, Index size) : first_(first), size_(size) {}
  /// A view of const values from one of values that are not const.
  template <class Other>
    requires std::same_as<const Other, Value>
  FieldView(const FieldView<Other, Real, width>& other)
      : first_(other.bytes()), size_(other.size()) {}

  Index size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  Value& operator[](Index i) const noexcept {
    return *reinterpret_cast<Value*>(first_ + i * width * sizeof(Real));
  }
  Value& front() const noexcept { return (*this)[0]; }
  Value& back() const noexcept { return (*this)[size_ - 1]; }
  iterator begin() const noexcept { return iterator(first_); }
  iterator end() const noexcept {
    return begin() + static_cast<std::ptrdiff_t>(size_);
  }
  /// Address of the first value.
  Byte* bytes() const noexcept { return first_; }

 private:
  Byte* first_ = nullptr;
  Index size_ = 0;
};

/// Distance of two successive values of a column [bytes].
template <class Values>
constexpr Index stride_of(const Values&) {
  if constexpr (requires { Values::stride; }) {
    return Index(Values::stride);
  } else {
    return sizeof(typename Values::value_type);
  }
}

}  // namespace silt
