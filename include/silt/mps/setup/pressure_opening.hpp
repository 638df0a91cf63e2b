// SPDX-License-Identifier: MIT
// An opening at which the pressure is given: fluid enters or leaves as it drives it.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/setup/plane_of_opening.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::mps {

/// The pressure of water at rest below a level [Pa], and 0 above it.
struct HydrostaticPressure {
  double level = 0;       ///< height, the last coordinate [m]
  double density = 1000;  ///< [kg/m³], above 0
  double gravity = 9.81;  ///< [m/s²], at least 0
  double at_level = 0;    ///< [Pa]

  /// At a point [m], whatever the time [Pa].
  template <int Dim>
  double operator()(const Vec<Dim>& x, double) const {
    const double depth = level - x[Dim - 1];
    return depth > 0 ? at_level + density * gravity * depth : 0;
  }
  /// Throws if a number is out of range.
  void check() const {
    require_finite("HydrostaticPressure: level", level);
    require_positive("HydrostaticPressure: density", density);
    require_not_negative("HydrostaticPressure: gravity", gravity);
    require_finite("HydrostaticPressure: at_level", at_level);
  }
};

/// Observer for an opening at which the pressure is given. The fluid ends there, as at a free
/// surface, with the pressure that surface_pressure() gives: FlowSettings::surface_pressure has to
/// be surface_pressure_of() all openings. Particles that pass the opening are removed; where
/// fluid has moved in by a spacing, a particle is added. There is fluid where the pressure is above
/// 0.
template <int Dim>
class PressureOpening {
 public:
  using Vec = silt::Vec<Dim>;
  /// Where the opening is, and its pressure.
  struct Settings {
    std::vector<Face<Dim>> faces = {};  ///< in one plane, and not among the walls of the flow
    Vec inwards = Vec::Zero();          ///< normal to the faces, into the fluid, of any length [-]
    double spacing = 0;                 ///< l0 [m], that of the flow
    /// [Pa] at a point of the opening [m] and a time [s], where it is negative 0; called from
    /// several threads, on which the result must not depend.
    std::function<double(const Vec& x, double t)> pressure = {};
  };

  /// Throws if the faces are none, invalid or not in one plane, if the direction is not normal to
  /// them, if a setting is missing, if a HydrostaticPressure is out of range, or if the opening is
  /// not wide enough for particles.
  explicit PressureOpening(const Settings& settings)
      : settings_(checked(settings)),
        plane_(std::make_shared<const detail::PlaneOfOpening<Dim>>(
            "PressureOpening", settings.faces, settings.inwards, settings.spacing)) {}

  /// The pressure at the opening, elsewhere 0.
  std::function<double(const Vec& x, double t)> surface_pressure() const {
    const double depth = 1.5 * settings_.spacing;
    return [plane = plane_, pressure = settings_.pressure, depth](const Vec& x, double t) {
      const double distance = plane->distance(x);
      if (!(std::abs(distance) < depth) || !plane->faces_it(x, depth)) return 0.0;
      const double p = pressure(x - distance * plane->normal(), t);
      return p < 0 ? 0.0 : p;  // not a number: the flow throws
    };
  }

  Index number_in() const noexcept { return in_; }    ///< of particles added so far
  Index number_out() const noexcept { return out_; }  ///< of particles removed so far
  /// Of the particles added less those removed so far [m³], in 2D [m²].
  double volume() const noexcept {
    return (double(in_) - double(out_)) * std::pow(settings_.spacing, Dim);
  }

  /// Removes what has left, and adds what has to enter. Throws if the spacing is not that of the
  /// flow, or if the flow has no surface pressure.
  template <class Sim>
  void before_step(Sim& simulation) {
    using P = std::remove_cvref_t<decltype(simulation.particles())>;
    static_assert(P::dimension == Dim,
                  "silt::mps::PressureOpening: the particles have another dimension");
    static_assert(
        silt::detail::are_of_one_process<P>,
        "silt::mps::PressureOpening: particles cannot be added to those that processes share");
    const auto& settings = simulation.interaction().settings();
    if (settings.spacing != settings_.spacing) {
      fail({"PressureOpening: spacing = ", settings_.spacing, " m is not that of the flow, ",
            settings.spacing, " m; give the same"});
    }
    if (!settings.surface_pressure) {
      fail(
          "PressureOpening: the flow has no FlowSettings::surface_pressure; set it to "
          "surface_pressure_of(…) all openings");
    }
    const auto near = near_opening(std::as_const(simulation.particles()));
    remove(simulation.particles(), near);
    add(simulation.particles(), near, simulation.time());
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("in", in_);
    archive("out", out_);
  }

