// SPDX-License-Identifier: MIT
// A plain model of the particle container: a map from id to the bytes of all fields.
#pragma once

#include "support/check.hpp"

#include <silt/core/box.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace silt::test {

/// Where field F begins in the bytes of a row of P.
template <class P, Field F>
std::size_t offset_in_row() {
  std::size_t offset = 0;
  bool is_found = false;
  P().for_each_field([&]<class Other>(auto, Other) {
    is_found = is_found || std::same_as<F, Other>;
    if (!is_found) offset += sizeof(value_of<Other, P::dimension, typename P::Real>);
  });
  return offset;
}

template <class P>
struct ParticleModel {
  using Vec = typename P::Vec;
  struct Ghost {
    Id owner;
    Vec shift;
    Bytes row;
  };

  std::map<Id, Bytes> rows;
  std::vector<Id> order;  // by index
  std::vector<Ghost> ghosts;
  Id next_id = 0;
  Box<P::dimension, typename P::Real> box;

  Vec position_of(const Bytes& row) const {
    Vec x;
    std::memcpy(x.data(), row.data(), sizeof x);
    return x;
  }
  static void set_position(Bytes& row, const Vec& x) {
    std::memcpy(row.data(), x.data(), sizeof x);
  }

  template <Field F>
  void refresh(F) {
    const std::size_t at = offset_in_row<P, F>();
    for (Ghost& ghost : ghosts) {
      const Bytes& owner = rows.at(ghost.owner);
      std::copy_n(owner.data() + at, sizeof(value_of<F, P::dimension, typename P::Real>),
                  ghost.row.data() + at);
      if constexpr (std::same_as<F, position_t>) {
        set_position(ghost.row, position_of(owner) + ghost.shift);
      }
    }
  }

  /// What is different in the particles; empty if nothing is.
  std::string difference(const P& particles) const {
    const auto number = [](Index n) { return std::to_string(n); };
    if (particles.size() != order.size() || rows.size() != order.size()) {
      return number(particles.size()) + " particles instead of " + number(order.size());
    }
    if (particles.empty() != order.empty() || particles.total() != order.size() + ghosts.size()) {
      return number(particles.total()) + " rows instead of " +
             number(order.size() + ghosts.size());
    }
    for (Index i = 0; i < order.size(); ++i) {
      if (particles.id(i) != order[i] || particles.ids()[i] != order[i]) {
        return "id " + number(particles.id(i)) + " instead of " + number(order[i]);
      }
      if (particles.index_of(order[i]) != i) return "index of id " + number(order[i]);
      if (particles.owner(i) != i) return "owner of particle " + number(i);
    }
    for (Index g = 0; g < ghosts.size(); ++g) {
      const Index i = order.size() + g;
      const bool is_owners = particles.id(i) == ghosts[g].owner &&
                             particles.id(particles.owner(i)) == ghosts[g].owner;
      if (!is_owners) return "owner of ghost " + number(g);
    }
    // Removed or never added.
    for (Id id = next_id > 20 ? next_id - 20 : 0; id < next_id + 2; ++id) {
      if (!rows.contains(id) && particles.index_of(id) != no_index) {
        return "id " + number(id) + ", which was removed";
      }
    }
    if (!(particles.box().lower == box.lower && particles.box().upper == box.upper &&
          particles.box().periodic == box.periodic)) {
      return "the box";
    }
    std::string different;
    std::size_t at = 0;
    particles.for_each_field([&]<class F>(auto, F field) {
      const auto values = particles.with_ghosts(field);
      const auto compare = [&](Index i, const Bytes& row) {
        if (std::memcmp(&values[i], row.data() + at, sizeof values[i]) == 0) return;
        different = std::string(name_of<F>()) + " in row " + number(i);
      };
      for (Index i = 0; i < order.size(); ++i) compare(i, rows.at(order[i]));
      for (Index g = 0; g < ghosts.size(); ++g) compare(order.size() + g, ghosts[g].row);
      at += sizeof(value_of<F, P::dimension, typename P::Real>);
    });
    return different;
  }
};

}  // namespace silt::test
