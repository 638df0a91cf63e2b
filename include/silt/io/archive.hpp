// SPDX-License-Identifier: MIT
// The archives of a checkpoint (core/transfer.hpp): a sequence of named entries.
//
//   magic, byte order    "silt checkpoint 1\n" and 0x01020304
//   entries              name, type of a value, number of values, the values
//   checksum             of all preceding bytes
//
// The format is simple because a file is only read by the version of Silt that wrote it, on
// machines with the same byte order.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/io/archive_format.hpp>
#include <silt/io/struct_columns.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

namespace checkpoint {

/// Nested names of entries: "particles/velocity".
class Path {
 public:
  /// Calls f(); the names in it are nested in this one.
  template <class F>
  void within(std::string_view name, F&& f) {
    const auto length = parent_.size();
    parent_ += std::string(name) + "/";
    f();
    parent_.resize(length);
  }
  /// The whole name of an entry, with the names that it is nested in.
  std::string of(std::string_view name) const { return parent_ + std::string(name); }

 private:
  std::string parent_;
};

/// Writes entries to a string; see core/transfer.hpp for its functions.
class Writer {
 public:
  static constexpr bool reads = false;

  Writer() {
    bytes_ += magic;
    append(&byte_order, sizeof byte_order);
  }

  template <class T>
  void operator()(std::string_view name, const T& value) {
    check_values(name, &value, 1);
    if constexpr (item_of<T>().kind == 'x') {
      T copy = value;
      clear_padding(copy);
      put(name, item_of<T>(), 1, &copy);
    } else {
      put(name, item_of<T>(), 1, &value);
    }
  }
  template <ArrayOfValues Values>
  void operator()(std::string_view name, const Values& values) {
    (*this)(name, values, values.size());
  }
  template <ArrayOfValues Values>
  void operator()(std::string_view name, const Values& values, Index count) {
    using T = typename Values::value_type;
    if constexpr (HasMembers<T>) {
      within(name, [&] {
        T model{};
        StructColumns<Writer, Values> columns(*this, model, values, count);
        model.transfer(columns);
        columns.finish();
      });
    } else if constexpr (item_of<T>().kind == 'x') {
      Values copies(values.begin(), values.begin() + std::ptrdiff_t(count));
      for (T& each : copies) clear_padding(each);
      put(name, item_of<T>(), count, copies.data());
    } else {
      check_values(name, values.data(), count);
      put(name, item_of<T>(), count, values.data());
    }
  }
  void operator()(std::string_view name, const std::string& text) {
    put(name, item_of<char>(), text.size(), text.data());
  }
  void same(std::string_view name, const std::string& text) { (*this)(name, text); }
  bool setup(std::string_view name, const std::vector<SetupPart>& parts) {
    std::vector<std::uint64_t> sizes;
    std::vector<double> numbers;
    for (const SetupPart& part : parts) {
      sizes.push_back(part.numbers.size());
      numbers.insert(numbers.end(), part.numbers.begin(), part.numbers.end());
    }
    within(name, [&] {
      (*this)("sizes", sizes);
      (*this)("numbers", numbers);
    });
    return true;
  }
  template <class F>
  void within(std::string_view name, F&& f) {
    path_.within(name, f);
  }
  template <class F>
  void finite(F&& f) {
    const bool before = std::exchange(must_be_finite_, true);
    f();
    must_be_finite_ = before;
  }

  /// All bytes of the file, with the checksum.
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

  // Throws if a number is not finite that must be when it is read.
  template <class T>
  void check_values(std::string_view name, const T* values, Index count) const {
    using Number = typename NumberOf<T>::type;
    if constexpr (std::floating_point<Number>) {
      if (!must_be_finite_) return;
      const auto* bytes = reinterpret_cast<const char*>(values);
      for (Index at = 0; at < count * sizeof(T); at += sizeof(Number)) {
        Number number;
        std::memcpy(&number, bytes + at, sizeof number);
        if (is_finite(number)) continue;
        fail({"write_checkpoint: ", path_.of(name), " = ", double(number), ", value ",
              at / sizeof(T), ", is not finite, and the file could not be read; correct it"});
      }
    }
  }

