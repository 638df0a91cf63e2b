// SPDX-License-Identifier: MIT
// Inflow with a given velocity.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/setup/velocity_opening.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace silt::mps {

/// Observer that lets fluid in through an opening with a given velocity, which is into the fluid.
/// Its piston() has to be one of the walls of the flow, ImageWalls::moving_2d or
/// moving_3d. At the beginning, the fluid ends half a spacing before the opening, or there
/// is none. The volume flow is the speed times the area below the level, whatever the pressure. If
/// the surface at the opening is free, it has to stay at the level, as in supercritical flow; fluid
/// that rises above it does so before the piston, but what is added has the height of the level. An
/// opening below the surface, in a floor for example, has no such limit.
template <int Dim>
class Inflow {
 public:
  using Vec = silt::Vec<Dim>;

  /// Throws if the faces are none, invalid or not in one plane, if the velocity is not normal to
  /// them, if a number is out of range, or if the opening is not wide enough for particles.
  explicit Inflow(const VelocityOpening<Dim>& opening) : piston_("mps::Inflow", opening) {}

  /// The wall in the opening that moves with the fluid and back.
  MovingFaces<Dim> piston() const { return piston_.faces(); }

  Index number() const noexcept { return number_; }  ///< of particles added so far
  /// Of the particles added so far [m³], in 2D [m²].
  double volume() const noexcept {
    return double(number_) * std::pow(piston_.opening().spacing, Dim);
  }
  /// The volume flow at a time [s], in [m³/s], in 2D [m²/s].
  double flow_at(double time) const {
    return piston_.motion().speed_at(time) * piston_.plane().area();
  }

  /// Adds the layer that is due. Throws if the spacing is not that of the flow, if the piston is
  /// none of its walls, or if it was not called before earlier steps.
  template <class Sim>
  void before_step(Sim& simulation) {
    using P = std::remove_cvref_t<decltype(simulation.particles())>;
    static_assert(P::dimension == Dim, "silt::mps::Inflow: the particles have another dimension");
    static_assert(silt::detail::are_of_one_process<P>,
                  "silt::mps::Inflow: particles cannot be added to those that processes share");
    const auto& settings = simulation.interaction().settings();
    const double time = simulation.time();
    piston_.make_layers(time, settings.spacing, [&] {
      add_layer(simulation.particles(), settings.density * settings.gravity, time);
    });
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    piston_.transfer(archive);
    archive("number", number_);
  }

 private:
  struct Known {
    Vec position;
    double pressure;
  };

  // Half a layer before the piston; weight is that of the fluid [N/m³].
  template <class P>
  void add_layer(P& particles, const Vec& weight, double time) {
    using Real = typename P::Real;
    const auto& motion = piston_.motion();
    const Vec shift = (motion.place(time) + motion.thickness / 2) * motion.direction;
    const Vec u = motion.speed_at(time) * motion.direction;
    const Buffer<Known> near = near_opening(particles);
    particles.reserve(particles.size() + piston_.plane().points().size());
    for (const Vec& point : piston_.plane().points()) {
      const Vec x = point + shift;
      const double p = pressure_at(x, near, weight);
      const Index i = particles.add(typename P::Vec(x.template cast<Real>()));
      particles[velocity][i] = u.template cast<Real>();
      particles[pressure][i] = static_cast<Real>(p);
      particles[kind][i] = Kind::fluid;
      ++number_;
    }
  }
  template <class P>
  Buffer<Known> near_opening(const P& particles) const {
    const auto& points = piston_.plane().points();
    Vec lower = points[0], upper = lower;
    for (const Vec& point : points) {
      lower = lower.cwiseMin(point);
      upper = upper.cwiseMax(point);
    }
    const auto x = particles[position];
    const auto p = particles[pressure];
    const double reach = 4 * piston_.opening().spacing;
    Buffer<Known> near;
    for (Index i = 0; i < particles.size(); ++i) {
      const Vec at = x[i].template cast<double>();
      if ((lower - at).cwiseMax(at - upper).maxCoeff() < reach) near.push_back({at, double(p[i])});
    }
    return near;
  }
  // That of the nearest particle, continued as at rest: the source of the pressure equation uses
  // the pressures of the last step.
  double pressure_at(const Vec& x, const Buffer<Known>& near, const Vec& weight) const {
    double least = squared(2 * piston_.opening().spacing), found = 0;
    for (const Known& known : near) {
      const double r2 = (known.position - x).squaredNorm();
      if (!(r2 < least)) continue;
      least = r2;
      found = std::max(0.0, known.pressure + weight.dot(x - known.position));
    }
    return found;
  }

  detail::PistonInOpening<Dim> piston_;
  Index number_ = 0;
};

}  // namespace silt::mps
