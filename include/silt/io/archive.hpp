// SPDX-License-Identifier: MIT
// The archives of a checkpoint (core/transfer.hpp): numbers by names, one entry after the other.
//
//   magic, byte order    "silt checkpoint 1\n" and 0x01020304
//   entries              name, what its numbers are, how many, the numbers themselves
//   checksum             of all before it
//
// It is as simple as can be: it is read by the version that wrote it, on machines with the same
// order of bytes.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

namespace checkpoint {

inline constexpr std::string_view magic = "silt checkpoint 1\n";
inline constexpr std::uint32_t byte_order = 0x01020304;

/// What one value consists of.
struct Item {
  char kind;              ///< f, i, u: numbers; x: bytes that nobody looks into
  std::uint32_t width;    ///< bytes of a number
  std::uint32_t numbers;  ///< in a value

  bool operator==(const Item&) const = default;

  std::string text() const {
    const std::string names = kind == 'f'   ? "floating-point numbers"
                              : kind == 'x' ? "blocks"
                                            : "whole numbers";
    return std::to_string(numbers) + " " + names + " of " + std::to_string(width) + " bytes";
  }
};

template <class T>
constexpr Item item_of() {
  if constexpr (std::is_enum_v<T>) {
    return item_of<std::underlying_type_t<T>>();
  } else if constexpr (std::floating_point<T>) {
    return {'f', sizeof(T), 1};
  } else if constexpr (std::integral<T>) {
    return {std::is_signed_v<T> ? 'i' : 'u', sizeof(T), 1};
  } else if constexpr (requires { typename T::Scalar; T::SizeAtCompileTime; }) {
    const Item item = item_of<typename T::Scalar>();
    return {item.kind, item.width, static_cast<std::uint32_t>(T::SizeAtCompileTime)};
  } else if constexpr (requires { std::tuple_size<T>::value; }) {
    const Item item = item_of<typename T::value_type>();
    return {item.kind, item.width,
            item.numbers * static_cast<std::uint32_t>(std::tuple_size_v<T>)};
  } else {
    return {'x', sizeof(T), 1};
  }
}

/// Fowler, Noll and Vo's hash FNV-1a, of words of eight bytes and then of what is left.
inline std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&hash](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3u; };
  for (; bytes.size() >= sizeof(std::uint64_t); bytes.remove_prefix(sizeof(std::uint64_t))) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), sizeof word);
    mix(word);
    hash ^= hash >> 32;
  }
  for (const char byte : bytes) mix(static_cast<unsigned char>(byte));
  return hash;
}

/// Names of entries, below one another: "particles/velocity".
class Path {
 public:
  template <class F>
  void within(std::string_view name, F&& f) {
    const auto length = above_.size();
    above_ += std::string(name) + "/";
    f();
    above_.resize(length);
  }
  std::string of(std::string_view name) const { return above_ + std::string(name); }

 private:
  std::string above_;
};

class Writer {
 public:
  static constexpr bool reads = false;

  Writer() {
    bytes_ += magic;
    append(&byte_order, sizeof byte_order);
  }

  template <class T>
  void operator()(std::string_view name, const T& value) {
    put(name, item_of<T>(), 1, &value);
  }
  template <class T, class A>
  void operator()(std::string_view name, const std::vector<T, A>& values) {
    (*this)(name, values, values.size());
  }
  template <class T, class A>
  void operator()(std::string_view name, const std::vector<T, A>& values, Index count) {
    put(name, item_of<T>(), count, values.data());
  }
  void operator()(std::string_view name, const std::string& text) {
    put(name, item_of<char>(), text.size(), text.data());
  }
  void same(std::string_view name, const std::string& text) { (*this)(name, text); }
  template <class F>
  void within(std::string_view name, F&& f) {
    path_.within(name, f);
  }

  std::string finish() && {
    const std::uint64_t sum = checksum(bytes_);
    append(&sum, sizeof sum);
    return std::move(bytes_);
  }