  Path path_;
  std::string bytes_;
  bool must_be_finite_ = false;
};

/// Reads what a Writer wrote, and refuses anything else; see core/transfer.hpp for its functions.
class Reader {
 public:
  static constexpr bool reads = true;

  /// Throws if the bytes are not a checkpoint, or are damaged.
  Reader(std::string name, std::string_view bytes, bool accepts_other_setup = false)
      : file_(std::move(name)), rest_(bytes), accepts_other_setup_(accepts_other_setup) {
    if (!bytes.starts_with(magic)) {
      reject("is not a checkpoint of this version of Silt",
             "pass a file written by write_checkpoint");
    }
    std::uint64_t sum = 0;
    if (bytes.size() >= magic.size() + sizeof byte_order + sizeof sum) {
      std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
      rest_.remove_suffix(sizeof sum);
    }
    if (rest_.size() == bytes.size() || sum != checksum(rest_)) {
      reject("is truncated or damaged: its checksum is wrong", "use an earlier checkpoint");
    }
    rest_.remove_prefix(magic.size());
    std::uint32_t order;
    read(&order, sizeof order);
    if (order != byte_order) {
      reject("was written on a machine with another byte order", "read it on such a machine");
    }
  }

  template <class T>
  void operator()(std::string_view name, T& value) {
    const std::uint64_t count = expect(name, item_of<T>());
    if (count != 1) {
      reject("has " + std::to_string(count) + " values of " + path_.of(name) +
                 " where one is expected",
             same_simulation);
    }
    check_values<T>(name, 1);
    read(static_cast<void*>(&value), sizeof value);
  }
  template <ArrayOfValues Values>
  void operator()(std::string_view name, Values& values) {
    using T = typename Values::value_type;
    if constexpr (HasMembers<T>) {
      within(name, [&] {
        T model{};
        values.clear();
        StructColumns<Reader, Values> columns(*this, model, values, 0);
        model.transfer(columns);
        columns.finish();
      });
    } else {
      const std::uint64_t count = expect(name, item_of<T>());
      check_values<T>(name, count);
      values.resize(count);
      read(static_cast<void*>(values.data()), count * sizeof(T));
    }
  }
  template <ArrayOfValues Values>
  void operator()(std::string_view name, Values& values, Index) {
    (*this)(name, values);
  }
  void operator()(std::string_view name, std::string& text) {
    const std::uint64_t count = expect(name, item_of<char>());
    require_left(count, 1);
    text.resize(count);
    read(text.data(), count);
  }
  void same(std::string_view name, const std::string& text) {
    std::string written;
    (*this)(name, written);
    if (written != text) {
      reject("was written with " + path_.of(name) + " = " + written + ", but here it is " + text,
             same_simulation);
    }
  }
  bool setup(std::string_view name, const std::vector<SetupPart>& parts) {
    std::vector<std::uint64_t> sizes;
    std::vector<double> numbers;
    within(name, [&] {
      (*this)("sizes", sizes);
      (*this)("numbers", numbers);
    });
    std::span<const double> left(numbers);
    for (Index k = 0; k < parts.size(); ++k) {
      if (k >= sizes.size() || sizes[k] > left.size() ||
          !are_equal(left.first(sizes[k]), parts[k])) {
        return accept_other_setup(parts[k].name);
      }
      left = left.subspan(sizes[k]);
    }
    return sizes.size() == parts.size() || accept_other_setup("number of " + std::string(name));
  }
  template <class F>
  void within(std::string_view name, F&& f) {
    path_.within(name, f);
  }
  template <class F>
  void finite(F&& f) {
    const bool before = std::exchange(must_be_finite_, true);
    f();
    must_be_finite_ = before;
  }
  void require_left(Index number, Index bytes_of_each) const {
    if (number > rest_.size() / bytes_of_each) reject("ends too early", damaged);
  }