 private:
  struct Known {
    Index index;
    Vec position;
    double distance;  // from the plane [m]
    Vec velocity;
  };

  static const Settings& checked(const Settings& settings) {
    require_positive("PressureOpening: spacing", settings.spacing);
    require_finite("PressureOpening: inwards", settings.inwards);
    const double square = settings.inwards.squaredNorm();
    if (!(square > 0) || !is_finite(square)) {
      fail({"PressureOpening: inwards = ", to_text(settings.inwards),
            " has no direction, or a square that underflows or overflows; give the one into the "
            "fluid"});
    }
    if (!settings.pressure) {
      fail("PressureOpening: there is no pressure; give a function of position and time");
    }
    if (const auto* given = settings.pressure.template target<HydrostaticPressure>()) {
      given->check();
    }
    return settings;
  }

  template <class P>
  Buffer<Known> near_opening(const P& particles) const {
    const auto x = particles[position];
    const auto u = particles[velocity];
    const double l0 = settings_.spacing;
    Buffer<Known> near;
    for (Index i = 0; i < particles.size(); ++i) {
      const Vec at = x[i].template cast<double>();
      const double distance = plane_->distance(at);
      if (std::abs(distance) < 3 * l0 && plane_->faces_it(at, l0)) {
        near.push_back({i, at, distance, u[i].template cast<double>()});
      }
    }
    return near;
  }
  template <class P>
  void remove(P& particles, const Buffer<Known>& near) {
    Buffer<Index> gone;  // in ascending order
    for (const Known& each : near) {
      if (each.distance < 0) gone.push_back(each.index);
    }
    if (gone.empty()) return;
    out_ += particles.remove_if(
        [&](Index i) { return std::binary_search(gone.begin(), gone.end(), i); });
  }
  template <class P>
  void add(P& particles, const Buffer<Known>& near, double time) {
    using Real = typename P::Real;
    const double l0 = settings_.spacing;
    for (const Vec& point : plane_->points()) {
      const double p = settings_.pressure(point, time);
      if (!(p > 0)) continue;
      // The nearest one of its column, or, if there is none, of all.
      const Known* nearest = nullptr;
      double least = 3 * l0;
      for (const Known& each : near) {
        if (each.distance < 0) continue;
        const Vec across = each.position - each.distance * plane_->normal() - point;
        if (max_norm(across) < 0.5 * l0 && each.distance < least) {
          nearest = &each;
          least = each.distance;
        }
      }
      if (nearest == nullptr) continue;
      const double speed = nearest->velocity.dot(plane_->normal());
      if (!(speed > 0) || least < l0) continue;
      const Vec x = point + std::min(least - l0, l0 / 2) * plane_->normal();
      constexpr double closest = 0.8;
      const bool has_room = std::none_of(near.begin(), near.end(), [&](const Known& each) {
        return each.distance >= 0 && (each.position - x).norm() < closest * l0;
      });
      if (!has_room) continue;
      const Index i = particles.add(typename P::Vec(x.template cast<Real>()));
      particles[velocity][i] = Vec(speed * plane_->normal()).template cast<Real>();
      particles[pressure][i] = static_cast<Real>(p);
      particles[kind][i] = Kind::fluid;
      ++in_;
    }
  }

  Settings settings_;
  std::shared_ptr<const detail::PlaneOfOpening<Dim>> plane_;
  Index in_ = 0;
  Index out_ = 0;
};

/// FlowSettings::surface_pressure of a flow with these openings [Pa].
template <int Dim, class... Others>
std::function<double(const Vec<Dim>& x, double t)> surface_pressure_of(
    const PressureOpening<Dim>& opening, const Others&... others) {
  if constexpr (sizeof...(others) == 0) {
    return opening.surface_pressure();
  } else {
    return [own = opening.surface_pressure(), further = surface_pressure_of(others...)](
               const Vec<Dim>& x, double t) { return own(x, t) + further(x, t); };
  }
}

}  // namespace silt::mps
