// SPDX-License-Identifier: MIT
// A material is a set of parameters of a law. Law::mix(a, b) gives the law between two materials,
// unless the law of the pair is given:
//
//   dem::Materials{steel, rubber}.with_pair(0, 1, steel_on_rubber)
//   dem::Materials<Law>::of_pairs({{steel, steel_on_rubber}, {rubber}})
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace silt::dem {

/// The laws of all pairs of materials.
template <class Law>
class Materials {
 public:
  /// Throws if the list is empty or a parameter of a law is out of range.
  Materials(std::initializer_list<Law> laws) : count_(laws.size()) {
    if (count_ == 0) fail("Materials: the list is empty; give at least one law");
    const std::vector<Law> own(laws);
    for (const Law& a : own) {
      if constexpr (requires { a.check(); }) a.check();
      for (const Law& b : own) {
        if constexpr (requires { Law::mix(a, b); }) {
          table_.push_back(Law::mix(a, b));
        } else {
          table_.push_back(a);
        }
      }
    }
    if constexpr (!requires(const Law& a) { Law::mix(a, a); }) {
      if (count_ > 1) {
        fail(
            "Materials: this law has no static mix(a, b), which is needed for more than one "
            "material; add it, or use one material");
      }
    }
  }

  /// The laws of all pairs: each row has those of a material with itself and with the following
  /// ones, {{aa, ab, ac}, {bb, bc}, {cc}}. Throws if there is no row, if one has another number of
  /// laws, or if a parameter of a law is out of range.
  static Materials of_pairs(std::initializer_list<std::initializer_list<Law>> rows) {
    if (rows.size() == 0) fail("Materials::of_pairs: there is no row; give at least one law");
    Materials all(Empty{});
    all.count_ = rows.size();
    Index a = 0;
    for (const auto& row : rows) {
      if (row.size() != all.count_ - a) {
        fail({"Materials::of_pairs: row ", a, " has ", row.size(), " laws, but there are ",
              all.count_, " rows; it needs ", all.count_ - a, ", of material ", a,
              " with itself and each following one"});
      }
      if (all.table_.empty()) all.table_.assign(all.count_ * all.count_, *row.begin());
      Index b = a;
      for (const Law& law : row) all.set_pair(a, b++, law);
      ++a;
    }
    return all;
  }

  /// A copy with this law between the materials a and b, instead of the mixed one. Throws if one
  /// does not exist, or if a parameter of the law is out of range.
  Materials with_pair(std::uint32_t a, std::uint32_t b, const Law& law) const {
    for (const std::uint32_t number : {a, b}) {
      if (number >= count_) {
        fail({"Materials::with_pair: material ", number, " does not exist: there are only ", count_,
              "; give numbers below ", count_});
      }
    }
    Materials all = *this;
    all.set_pair(a, b, law);
    return all;
  }

  /// Number of materials.
  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(count_); }

  /// Throws if there is no material with this number; `whose` and `where` describe its owner.
  void check(std::uint32_t number, std::string_view whose, const Where& where = {}) const {
    if (number >= count_) {
      fail({"dem::Contacts: material ", number, " ", whose, " does not exist: there are only ",
            count_, "; pass all materials to Contacts"},
           where);
    }
  }

  /// Law between materials a and b, both below count().
  const Law& between(std::uint32_t a, std::uint32_t b) const noexcept {
    return table_[a * count_ + b];
  }

 private:
  struct Empty {};
  explicit Materials(Empty) {}

  void set_pair(Index a, Index b, const Law& law) {
    if constexpr (requires { law.check(); }) law.check();
    table_[a * count_ + b] = table_[b * count_ + a] = law;
  }

  Index count_ = 0;
  std::vector<Law> table_;
};

}  // namespace silt::dem
