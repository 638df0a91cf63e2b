// SPDX-License-Identifier: MIT
// A pressure gauge at a point of a wall without particles.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/fluid_load.hpp>
#include <silt/geometry/sight.hpp>
#include <silt/measure/wall_group.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

namespace detail {

/// Differences of positions [m] between the nearest images in a box.
template <int Dim, class Real>
NearestImage<Dim, double> nearest_image_in(const Box<Dim, Real>& box) {
  return NearestImage<Dim, double>(Box<Dim>{.lower = box.lower.template cast<double>(),
                                            .upper = box.upper.template cast<double>(),
                                            .periodic = box.periodic});
}

/// The linear function with the least squared deviation from values around a point. Positions are
/// in spacings, from the point.
template <int Dim>
class LinearFit {
 public:
  static constexpr double range = 2;  // of the weights

  static double weight(const Vec<Dim>& r) {
    const double q2 = r.squaredNorm() / squared(range);
    return q2 < 1 ? squared(1 - q2) : 0;
  }
  void add(const Vec<Dim>& r, double w, double value) {
    weights_ += w;
    mean_ += w * value;
    centre_ += w * r;
    slope_ += (w * value) * r;
    for (int k = 0; k < Dim; ++k) moments_.col(k) += (w * r[k]) * r;
  }
  template <class P>
  void add_all_processes(const P& particles) {
    for (const auto sum :
         {std::span(&weights_, 1), std::span(&mean_, 1), std::span(centre_.data(), Dim),
          std::span(slope_.data(), Dim), std::span(moments_.data(), Dim * Dim)}) {
      replace_by_sums(particles, sum);
    }
  }
  double weights() const { return weights_; }
  /// At the point, for weights() > 0.
  double value() const {
    constexpr double ridge = 0.005;  // ε
    // About the centre of the particles, a is the mean and independent of b.
    const double mean = mean_ / weights_;
    const Vec<Dim> centre = centre_ / weights_;
    Vec<Dim> slope = slope_ - (weights_ * mean) * centre;
    Matrix moments = moments_;
    for (int k = 0; k < Dim; ++k) moments.col(k) -= (weights_ * centre[k]) * centre;
    moments.diagonal().array() += ridge * weights_;
    slope = multiply<Dim, double>(moments.inverse(), slope);
    return mean - slope.dot(centre);
  }

 private:
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  double weights_ = 0, mean_ = 0;
  Vec<Dim> centre_ = Vec<Dim>::Zero(), slope_ = Vec<Dim>::Zero();
  Matrix moments_ = Matrix::Zero();
};

}  // namespace detail

template <int Dim, Field F>
struct GaugeOfField;

/// Extrapolates a scalar field of the fluid before a wall to a point of the wall: the linear
/// function with the least squared deviation from the particles within two spacings,
///
///   Σ_j w_j (a + b·(x_j − point) − φ_j)² + ε Σ_j w_j |b|² l0²,   w = (1 − (r/2 l0)²)²,   ε =
///   0.005,
///
/// because of ε few particles give their mean, and a linear field has an error of up to 3 % of its
/// change over a spacing. Where particles are few, as when a drop passes, dry parts of the wall
/// count as zero.
template <int Dim>
struct WallGauge {
  Vec<Dim> point = Vec<Dim>::Zero();  ///< on the wall [m]
  /// Of the wall, into the fluid, of any length [-]. If it is zero, a gauge that reads a simulation
  /// takes the normal of the face that is nearest to the point, and the side with more fluid.
  Vec<Dim> normal = Vec<Dim>::Zero();
  double spacing = 0;  ///< l0 [m]
  /// Walls where point and normal are defined, and with which they move.
  WallGroup moves_with = {};

  /// In the middle of a face, on the side of its normal. Throws if the face has no size.
  static WallGauge at(const Face<Dim>& face, double spacing, WallGroup moves_with = {}) {
    require_size("WallGauge: face", face);
    Vec<Dim> middle = Vec<Dim>::Zero();
    for (const Vec<Dim>& corner : face.corners) middle += corner / Dim;
    return {middle, normal_of(face), spacing, moves_with};
  }

  /// For a file of readings of a field, see CsvSeries.
  template <Field F>
  GaugeOfField<Dim, F> of(F) const {
    return {*this};
  }