 private:
  void append(const void* from, Index size) {
    if (size > 0) bytes_.append(static_cast<const char*>(from), size);
  }
  void put(std::string_view name, const Item& item, std::uint64_t count, const void* values) {
    const std::string full = path_.of(name);
    const auto length = static_cast<std::uint32_t>(full.size());
    append(&length, sizeof length);
    append(full.data(), length);
    append(&item.kind, 1);
    append(&item.width, sizeof item.width);
    append(&item.numbers, sizeof item.numbers);
    append(&count, sizeof count);
    append(values, count * item.width * item.numbers);
  }

  Path path_;
  std::string bytes_;
};

class Reader {
 public:
  static constexpr bool reads = true;

  /// Throws if the bytes are no checkpoint, or not as they were written.
  Reader(std::string name, std::string_view bytes) : file_(std::move(name)), rest_(bytes) {
    if (!bytes.starts_with(magic)) {
      refuse("is no checkpoint of this version of Silt", "give a file that write_checkpoint made");
    }
    std::uint64_t sum = 0;
    if (bytes.size() >= magic.size() + sizeof byte_order + sizeof sum) {
      std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
      rest_.remove_suffix(sizeof sum);
    }
    if (rest_.size() == bytes.size() || sum != checksum(rest_)) {
      refuse("is cut short or damaged: its checksum is wrong", "use an earlier one");
    }
    rest_.remove_prefix(magic.size());
    std::uint32_t order;
    take(&order, sizeof order);
    if (order != byte_order) {
      refuse("was written on a machine with another order of bytes", "read it on one like that");
    }
  }

  template <class T>
  void operator()(std::string_view name, T& value) {
    const std::uint64_t count = expect(name, item_of<T>());
    if (count != 1) {
      refuse("has " + std::to_string(count) + " values of " + path_.of(name) + " where one belongs",
             same_simulation);
    }
    take(static_cast<void*>(&value), sizeof value);
  }
  template <class T, class A>
  void operator()(std::string_view name, std::vector<T, A>& values) {
    values.resize(expect(name, item_of<T>()));
    take(static_cast<void*>(values.data()), values.size() * sizeof(T));
  }
  template <class T, class A>
  void operator()(std::string_view name, std::vector<T, A>& values, Index) {
    (*this)(name, values);
  }
  void operator()(std::string_view name, std::string& text) {
    text.resize(expect(name, item_of<char>()));
    take(text.data(), text.size());
  }
  void same(std::string_view name, const std::string& text) {
    std::string written;
    (*this)(name, written);
    if (written != text) {
      refuse("was written with " + path_.of(name) + " = " + written + ", but here it is " + text,
             same_simulation);
    }
  }
  template <class F>
  void within(std::string_view name, F&& f) {
    path_.within(name, f);
  }

  /// Throws if something is left.
  void finish() const {
    if (!rest_.empty()) {
      refuse("has more parts than were asked for", "read as many as were written");
    }
  }

 private:
  static constexpr const char* same_simulation =
      "build the simulation, and name the parts, as they were when it was written";

  [[noreturn]] void refuse(const std::string& what, const std::string& advice) const {
    fail("read_checkpoint: " + file_ + " " + what + "; " + advice);
  }

  void take(void* to, Index size) {
    if (size > rest_.size()) refuse("ends too early", same_simulation);
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }

  // Begins the next entry, which must be this one; returns how many values follow.
  std::uint64_t expect(std::string_view name, const Item& item) {
    const std::string full = path_.of(name);
    if (rest_.empty()) refuse("has no " + full, same_simulation);
    std::uint32_t length = 0;
    take(&length, sizeof length);
    if (length > rest_.size()) refuse("ends too early", same_simulation);
    std::string written(length, '\0');
    take(written.data(), length);
    if (written != full) {
      refuse("has " + written + " where " + full + " is expected", same_simulation);
    }
    Item its{};
    take(&its.kind, 1);
    take(&its.width, sizeof its.width);
    take(&its.numbers, sizeof its.numbers);
    if (!(its == item)) {
      refuse("has " + full + " of " + its.text() + " each, but here it is of " + item.text(),
             same_simulation);
    }
    std::uint64_t count = 0;
    take(&count, sizeof count);
    if (count > rest_.size()) refuse("ends too early", same_simulation);
    return count;
  }

  std::string file_;
  std::string_view rest_;
  Path path_;
};

}  // namespace checkpoint

}  // namespace silt
