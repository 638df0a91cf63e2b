// SPDX-License-Identifier: MIT
// The bytes of checkpoints: where their entries are, and a valid checksum for changed bytes.
#pragma once

#include <silt/core/types.hpp>
#include <silt/io/archive.hpp>
#include <silt/io/checkpoint.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test {

inline constexpr Index checksum_size = sizeof(std::uint64_t);

/// The bytes before the checksum, with theirs.
inline std::string with_checksum(std::string bytes) {
  const std::uint64_t sum = checkpoint::checksum(bytes);
  return bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
}

/// Where the parts of an entry are in a file.
struct Entry {
  std::string name;
  Index begins_at;
  Index count_at;
  std::uint64_t count;
  Index values_at;
  Index value_size;
  Index size;  ///< of all values
};

/// The entries of a valid checkpoint.
inline std::vector<Entry> entries_of(const std::string& text) {
  std::vector<Entry> entries;
  Index at = checkpoint::magic.size() + sizeof checkpoint::byte_order;
  const auto number = [&]<class T>(T value) {
    std::memcpy(&value, text.data() + at, sizeof value);
    at += sizeof value;
    return value;
  };
  while (at < text.size() - checksum_size) {
    Entry entry;
    entry.begins_at = at;
    const auto length = number(std::uint32_t{});
    entry.name = text.substr(at, length);
    at += length + 1;
    const auto width = number(std::uint32_t{});
    const auto numbers = number(std::uint32_t{});
    entry.count_at = at;
    entry.count = number(std::uint64_t{});
    entry.values_at = at;
    entry.value_size = Index(width) * numbers;
    entry.size = entry.count * entry.value_size;
    at += entry.size;
    entries.push_back(entry);
  }
  return entries;
}

/// Name of the first entry that differs; empty if none does.
inline std::string first_difference(const std::string& a, const std::string& b) {
  const auto of_a = entries_of(a);
  const auto of_b = entries_of(b);
  for (Index k = 0; k < of_a.size() && k < of_b.size(); ++k) {
    const Index from_a = of_a[k].begins_at;
    const Index from_b = of_b[k].begins_at;
    if (a.substr(from_a, of_a[k].values_at + of_a[k].size - from_a) !=
        b.substr(from_b, of_b[k].values_at + of_b[k].size - from_b)) {
      return of_a[k].name;
    }
  }
  return of_a.size() == of_b.size() ? "" : "the number of entries";
}

/// A checkpoint with other bytes at this place, and its checksum.
template <class T>
std::string with_value(std::string text, Index at, const T& value) {
  std::memcpy(text.data() + at, &value, sizeof value);
  text.resize(text.size() - checksum_size);
  return with_checksum(std::move(text));
}

/// The bytes of a checkpoint of a RunWith (support/restart.hpp).
template <class Run>
std::string written(const Run& run) {
  Run copy = run;
  checkpoint::Writer writer;
  std::apply([&](auto&... part) { checkpoint::transfer_all(writer, copy.simulation, part...); },
             copy.observers);
  return std::move(writer).finish();
}

}  // namespace silt::test
