// SPDX-License-Identifier: MIT
// Fields of chosen particles over time.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/field_numbers.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

/// Follows particles by their ids: their positions, and further fields F.
template <int Dim, Field... F>
class Tracks {
 public:
  /// Throws if there are no ids, or one twice.
  explicit Tracks(std::vector<Id> ids) : ids_(std::move(ids)) {
    if (ids_.empty()) fail("Tracks: no ids; give those of the particles to be followed");
    for (auto id = ids_.begin(); id != ids_.end(); ++id) {
      if (std::find(ids_.begin(), id, *id) == id) continue;
      fail({"Tracks: the id ", *id, " is given twice; give each once"});
    }
  }

  /// Of each particle in turn: x_7, y_7, velocity_x_7 and so on for the one with the id 7.
  std::vector<std::string> columns() const {
    std::vector<std::string> names;
    for (const Id id : ids_) {
      const auto add = [&]<Field Each>() {
        for (const auto& name : detail::number_names<Each, Dim, double>()) {
          names.push_back(name + "_" + std::to_string(id));
        }
      };
      add.template operator()<position_t>();
      (add.template operator()<F>(), ...);
    }
    return names;
  }
  /// What the numbers of a row are.
  std::string filter() const {
    return message_of({"tracks of ", ids_.size(),
                       " particles by their ids: the values that they have then, no average; not a "
                       "number once they have been removed"});
  }
  /// The numbers of columns(): those of particles that were removed are NaN, and positions are
  /// those in a periodic box. With Leapfrog velocities are half a step earlier. Of particles that
  /// processes share, all call it.
  template <class Sim>
  std::vector<double> row(const Sim& simulation) const {
    const auto& particles = simulation.particles();
    using P = std::remove_cvref_t<decltype(particles)>;
    static_assert(P::dimension == Dim, "silt::Tracks: the particles have another dimension");
    static_assert(HasFields<P, F...>, "silt::Tracks: the particles lack one of the fields");
    std::vector<double> numbers, found;
    for (const Id id : ids_) {
      const Index i = particles.index_of(id);
      const bool is_here = i != no_index && i < particles.size();
      const auto add = [&](auto field) {
        using Each = decltype(field);
        const auto count = detail::number_names<Each, Dim, double>().size();
        for (Index k = 0; k < count; ++k) {
          numbers.push_back(is_here ? double(detail::number_of(particles[field][i], k)) : 0.0);
          found.push_back(is_here ? 1.0 : 0.0);
        }
      };
      add(position);
      (add(F{}), ...);
    }
    detail::replace_by_sums(particles, numbers);
    detail::replace_by_sums(particles, found);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (!(found[k] > 0)) numbers[k] = std::numeric_limits<double>::quiet_NaN();
    }
    return numbers;
  }

 private:
  std::vector<Id> ids_;
};

/// Tracks of these fields in addition to the position: `track<2>(ids, velocity, mps::pressure)`.
template <int Dim, Field... F>
Tracks<Dim, F...> track(std::vector<Id> ids, F...) {
  return Tracks<Dim, F...>(std::move(ids));
}

}  // namespace silt
