// SPDX-License-Identifier: MIT
// Observer that removes the fluid that has left.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <cmath>
#include <utility>

namespace silt::mps {

/// Observer that removes, before a step, the fluid particles in a box, and counts them, those of
/// all processes that share the particles. The box may be unbounded: with a single finite side, all
/// that passes a plane is removed. Beyond it there is nothing: fluid that comes to it is free to
/// leave, and has a free surface there. Where it arrives with pressure, as in subcritical flow,
/// this acts upstream.
template <int Dim>
class Outflow {
 public:
  /// Throws if the box is invalid, or infinite on all sides.
  explicit Outflow(const Box<Dim>& box) : region_(box) {
    region_.check();
    for (int k = 0; k < Dim; ++k) {
      if (is_finite(box.lower[k]) || is_finite(box.upper[k])) return;
    }
    fail(
        "Outflow: the box is infinite on all sides, so that all fluid would be removed; give it a "
        "finite side, beyond which fluid has left");
  }

  Index number() const noexcept { return number_; }   ///< of particles removed so far
  double volume() const noexcept { return volume_; }  ///< of those [m³], in 2D [m²]

  template <class Sim>
  void before_step(Sim& simulation) {
    const auto& particles = std::as_const(simulation.particles());  // only removal changes them
    using P = std::remove_cvref_t<decltype(particles)>;
    static_assert(P::dimension == Dim, "silt::mps::Outflow: the particles have another dimension");
    const auto x = particles[position];
    const auto kinds = particles[kind];
    const auto is_in = [&](Index i) {
      return kinds[i] == Kind::fluid && region_.contains(x[i].template cast<double>());
    };
    double own = 0;
    silt::detail::together(particles, [&] {
      if (first_where(particles.size(), is_in) != no_index) {
        own = double(simulation.particles().remove_if(is_in));
      }
      return Largest{};
    });
    const double all = silt::detail::sum_of_all(particles, own);
    number_ += Index(all);
    volume_ += all * std::pow(simulation.interaction().settings().spacing, Dim);
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number_);
    archive("volume", volume_);
  }

 private:
  Box<Dim> region_;
  Index number_ = 0;
  double volume_ = 0;
};

}  // namespace silt::mps
