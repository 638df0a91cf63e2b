// SPDX-License-Identifier: MIT
// Mass and moment of inertia of a homogeneous body that is the union of balls, in 2D of discs,
// which may overlap. In 2D the moments follow from integrals along the arcs of the outline (Green's
// theorem); in 3D the body is cut into planes, whose moments are integrated along the third axis.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/ball.hpp>
#include <silt/geometry/mass_properties.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt {

namespace detail {

/// Volume of a region and its first and second moments, ∫dV, ∫x_k dV, ∫x_k x_l dV.
template <int Dim>
struct Moments {
  double volume = 0;
  Vec<Dim> first = Vec<Dim>::Zero();
  Eigen::Matrix<double, Dim, Dim> second = Eigen::Matrix<double, Dim, Dim>::Zero();

  Moments& operator+=(const Moments& more) {
    volume += more.volume;
    first += more.first;
    second += more.second;
    return *this;
  }
  friend Moments operator*(double factor, const Moments& of) {
    return {factor * of.volume, factor * of.first, factor * of.second};
  }
  /// The largest difference of any of them, in units of those of a cube of this size [m].
  double difference(const Moments& other, double size) const {
    const double unit = std::pow(size, Dim);
    return std::max({std::abs(volume - other.volume) / unit,
                     (first - other.first).cwiseAbs().maxCoeff() / (unit * size),
                     (second - other.second).cwiseAbs().maxCoeff() / (unit * size * size)});
  }
};

/// ∫ f(t) dt from a to b by Gauss's rule of eight points.
template <class Value, class F>
Value integral(double a, double b, F&& f) {
  constexpr std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                        0.9602898564975363};
  constexpr std::array<double, 4> weights{0.3626837833783620, 0.3137066458778873,
                                          0.2223810344533745, 0.1012285362903763};
  Value sum{};
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    for (const double side : {-1.0, 1.0}) {
      sum += (b - a) / 2 * weights[k] * f((a + b) / 2 + side * (b - a) / 2 * nodes[k]);
    }
  }
  return sum;
}

/// The parts of the outline of disc i that are in no other disc, as angles from and to [rad].
inline std::vector<std::array<double, 2>> free_arcs(std::span<const Ball<2>> discs, std::size_t i) {
  constexpr double turn = 2 * std::numbers::pi;
  std::vector<std::array<double, 2>> covered;
  const double r = discs[i].radius;
  for (std::size_t j = 0; j < discs.size(); ++j) {
    if (j == i) continue;
    const Vec<2> to = discs[j].centre - discs[i].centre;
    const double d = to.norm();
    const double s = discs[j].radius;
    if (d >= r + s) continue;
    const bool is_within = s >= d + r, contains = r >= d + s;
    if (is_within && (!contains || j < i)) return {};  // of equal ones the first counts
    if (contains) continue;
    const double cosine = std::clamp((d * d + r * r - s * s) / (2 * d * r), -1.0, 1.0);
    const double half = std::acos(cosine);
    double from = std::atan2(to.y(), to.x()) - half;
    if (from < 0) from += turn;
    covered.push_back({from, std::min(from + 2 * half, turn)});
    if (from + 2 * half > turn) covered.push_back({0, from + 2 * half - turn});
  }
  std::sort(covered.begin(), covered.end());
  std::vector<std::array<double, 2>> arcs;
  double end = 0;
  for (const auto& [from, to] : covered) {
    if (from > end) arcs.push_back({end, from});
    end = std::max(end, to);
  }
  if (end < turn) arcs.push_back({end, turn});
  return arcs;
}

inline Moments<2> moments_of_union(std::span<const Ball<2>> discs) {
  Moments<2> sum;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const double r = discs[i].radius;
    const auto along_outline = [&](double angle) {
      const Vec<2> out(std::cos(angle), std::sin(angle));
      const Vec<2> at = discs[i].centre + r * out;
      // ∫x^a y^b dV along the normal: of a field with this divergence.
      Moments<2> part;
      part.volume = at.dot(out) / 2;
      part.first = Vec<2>(at.x() * at.x() * out.x(), at.y() * at.y() * out.y()) / 2;
      part.second(0, 0) = at.x() * at.x() * at.x() * out.x() / 3;
      part.second(1, 1) = at.y() * at.y() * at.y() * out.y() / 3;
      part.second(0, 1) = part.second(1, 0) = at.x() * at.x() * at.y() * out.x() / 2;
      return r * part;
    };
    for (const auto& [from, to] : free_arcs(discs, i)) {
      const int pieces = 1 + int((to - from) / (std::numbers::pi / 4));
      const double piece = (to - from) / pieces;
      for (int k = 0; k < pieces; ++k) {
        sum += integral<Moments<2>>(from + k * piece, from + (k + 1) * piece, along_outline);
      }
    }
  }
  return sum;
}

/// Of what lies in the plane z, per length of z.
inline Moments<3> moments_of_cut(std::span<const Ball<3>> balls, double z) {
  std::vector<Ball<2>> discs;
  for (const Ball<3>& ball : balls) {
    const double up = z - ball.centre.z();
    const double squared = (ball.radius - up) * (ball.radius + up);
    if (squared > 0) discs.push_back({ball.centre.head<2>(), std::sqrt(squared)});
  }
  const Moments<2> cut = moments_of_union(discs);
  Moments<3> moments;
  moments.volume = cut.volume;
  moments.first << cut.first, z * cut.volume;
  moments.second.topLeftCorner<2, 2>() = cut.second;
  moments.second.topRightCorner<2, 1>() = z * cut.first;
  moments.second.bottomLeftCorner<1, 2>() = z * cut.first.transpose();
  moments.second(2, 2) = z * z * cut.volume;
  return moments;
}

