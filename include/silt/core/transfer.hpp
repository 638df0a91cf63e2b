// SPDX-License-Identifier: MIT
// Interface between a component of a simulation and a checkpoint: one function, used for both
// writing and reading, that lists the state of the component.
//
//   template <class Archive>
//   void transfer(Archive& archive) {
//     archive("number", number_);
//     archive("attempts", attempts_);
//   }
//
// An archive, such as those of io/archive.hpp, has
//   archive(name, value)         writes the value, or reads it: a number, an enum, a small Eigen
//                                vector, an array, silt::Buffer or std::vector of these, a
//                                std::string
//   archive(name, values, n)     writes the first n values of a std::vector, or reads n values;
//                                these may be structs with transfer(archive), as in
//                                io/struct_columns.hpp
//   archive.same(name, text)     writes the text, or throws if the text read is different
//   archive.setup(name, parts)   the same for numbers, apart from round-off, that characterise what
//                                the program sets up, see SetupPart. Returns true; false if what
//                                was read is different and that is accepted
//   archive.within(name, f)      calls f(); the names in it are in the group `name`
//   archive.finite(f)            calls f(), in which every number read must be finite, or it throws
//   Archive::reads               whether the archive reads; if so,
//   archive.require_left(n, b)   throws unless at least n times b bytes are left to read
// Before memory for what is read is allocated, its size must be known to be in proportion to the
// bytes that are left.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace silt {

/// Something that a program sets up, and numbers that characterise it.
struct SetupPart {
  std::string name;             ///< of the type and its member, such as "ParallelBond::beta"
  std::vector<double> numbers;  ///< in the units of their parameters
  double tolerance = 1e-9;  ///< of differences, relative to the largest number [-]
};

/// T has transfer(archive), or transfer(archive, particles) if its state refers to particles.
template <class T, class Archive, class... Context>
concept Transferable = requires(T& part, Archive& archive, Context&... context) {
  part.transfer(archive, context...);
};

namespace detail {
/// Calls part.transfer(archive, particles) or part.transfer(archive); does nothing for a part
/// without either.
template <class Archive, class T, class P>
void transfer_part(Archive& archive, std::string_view name, T& part, P& particles) {
  if constexpr (Transferable<T, Archive, P>) {
    archive.within(name, [&] { part.transfer(archive, particles); });
  } else if constexpr (Transferable<T, Archive>) {
    archive.within(name, [&] { part.transfer(archive); });
  }
}
}  // namespace detail

/// Calls f() with the particles, those of the halo included, temporarily at the positions x [m].
/// Throws if there are not as many as particles, or if one is not finite: they may have been read.
template <class P>
void at_positions(P& particles, std::span<const typename P::Vec> x, FunctionRef<void()> f) {
  if (x.size() != particles.local()) {
    fail({"search: there are ", x.size(), " positions of the last update for ", particles.local(),
          " particles; use an earlier checkpoint"});
  }
  for (const auto& each : x) require_finite("search: position of the last update", each);
  const auto all = particles.with_halo(position);
  const Buffer<typename P::Vec> now(all.begin(), all.end());
  const auto put = [&particles](std::span<const typename P::Vec> to) {
    const auto owned = std::ptrdiff_t(particles.size());
    std::copy(to.begin(), to.begin() + owned, particles[position].begin());
    if (particles.local() == particles.size()) return;
    std::copy(to.begin() + owned, to.end(), particles.halo_to_change(position).begin() + owned);
  };
  const auto put_back = [&] { put(now); };
  // Also if f() throws.
  struct AtEnd {
    FunctionRef<void()> call;
    ~AtEnd() { call(); }
  };
  const AtEnd at_end{put_back};
  put(x);
  f();
}

/// Transfers the positions [m] of the last update of a search; in reading, updates the search at
/// them. position_at(i) is the position of particle i at the last update. If is_known is false, the
/// last update was with other particles, and the search is updated at the present positions. The
/// particles are not moved. Returns is_known. Throws if what is read has positions although
/// is_known is false.
template <class Archive, class P, class PositionAt, class Update>
bool transfer_update(Archive& archive, P& particles, bool is_known, PositionAt&& position_at,
                     Update&& update) {
  std::vector<typename P::Vec> x;
  if (!Archive::reads && is_known) {
    for (Index i = 0; i < particles.local(); ++i) x.push_back(position_at(i));
  }
  archive("is_known", is_known);
  archive("positions", x);
  if constexpr (Archive::reads) {
    if (!is_known && !x.empty()) {
      fail({"search: is_known = 0, but there are ", x.size(),
            " positions; use an earlier checkpoint"});
    }
    if (!is_known) {
      const auto now = particles.with_halo(position);
      x.assign(now.begin(), now.end());
    }
    at_positions(particles, x, update);
  }
  return is_known;
}

}  // namespace silt