  /// Returns a [unit of the field], not below 0, times Σ w_j over a quarter of that before a flat
  /// wall, if it is less: in a corner of three walls it is not. All particles on the side of the
  /// normal count, whatever is between: prefer read(simulation, field). Of particles that processes
  /// share, all call it. Throws if the spacing is not positive or the normal zero.
  template <ParticleSet P, Field F>
  double read(const P& particles, F field) const {
    static_assert(P::dimension == Dim, "silt::WallGauge: the particles have another dimension");
    check();
    if (!(normal.norm() > 0)) fail("WallGauge: normal = 0; give that of the wall, into the fluid");
    detail::LinearFit<Dim> fit;
    const auto x = particles[position];
    const auto values = particles[field];
    for (Index j = 0; j < particles.size(); ++j) {
      const Vec<Dim> r = (x[j].template cast<double>() - point) / spacing;
      const double w = Fit::weight(r);
      if (w > 0 && r.dot(normal) > 0) fit.add(r, w, double(values[j]));
    }
    fit.add_all_processes(particles);
    if (!(fit.weights() > 0)) return 0;
    return std::min(1.0, fit.weights() / (of_half_space / 4)) * std::max(0.0, fit.value());
  }

  /// The same of the fluid in sight of the point, none of which is behind another wall. The factor
  /// is that of the fluid at the wall, over a fifth, straight before it and closer than a spacing
  /// (half of it at 1.25): a sheet that passes at a distance, or beyond an edge, is no pressure of
  /// the wall. Throws also if there is no wall within a spacing of the point, or no such group.
  template <class Sim, Field F>
    requires detail::has_walls_of_faces<Sim>
  double read(const Sim& simulation, F field) const {
    const auto& particles = simulation.particles();
    static_assert(std::remove_cvref_t<decltype(particles)>::dimension == Dim,
                  "silt::WallGauge: the flow has another dimension");
    check();
    const detail::WallsNow<Dim> walls(simulation);
    const std::uint32_t group = moves_with.template number_in<Dim>(simulation, "WallGauge");
    const Place place(
        *this, walls.pose_of(group),
        [&](const Vec<Dim>& x, double distance, auto&& f) { walls.for_each_near(x, distance, f); });
    const auto x = particles[position];
    const auto values = particles[field];
    const auto nearest = detail::nearest_image_in(particles.box());
    std::array<SideOfWall, 2> sides;
    for (Index j = 0; j < particles.size(); ++j) {
      const Vec<Dim> from_point = nearest(Vec<Dim>(x[j].template cast<double>() - place.point));
      const Vec<Dim> r = from_point / spacing, at = place.point + from_point;
      const double w = Fit::weight(r);
      if (!(w > 0)) continue;
      for (const std::size_t side : {0u, 1u}) {
        const double height = place.normals[side].dot(r);
        if (!(height > 0) || !sees<Dim>(place.faces, place.viewpoint(side, spacing), at)) continue;
        sides[side].fit.add(r, w, double(values[j]));
        sides[side].at_wall += w * place.share_at_wall(at, side, spacing);
      }
    }
    for (SideOfWall& side : sides) {
      side.fit.add_all_processes(particles);
      side.at_wall = detail::sum_of_all(particles, side.at_wall);
    }
    const bool is_second = !place.has_side && sides[1].at_wall > sides[0].at_wall;
    const SideOfWall& side = sides[is_second ? 1 : 0];
    if (!(side.at_wall > 0)) return 0;
    return std::min(1.0, side.at_wall / (of_layer / 5)) * std::max(0.0, side.fit.value());
  }

