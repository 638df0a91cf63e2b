// SPDX-License-Identifier: MIT
// A material is a set of parameters of a law. Law::mix(a, b) gives the law between two materials.
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
  Index count_;
  std::vector<Law> table_;
};

}  // namespace silt::dem
