// SPDX-License-Identifier: MIT
// How a part of a simulation shows its state to a checkpoint: one function that serves writing and
// reading, and names what the part goes on from.
//
//   template <class Archive>
//   void transfer(Archive& archive) {
//     archive("came", came_);
//     archive("tried", tried_);
//   }
//
// An archive, such as those of io/archive.hpp, has
//   archive(name, value)         writes the value, or reads it: a number, an enum, a small Eigen
//                                vector, an array or std::vector of these, a std::string
//   archive(name, values, n)     the first n values of a std::vector; read, it has n
//   archive.same(name, text)     throws in reading if the text is not the same as it was
//   archive.within(name, f)      f() with its names below this one
//   Archive::reads               whether it reads
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <string_view>
#include <vector>

namespace silt {

/// part.transfer(archive, context...); the context is the particles, of which a part's state is.
template <class T, class Archive, class... Context>
concept Transferable = requires(T& part, Archive& archive, Context&... context) {
  part.transfer(archive, context...);
};

/// Transfers a part with the particles, if it asks for them, or without; does nothing for one that
/// has no state.
template <class Archive, class T, class P>
void transfer_part(Archive& archive, std::string_view name, T& part, P& particles) {
  if constexpr (Transferable<T, Archive, P>) {
    archive.within(name, [&] { part.transfer(archive, particles); });
  } else if constexpr (Transferable<T, Archive>) {
    archive.within(name, [&] { part.transfer(archive); });
  }
}

/// f() while the particles are at other positions [m], from which something was made once.
template <class P, class F>
void at_positions(P& particles, const std::vector<typename P::Vec>& x, F&& f) {
  const std::vector<typename P::Vec> now(particles[position].begin(), particles[position].end());
  std::copy(x.begin(), x.end(), particles[position].begin());
  f();
  std::copy(now.begin(), now.end(), particles[position].begin());
}

/// Transfers the positions [m] at which a search was last updated, and updates it there.
/// position_at(i) is that of particle i; where is_known is false, those are of other particles, and
/// the search is updated at the positions now. The particles stay where they are. Returns is_known.
template <class Archive, class P, class PositionAt, class Update>
bool transfer_update(Archive& archive, P& particles, bool is_known, PositionAt&& position_at,
                     Update&& update) {
  std::vector<typename P::Vec> x;
  if (!Archive::reads && is_known) {
    for (Index i = 0; i < particles.size(); ++i) x.push_back(position_at(i));
  }
  archive("is_known", is_known);
  archive("positions", x);
  if constexpr (Archive::reads) {
    if (!is_known) x.assign(particles[position].begin(), particles[position].end());
    at_positions(particles, x, update);
  }
  return is_known;
}

}  // namespace silt