  /// The mean pressure [Pa] by the load of the last step, see WallLoad, on the wall around the
  /// point: the force on it with the weight (1 − (r/2 l0)²)², along the normal, over the integral
  /// of this weight. It contains what stops the fluid without a pressure, collisions and the ends
  /// of moves before walls, so that it agrees with WallLoad in impacts, where read() is too low. In
  /// the corners of walls that are oblique to the axes it is up to a sixth too low. Zero where no
  /// fluid is at the wall, before the first step, and after reading a checkpoint until the next
  /// one.
  template <class Sim>
    requires detail::has_walls_of_faces<Sim>
  double read_load(const Sim& simulation) const {
    check();
    const auto& flow = simulation.interaction();
    const auto& particles = simulation.particles();
    const auto& walls = flow.walls().faces();
    const std::uint32_t group = moves_with.template number_in<Dim>(simulation, "WallGauge");
    double pressure = 0;
    BodyLoad<Dim> load;
    const Place place(*this, group > 0 ? walls.step_of(group).before : Pose<Dim>{},
                      [&](const Vec<Dim>& x, double distance, auto&& f) {
                        walls.for_each_near(x, distance,
                                            [&](std::uint32_t k) { f(walls[k].face); });
                      });
    const double all = place.weight_of_wall(spacing);
    if (!(simulation.last_time_step() > 0) || !(all > 0)) return pressure;
    const FluidLoad<Dim> by_fluid(walls, particles.box(),
                                  {.density = flow.settings().density,
                                   .spacing = flow.settings().spacing,
                                   .time_step = simulation.last_time_step()});
    const auto nearest = detail::nearest_image_in(particles.box());
    BoundsOfFaces<Dim> bounds;
    for (int k = 0; k < Dim; ++k) {
      const double range = particles.box().periodic[std::size_t(k)]
                               ? std::numeric_limits<double>::infinity()
                               : Fit::range * spacing;
      bounds.lower[k] = place.point[k] - range;
      bounds.upper[k] = place.point[k] + range;
    }
    const auto load_on = [&](std::size_t side) {
      const auto& changes = flow.momentum_changes();
      const double fluid_in_sight = detail::sum_of_all(
          particles, ordered_sum(changes.size(), 0.0, [&](Index i) {
            const Vec<Dim> from_point = nearest(Vec<Dim>(changes[i].position - place.point));
            const Vec<Dim> x = place.point + from_point;
            const double w = Fit::weight(Vec<Dim>(from_point / spacing));
            return w > 0 && sees<Dim>(place.faces, place.viewpoint(side, spacing), x) ? w : 0.0;
          }));
      if (!(fluid_in_sight > 0)) return 0.0;
      const auto share_of = [&](const Vec<Dim>& x, const typename FluidLoad<Dim>::SeenWall& seen) {
        if (!is_finite(seen.face.distance) || !((x - seen.foot).dot(place.normals[side]) > 0))
          return 0.0;
        return place.is_of_wall(walls[seen.face.element].normal)
                   ? Fit::weight(Vec<Dim>(nearest(Vec<Dim>(seen.foot - place.point)) / spacing))
                   : 0.0;
      };
      detail::together(particles, [&] {
        load =
            by_fluid.sum(changes, bounds, place.point, share_of, [](const auto&) { return false; });
        return Largest{};
      });
      return -FluidLoad<Dim>::sum_of_all(particles, load).force.dot(place.normals[side]) / all;
    };
    pressure = load_on(0);
    // Without fluid there is no load.
    if (!place.has_side) {
      const double behind = load_on(1);
      if (std::abs(behind) > std::abs(pressure)) pressure = behind;
    }
    return pressure;
  }

 private:
  using Fit = detail::LinearFit<Dim>;
  // ∫ w dV before a flat wall over l0^Dim, and with the factor for fluid at the wall.
  static constexpr double of_half_space = (Dim == 2 ? 2.0 / 3 : 128.0 / 105) * std::numbers::pi;
  static constexpr double of_layer = Dim == 2 ? 1.9274 : 3.5953;

  struct SideOfWall {
    Fit fit;
    double at_wall = 0;  // weights
  };

  void check() const {
    require_positive("WallGauge: spacing", spacing);
    require_finite("WallGauge: point", point);
    require_finite("WallGauge: normal", normal);
  }

  // Where the gauge is, and the walls around it.
  struct Place {
    Vec<Dim> point;
    std::array<Vec<Dim>, 2> normals;  // that of the gauge, and the opposite one
    bool has_side;                    // whether it is given
    Vec<Dim> inside;                  // a point inside of the face, where lines of sight begin [m]
    Vec<Dim> normal_of_face;
    std::vector<Face<Dim>> faces;

    // near(x, distance, f) calls f(face) for those around x.
    template <class Near>
    Place(const WallGauge& gauge, const Pose<Dim>& pose, Near&& near)
        : has_side(gauge.normal.norm() > 0) {
      const double l0 = gauge.spacing;
      const Vec<Dim> x = pose.x_of(gauge.point);
      near(x, (Fit::range + 1) * l0, [&](const Face<Dim>& face) { faces.push_back(face); });
      const Vec<Dim> wanted = multiply<Dim, double>(pose.rotation, gauge.normal);
      const Face<Dim>* nearest = nullptr;
      double least = std::numeric_limits<double>::infinity(), most_along = 0;
      for (const Face<Dim>& face : faces) {
        const double distance = (nearest_of(face, x) - x).norm();
        const double along = std::abs(normal_of(face).dot(wanted));
        constexpr double same = 1e-6;  // spacings: in a corner, the face along the normal
        if (distance > least + same * l0) continue;
        if (distance > least - same * l0 && along <= most_along) continue;
        nearest = &face, least = distance, most_along = along;
      }
      if (nearest == nullptr || least > l0) {
        fail({"WallGauge: there is no wall of the flow within a spacing, ", l0, " m, of the point ",
              to_text(x), " m; give a point of a wall, and moves_with if that moves"});
      }
      point = nearest_of(*nearest, x);
      normal_of_face = silt::normal_of(*nearest);
      if (has_side && normal_of_face.dot(wanted) < 0) normal_of_face = -normal_of_face;
      normals[0] = has_side ? Vec<Dim>(wanted.normalized()) : normal_of_face;
      normals[1] = -normals[0];
      Vec<Dim> middle = Vec<Dim>::Zero();
      for (const Vec<Dim>& corner : nearest->corners) middle += corner / Dim;
      const double to_middle = (middle - point).norm();
      constexpr double shift = 1e-3;  // spacings
      inside = point + std::min(1.0, shift * l0 / std::max(to_middle, 1e-300)) * (middle - point);
    }
    Vec<Dim> viewpoint(std::size_t side, double l0) const {
      constexpr double before_face = 1e-4;  // spacings
      return inside + (side == 0 ? before_face : -before_face) * l0 * normal_of_face;
    }

