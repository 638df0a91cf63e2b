// SPDX-License-Identifier: MIT
// Positions as a search reads them, wherever they are stored: its functions are compiled once, not
// once for each way of storing them.
#pragma once

#include <silt/core/field_view.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <span>
#include <type_traits>

namespace silt {

/// A view of positions [m] at equal distances in memory: a column, or those in rows of a Bundle.
template <int Dim, class Real>
class Points {
 public:
  using Vec = silt::Vec<Dim, Real>;

  /// Of a column, such as a std::vector or a std::span of positions.
  template <class Column>
    requires std::constructible_from<std::span<const Vec>, const Column&>
  Points(const Column& x)
      : first_(reinterpret_cast<const Real*>(std::span<const Vec>(x).data())),
        size_(x.size()),
        stride_(sizeof(Vec) / sizeof(Real)) {}
  /// Of positions in the rows of a Bundle.
  template <class V, Index width>
    requires std::same_as<std::remove_const_t<V>, Vec>
  Points(const FieldView<V, Real, width>& x)
      : first_(reinterpret_cast<const Real*>(x.bytes())), size_(x.size()), stride_(width) {}

  Index size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  Vec operator[](Index i) const { return Vec(first_ + i * stride_); }

 private:
  const Real* first_;
  Index size_;
  Index stride_;  // in numbers
};

}  // namespace silt
