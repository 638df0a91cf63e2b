// SPDX-License-Identifier: MIT
// Outflow with a given velocity.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/setup/velocity_opening.hpp>

#include <cmath>
#include <type_traits>
#include <utility>

namespace silt::mps {

/// Observer that lets fluid out through an opening with a given velocity, which is out of the
/// fluid. Its piston() has to be one of the walls of the flow, ImageWalls::moving_2d or
/// moving_3d; the fluid follows it. The volume flow is the speed times the area of the
/// opening that the fluid wets.
template <int Dim>
class Extraction {
 public:
  using Vec = silt::Vec<Dim>;

  /// Throws if the faces are none, invalid or not in one plane, if the velocity is not normal to
  /// them, if a number is out of range, if the opening is not wide enough for particles, or if a
  /// level is set.
  explicit Extraction(const VelocityOpening<Dim>& opening) : piston_("mps::Extraction", opening) {
    if (opening.level < std::numeric_limits<double>::infinity()) {
      fail({"VelocityOpening: level = ", opening.level,
            " m has no meaning for an Extraction, through which all fluid at the faces leaves; "
            "remove it"});
    }
  }

  /// The wall in the opening that moves with the fluid and back.
  MovingFaces<Dim> piston() const { return piston_.faces(); }

  Index number() const noexcept { return number_; }  ///< of particles removed so far
  /// Of the particles removed so far [m³], in 2D [m²].
  double volume() const noexcept {
    return double(number_) * std::pow(piston_.opening().spacing, Dim);
  }

  /// Removes the layer that is due. Throws if the spacing is not that of the flow, if the piston is
  /// none of its walls, or if it was not called before earlier steps.
  template <class Sim>
  void before_step(Sim& simulation) {
    using P = std::remove_cvref_t<decltype(simulation.particles())>;
    static_assert(P::dimension == Dim,
                  "silt::mps::Extraction: the particles have another dimension");
    static_assert(
        silt::detail::are_of_one_process<P>,
        "silt::mps::Extraction: particles cannot be removed from those that processes share");
    const double time = simulation.time();
    piston_.make_layers(time, simulation.interaction().settings().spacing, [&] {
      const auto x = std::as_const(simulation.particles())[position];
      const double l0 = piston_.opening().spacing;
      const double nearest = piston_.motion().place(time) - margin * l0;
      const auto& plane = piston_.plane();
      number_ += simulation.particles().remove_if([&](Index i) {
        const Vec at = x[i].template cast<double>();
        const double distance = plane.distance(at);
        return distance > nearest && distance < 2 * l0 && plane.faces_it(at, l0 / 4);
      });
    });
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    piston_.transfer(archive);
    archive("number", number_);
  }

 private:
  // Spacings before the piston, within which particles are removed, too: their images would be too
  // close.
  static constexpr double margin = 0.25;

  detail::PistonInOpening<Dim> piston_;
  Index number_ = 0;
};

}  // namespace silt::mps
