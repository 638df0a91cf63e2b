// SPDX-License-Identifier: MIT
// How a clump divides its mass and moment of inertia among its spheres, so that functions that know
// only grains, such as gravity, add up to what they do to the clump:
//
//   Σ m_s = M,   Σ m_s r_s = 0,   Σ m_s (r_s² 1 − r_s r_sᵀ) + I_s 1 ⪯ Θ
//
// with r_s from the centre of mass. The last one, that their moment of inertia is at most that of
// the clump about each axis, makes the limit of the time step of free spheres one of the clump.
//
// Of all shares with that mass and centre, those in proportion to V_s exp(a·r_s − b r_s²) are
// nearest to the volumes V_s, with the least b ≥ 0 that leaves the spheres a moment of inertia of
// their own.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/union_of_balls.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace silt::dem::detail {

/// Of a sphere.
struct ShareOfClump {
  double mass = 0;     ///< m_s [kg]
  double inertia = 0;  ///< I_s [kg m²]
};

/// The shares of mass [-] nearest to weights whose mean of the places r is 0, by Newton's iteration
/// for the exponents; empty if there are none. Spheres in a line or a plane have no variance across
/// it: a mean there, of round-off, remains.
template <int Dim>
std::vector<double> centred_shares(std::vector<double> weights, const std::vector<Vec<Dim>>& r,
                                   double size) {
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  Vec<Dim> mean = Vec<Dim>::Zero();
  for (int iterations = 0; iterations < 200; ++iterations) {
    double sum = 0;
    for (const double weight : weights) sum += weight;
    if (!is_positive_normal(sum)) return {};
    for (double& weight : weights) weight /= sum;
    mean = Vec<Dim>::Zero();
    Matrix second = Matrix::Zero();
    for (std::size_t s = 0; s < r.size(); ++s) {
      mean += weights[s] * r[s];
      second += weights[s] * r[s] * r[s].transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix(second - mean * mean.transpose()));
    Vec<Dim> change = Vec<Dim>::Zero();
    double to_go = 0;
    for (int k = 0; k < Dim; ++k) {
      const Vec<Dim> axis = solver.eigenvectors().col(k);
      const double variance = solver.eigenvalues()[k];
      if (!(variance > 1e-14 * size * size)) continue;
      change -= axis.dot(mean) / variance * axis;
      to_go = std::max(to_go, std::abs(axis.dot(mean)));
    }
    if (to_go <= 1e-14 * size) break;
    change *= std::min(1.0, 2 / (change.norm() * size));  // exponents change by at most 2
    for (std::size_t s = 0; s < r.size(); ++s) weights[s] *= std::exp(change.dot(r[s]));
  }
  if (mean.norm() > 1e-7 * size) return {};
  return weights;
}

/// The moment of inertia of the clump without that of the masses of its spheres at their centres
/// [kg m²].
template <int Dim>
silt::Inertia<Dim> rest_of_inertia(const MassProperties<Dim>& clump,
                                   const std::vector<ShareOfClump>& shares,
                                   std::span<const Ball<Dim>> spheres) {
  silt::Inertia<Dim> rest = clump.inertia;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const Vec<Dim> r = spheres[s].centre - clump.centre;
    if constexpr (Dim == 2) {
      rest -= shares[s].mass * r.squaredNorm();
    } else {
      rest -= shares[s].mass * (r.squaredNorm() * silt::Inertia<3>::Identity() - r * r.transpose());
    }
  }
  return rest;
}
/// The least one about any axis.
inline double least_of(double inertia) { return inertia; }
inline double least_of(const silt::Inertia<3>& inertia) {
  return Eigen::SelfAdjointEigenSolver<silt::Inertia<3>>(inertia, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

template <int Dim>
std::vector<ShareOfClump> shares_of_clump(std::span<const Ball<Dim>> spheres,
                                          const MassProperties<Dim>& clump) {
  std::vector<Vec<Dim>> r;
  double size = 0;
  for (const Ball<Dim>& ball : spheres) {
    r.push_back(ball.centre - clump.centre);
    size = std::max({size, r.back().norm(), ball.radius});
  }
  const auto shares_for = [&](double b) {
    std::vector<double> weights;
    for (std::size_t s = 0; s < r.size(); ++s) {
      weights.push_back(spheres[s].radius / size *
                        std::exp(-b * r[s].squaredNorm() / (size * size)));
    }
    return centred_shares<Dim>(std::move(weights), r, size);
  };
  std::vector<ShareOfClump> best;
  double rest = 0;
  // The lightest sphere limits the time step, so that b should be small; with a quarter of the
  // least moment of inertia, rotation limits it no more than that.
  const double enough = least_of(clump.inertia) / 4;
  for (double b = 0; b < 1000 && !(rest > enough); b = 1.2 * b + 0.05) {
    std::vector<ShareOfClump> shares;
    for (const double share : shares_for(b)) shares.push_back({.mass = clump.mass * share});
    if (shares.empty()) break;
    const double left = least_of(rest_of_inertia<Dim>(clump, shares, spheres));
    if (left > rest) {
      rest = left;
      best = std::move(shares);
    }
  }
  // Of a sphere that shares so little, the time step would be too short.
  constexpr double least = 1e-6;
  const bool is_any_without = std::any_of(best.begin(), best.end(), [&](const ShareOfClump& share) {
    return !(share.mass * double(best.size()) > least * clump.mass);
  });
  if (best.empty() || is_any_without) {
    fail(
        {"dem::ClumpShape: no masses at the centres of its spheres, each with a part of it, have "
         "the "
         "centre of mass ",
         to_text(clump.centre), " m and less than the moment of inertia of the clump, ", clump.mass,
         " kg; remove spheres that lie within others, or, for a heavy core, add one near the "
         "centre of mass"});
  }
  // In proportion to those of free spheres of these masses.
  double sum = 0;
  for (std::size_t s = 0; s < best.size(); ++s) {
    best[s].inertia = best[s].mass * spheres[s].radius * spheres[s].radius;
    sum += best[s].inertia;
  }
  for (ShareOfClump& share : best) share.inertia *= rest / sum;
  return best;
}

}  // namespace silt::dem::detail