    // Of a particle: whether it is straight before the wall, and close to it.
    double share_at_wall(const Vec<Dim>& x, std::size_t side, double l0) const {
      double share = 0;
      for (const Face<Dim>& face : faces) {
        if (!is_of_wall(silt::normal_of(face))) continue;
        const Vec<Dim> r = x - nearest_of(face, x);
        constexpr double straight = 0.96;  // between the faces of a curved wall
        if (r.dot(normals[side]) < straight * r.norm()) continue;
        share = std::max(share, std::clamp(2 * (1.5 - r.norm() / l0), 0.0, 1.0));
      }
      return share;
    }
    // Of a wall that goes on without an edge.
    bool is_of_wall(const Vec<Dim>& of_face) const {
      constexpr double cos_30 = 0.866;
      return std::abs(of_face.dot(normal_of_face)) > cos_30;
    }
    // ∫ w dA over the wall, over a grid in the tangential plane [m²], in 2D [m].
    double weight_of_wall(double l0) const {
      std::vector<Face<Dim>> of_wall;
      for (const Face<Dim>& face : faces) {
        if (is_of_wall(silt::normal_of(face))) of_wall.push_back(face);
      }
      std::array<Vec<Dim>, std::size_t(Dim) - 1> axes;
      if constexpr (Dim == 2) {
        axes[0] = {-normal_of_face[1], normal_of_face[0]};
      } else {
        int smallest;
        normal_of_face.cwiseAbs().minCoeff(&smallest);
        axes[0] = cross(normal_of_face, Vec<Dim>(Vec<Dim>::Unit(smallest))).normalized();
        axes[1] = cross(normal_of_face, axes[0]);
      }
      constexpr int points = Dim == 2 ? 64 : 24;
      constexpr double step = 2 * Fit::range / points;
      double sum = 0;
      const auto add = [&](const Vec<Dim>& r) {
        const double w = Fit::weight(r);
        if (!(w > 0)) return;
        const Vec<Dim> x = point + l0 * r;
        const bool is_wall =
            std::any_of(of_wall.begin(), of_wall.end(), [&](const Face<Dim>& face) {
              const Vec<Dim> to_face = nearest_of(face, x) - x;
              const Vec<Dim> along =
                  to_face - to_face.dot(silt::normal_of(face)) * silt::normal_of(face);
              return along.norm() < 1e-9 * l0;
            });
        if (is_wall) sum += w;
      };
      for (int k = 0; k < points; ++k) {
        const Vec<Dim> r = ((k + 0.5) * step - Fit::range) * axes[0];
        if constexpr (Dim == 2) {
          add(r);
        } else {
          for (int m = 0; m < points; ++m) add(r + ((m + 0.5) * step - Fit::range) * axes[1]);
        }
      }
      return sum * std::pow(step * l0, Dim - 1);
    }
  };
};

/// A WallGauge that writes a field to a file, and next to the pressure that by the load.
template <int Dim, Field F>
struct GaugeOfField {
  WallGauge<Dim> gauge;

  /// Whether the field is the pressure.
  static constexpr bool is_pressure = name_of<F>() == "pressure";

  /// The name of the field, and pressure_by_load.
  std::vector<std::string> columns() const {
    const std::string name(name_of<F>());
    return is_pressure ? std::vector{name, name + "_by_load"} : std::vector{name};
  }
  /// What the numbers of a row are.
  std::string filter() const {
    std::string text =
        message_of({"gauge on a wall at ", to_text(gauge.point), " m",
                    gauge.moves_with.is_at_rest() ? "" : ", which moves with the wall",
                    ", spacing ", gauge.spacing,
                    " m: linear fit with the weight (1 - (r/2 spacings)^2)^2 to the "
                    "particles in sight within 2 spacings, not below 0, times the wetted share"});
    if (is_pressure) text += "; by load: force on the wall with that weight over its integral";
    return text + "; no average in time";
  }
  /// Those of WallGauge::read() [unit of the field] and read_load() [Pa]. Throws as they do.
  template <class Sim>
  std::vector<double> row(const Sim& simulation) const {
    const double value = gauge.read(simulation, F{});
    if constexpr (is_pressure) return {value, gauge.read_load(simulation)};
    return {value};
  }
};

}  // namespace silt
