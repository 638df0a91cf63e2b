// SPDX-License-Identifier: MIT
// Structs in a checkpoint: one entry for each member, with its values in all structs, so that the
// bytes between members, which have no defined value, are not written.
//
//   struct History {
//     Vec<2> force = Vec<2>::Zero();
//     double stiffness = 0;
//     template <class Archive>
//     void transfer(Archive& archive) {
//       archive("force", force);
//       archive("stiffness", stiffness);
//     }
//   };
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::checkpoint {

namespace detail {
template <class V>
inline constexpr bool is_array_of_values = false;
template <class T, class A>
inline constexpr bool is_array_of_values<std::vector<T, A>> = true;
template <class T>
inline constexpr bool is_array_of_values<Buffer<T>> = true;
}  // namespace detail

/// A container of values that an archive writes one after the other.
template <class V>
concept ArrayOfValues = detail::is_array_of_values<V>;

namespace detail {
struct AnyArchive {
  static constexpr bool reads = false;
  void operator()(std::string_view, const auto&) {}
  void within(std::string_view, auto&&) {}
  void finite(auto&&) {}
};
}  // namespace detail

/// T lists its members in transfer(archive).
template <class T>
concept HasMembers = std::is_class_v<T> &&
                     requires(T& value, detail::AnyArchive& archive) { value.transfer(archive); };

/// Makes undefined bytes of a struct without transfer() zero, where the compiler can.
template <class T>
void clear_padding([[maybe_unused]] T& value) {
#if defined(__has_builtin)
#if __has_builtin(__builtin_clear_padding)
  if constexpr (std::is_empty_v<T>) {
    std::memset(static_cast<void*>(&value), 0, sizeof value);
  } else {
    __builtin_clear_padding(&value);
  }
#endif
#endif
}

/// The archive that transfer() of a struct gets: each call writes or reads one member of all
/// structs. The place of a member in the struct is that in `model`.
template <class Archive, ArrayOfValues Array>
class StructColumns {
 public:
  static constexpr bool reads = Archive::reads;
  using T = typename Array::value_type;  ///< a struct
  /// The structs, const for writing.
  using Values = std::conditional_t<reads, Array&, const Array&>;

  /// Writes the first `count` of the values, or reads as many as there are. `model` is the T whose
  /// transfer() is called.
  StructColumns(Archive& archive, T& model, Values values, Index count)
      : archive_(archive), model_(model), values_(values), count_(count) {}

  template <class M>
  void operator()(std::string_view name, M& member) {
    if constexpr (std::is_empty_v<M>) {
      return;  // may have the place of another member
    } else if constexpr (HasMembers<M>) {
      archive_.within(name, [&] { member.transfer(*this); });
    } else {
      const Index place = place_of(member);
      std::vector<InColumn<M>> column;
      if constexpr (reads) {
        archive_(name, column);
        if (!has_column_) values_.assign(column.size(), T{});
        if (column.size() != values_.size()) {
          fail({"member ", name, " has ", column.size(), " values, not ", values_.size(),
                "; use an earlier checkpoint"});
        }
        for (Index k = 0; k < column.size(); ++k) {
          std::memcpy(bytes_of(values_[k]) + place, static_cast<const void*>(&column[k]),
                      sizeof(M));
        }
      } else {
        column.resize(count_);
        for (Index k = 0; k < count_; ++k) {
          std::memcpy(static_cast<void*>(&column[k]), bytes_of(values_[k]) + place, sizeof(M));
        }
        archive_(name, column);
      }
      has_column_ = true;
    }
  }
  /// To be called after transfer(). Structs without members get a column of one byte each: their
  /// number alone could demand any amount of memory in reading.
  void finish() {
    if (has_column_) return;
    std::vector<std::uint8_t> column(count_);
    archive_("without_members", column);
    if constexpr (reads) values_.assign(column.size(), T{});
  }
  template <class F>
  void within(std::string_view name, F&& f) {
    archive_.within(name, f);
  }
  template <class F>
  void finite(F&& f) {
    archive_.finite(f);
  }

 private:
  // A vector of bool is not contiguous.
  template <class M>
  using InColumn = std::conditional_t<std::is_same_v<M, bool>, std::array<bool, 1>, M>;

  static std::byte* bytes_of(T& value) { return reinterpret_cast<std::byte*>(&value); }
  static const std::byte* bytes_of(const T& value) {
    return reinterpret_cast<const std::byte*>(&value);
  }
  template <class M>
  Index place_of(const M& member) const {
    return static_cast<Index>(reinterpret_cast<const std::byte*>(&member) - bytes_of(model_));
  }

  Archive& archive_;
  T& model_;
  Values values_;
  Index count_;
  bool has_column_ = false;
};

}  // namespace silt::checkpoint