  /// Calls f(), which reads all entries. Throws if the file has more, and what the components
  /// throw, with the name of the file and the place in it.
  template <class F>
  void read_all(F&& f) {
    try {
      f();
    } catch (const Error& error) {
      if (is_rejected_ || error.is_of_all()) throw;
      throw error.with_prefix("read_checkpoint: " + file_ + " cannot be restored, in " +
                              path_.of("") + ": ");
    }
    if (rest_.empty()) return;
    reject("has further entries, beginning with " + next_name(), same_simulation);
  }

 private:
  static constexpr const char* damaged = "use an earlier checkpoint";
  static constexpr const char* same_simulation =
      "set up the same simulation and pass the same parts as when it was written";

  // Apart from round-off of other mathematical functions.
  static bool are_equal(std::span<const double> numbers, const SetupPart& part) {
    double largest = 0;
    for (const double each : part.numbers) largest = std::max(largest, std::abs(each));
    return std::ranges::equal(numbers, part.numbers, [&](double a, double b) {
      return a == b || std::abs(a - b) <= part.tolerance * largest ||
             (std::isnan(a) && std::isnan(b));
    });
  }

  // Returns false if other parts are accepted.
  bool accept_other_setup(const std::string& name) const {
    if (accepts_other_setup_) return false;
    reject("was written with another " + name,
           "set up the same one, or, if the change is meant, read it with {.file = …, "
           ".accepts_other_setup = true}");
  }
  [[noreturn]] void reject(const std::string& what, const std::string& advice) const {
    is_rejected_ = true;
    fail({"read_checkpoint: ", file_, " ", what, "; ", advice});
  }

  // Throws unless the next values are complete, and each is possible.
  template <class T>
  void check_values(std::string_view name, std::uint64_t count) const {
    using Number = typename NumberOf<T>::type;
    require_left(count, sizeof(T));
    if (std::integral<Number> && !std::same_as<Number, bool>) return;
    if (std::floating_point<Number> && !must_be_finite_) return;
    for (Index at = 0; at < count * sizeof(T); at += sizeof(Number)) {
      const std::string fault = fault_of<Number>(rest_.data() + at, must_be_finite_);
      if (!fault.empty()) reject("has " + path_.of(name) + " = " + fault, damaged);
    }
  }

  void read(void* to, Index size) {
    if (size > rest_.size()) reject("ends too early", same_simulation);
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }

  std::string next_name() {
    std::uint32_t length = 0;
    read(&length, sizeof length);
    if (length > rest_.size()) reject("ends too early", same_simulation);
    std::string name(length, '\0');
    read(name.data(), length);
    return name;
  }

  // Begins the next entry, which must be this one; returns the number of its values.
  std::uint64_t expect(std::string_view name, const Item& item) {
    const std::string full = path_.of(name);
    if (rest_.empty()) reject("has no " + full, same_simulation);
    const std::string written = next_name();
    if (written != full) {
      reject("has " + written + " where " + full + " is expected", same_simulation);
    }
    Item written_item{};
    read(&written_item.kind, 1);
    read(&written_item.width, sizeof written_item.width);
    read(&written_item.numbers, sizeof written_item.numbers);
    if (!(written_item == item)) {
      reject(
          "has " + full + " of " + written_item.text() + " each, but here it is of " + item.text(),
          same_simulation);
    }
    std::uint64_t count = 0;
    read(&count, sizeof count);
    return count;
  }

  std::string file_;
  std::string_view rest_;
  Path path_;
  bool accepts_other_setup_;
  bool must_be_finite_ = false;
  mutable bool is_rejected_ = false;
};

}  // namespace checkpoint

}  // namespace silt