/// Between two planes, halved until the error is round-off of a body of this size [m].
inline Moments<3> moments_between(std::span<const Ball<3>> balls, double from, double to,
                                  double size, int halvings = 0) {
  // t³ has no slope at the ends, where a cut may begin like a root.
  const auto whole = [&](double a, double b) {
    return integral<Moments<3>>(-1, 1, [&](double t) {
      const double s = (3 * t - t * t * t) / 2;
      return (b - a) / 2 * 1.5 * (1 - t * t) * moments_of_cut(balls, (a + b) / 2 + s * (b - a) / 2);
    });
  };
  const double middle = (from + to) / 2;
  Moments<3> halves = whole(from, middle);
  halves += whole(middle, to);
  const bool is_exact = halves.difference(whole(from, to), size) < 1e-12;
  if (is_exact || halvings == 12) return halves;
  Moments<3> sum = moments_between(balls, from, middle, size, halvings + 1);
  sum += moments_between(balls, middle, to, size, halvings + 1);
  return sum;
}

/// The balls in groups that overlap, each with what it overlaps.
inline std::vector<std::vector<Ball<3>>> connected(std::span<const Ball<3>> balls) {
  std::vector<std::vector<Ball<3>>> groups;
  std::vector<char> is_taken(balls.size(), 0);
  for (std::size_t first = 0; first < balls.size(); ++first) {
    if (is_taken[first]) continue;
    is_taken[first] = 1;
    groups.push_back({balls[first]});
    for (std::size_t k = 0; k < groups.back().size(); ++k) {
      const Ball<3> ball = groups.back()[k];
      for (std::size_t j = first + 1; j < balls.size(); ++j) {
        const double reach = ball.radius + balls[j].radius;
        if (is_taken[j] || !((balls[j].centre - ball.centre).squaredNorm() < reach * reach))
          continue;
        is_taken[j] = 1;
        groups.back().push_back(balls[j]);
      }
    }
  }
  return groups;
}

/// Of balls that overlap.
inline Moments<3> moments_of_group(std::span<const Ball<3>> balls) {
  if (balls.size() == 1) {
    const auto& [centre, r] = balls[0];
    const double volume = 4 * std::numbers::pi / 3 * r * r * r;
    const Eigen::Matrix<double, 3, 3> own = Eigen::Matrix<double, 3, 3>::Identity() * (r * r / 5);
    return {volume, volume * centre, volume * (own + centre * centre.transpose())};
  }
  // Cuts are smooth between the ends of balls and of the circles in which two of them meet.
  std::vector<double> ends;
  for (const Ball<3>& ball : balls) {
    ends.push_back(ball.centre.z() - ball.radius);
    ends.push_back(ball.centre.z() + ball.radius);
  }
  for (std::size_t i = 0; i < balls.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec<3> to = balls[j].centre - balls[i].centre;
      const double d = to.norm();
      const double r = balls[i].radius, s = balls[j].radius;
      if (d >= r + s || d <= std::abs(r - s)) continue;
      const double along = (d * d + r * r - s * s) / (2 * d);
      const double radius = std::sqrt(std::max(0.0, r * r - along * along));
      const double up = to.z() / d;
      const double z = balls[i].centre.z() + along * up;
      const double half = radius * std::sqrt(std::max(0.0, 1 - up * up));
      ends.push_back(z - half);
      ends.push_back(z + half);
    }
  }
  std::sort(ends.begin(), ends.end());
  const double size = ends.back() - ends.front();
  Moments<3> sum;
  for (std::size_t k = 1; k < ends.size(); ++k) {
    if (ends[k] - ends[k - 1] > 1e-13 * size) {
      sum += moments_between(balls, ends[k - 1], ends[k], size);
    }
  }
  return sum;
}

inline Moments<3> moments_of_union(std::span<const Ball<3>> balls) {
  Moments<3> sum;
  for (const std::vector<Ball<3>>& group : connected(balls)) sum += moments_of_group(group);
  return sum;
}

}  // namespace detail

/// Those of a homogeneous body [kg/m³] of these balls; what belongs to several counts once.
/// Relative error about 1e-9. Throws if there are none, or if a centre, a radius or the density is
/// not possible; `name` identifies them.
template <int Dim>
MassProperties<Dim> mass_properties_of(const std::string& name, std::span<const Ball<Dim>> balls,
                                       double density) {
  require_positive(name + ": density", density);
  if (balls.empty()) fail({name, ": there are no spheres; give at least one"});
  for (const Ball<Dim>& ball : balls) {
    require_finite(name + ": centre of a sphere", ball.centre);
    require_positive(name + ": radius of a sphere", ball.radius);
  }
  // About the first centre, for coordinates far from the origin.
  const Vec<Dim> origin = balls[0].centre;
  std::vector<Ball<Dim>> moved(balls.begin(), balls.end());
  for (Ball<Dim>& ball : moved) ball.centre -= origin;
  const auto moments = detail::moments_of_union(std::span<const Ball<Dim>>(moved));
  return homogeneous(origin, density, moments.volume, moments.first, moments.second);
}

}  // namespace silt
