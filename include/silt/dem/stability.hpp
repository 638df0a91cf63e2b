// SPDX-License-Identifier: MIT
// The time step against the contacts that exist.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/materials.hpp>
#include <silt/dem/single_contacts.hpp>
#include <silt/dem/time_step.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace silt::dem {

/// What a grain stands whose springs and dashpots, over its mass, are at most these.
struct Stiffest {
  double spring = 0;   ///< ω² [1/s²]
  double dashpot = 0;  ///< Σ c/m [1/s], of dashpots that see v^{N−½}

  /// [s]; infinite if nothing is stiff.
  double stable_time_step() const {
    if (!(spring > 0)) return std::numeric_limits<double>::infinity();
    return dem::stable_time_step(
        {.angular_frequency = std::sqrt(spring), .beta = dashpot / spring});
  }
};

/// The grain's side of a contact: its mass [kg], inertia [kg m²] and lever arm [m].
struct Lever {
  double mass;
  double inertia;
  double arm;
};

/// No less than what one contact adds to Stiffest, for a grain by itself.
inline Stiffest at_most(const Stiffness& k, double effective_mass, const Lever& lever) {
  const double per_turn = lever.mass / lever.inertia;
  const double linear = std::max(k.normal, k.tangential * (1 + per_turn * squared(lever.arm)));
  return {.spring = (linear + k.rolling * per_turn) / effective_mass,
          .dashpot = (k.beta * linear + k.rolling_dashpot * per_turn) / effective_mass};
}

/// Bound on the squared angular frequency [1/s²] of a grain among the contacts that it has, and in
/// the same way on its dashpots.
///
/// A contact's spring energy is ½ k (g_i·q_i + g_j·q_j)², with q the displacements and turns in
/// mass-weighted coordinates. By Cauchy and Schwarz, each grain may be given the share
/// (1/m_i + 1/m_j) m_i k (g_i·q_i)²; the largest eigenvalue of the sum of a grain's shares then
/// bounds ω² of the whole system from above, and is exact for a single pair.
template <int Dim, class Real>
class FrequencyBound {
  static constexpr int size = Dim == 2 ? 3 : 6;
  static constexpr int turns = size - Dim;
  using Matrix = Eigen::Matrix<double, size, size>;

 public:
  void add(const Contact<Dim, Real>& contact, const Stiffness& k, const Lever& lever) {
    const Vec<Dim, double> n = contact.normal.template cast<double>();
    // Velocity of the contact point from that of the grain and its scaled spin w √(I/m).
    Eigen::Matrix<double, Dim, size> motion = Eigen::Matrix<double, Dim, size>::Zero();
    motion.template leftCols<Dim>().setIdentity();
    const double per_turn = lever.mass / lever.inertia;
    const double scaled_arm = lever.arm * std::sqrt(per_turn);
    if constexpr (Dim == 2) {
      motion.col(2) = scaled_arm * Vec<2, double>(n[1], -n[0]);
    } else {
      motion.template rightCols<3>() << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
      motion.template rightCols<3>() *= scaled_arm;
    }
    using Plane = Eigen::Matrix<double, Dim, Dim>;
    const Plane normal = n * n.transpose();
    const Plane spring = k.normal * normal + k.tangential * (Plane::Identity() - normal);
    const double m = double(contact.effective_mass);
    const Matrix share = motion.transpose() * spring * motion / m;
    springs_ += share;
    dashpots_ += k.beta * share;
    springs_.diagonal().template tail<turns>().array() += k.rolling * per_turn / m;
    dashpots_.diagonal().template tail<turns>().array() += k.rolling_dashpot * per_turn / m;
  }

  Stiffest stiffest() const {
    return {.spring = largest_eigenvalue(springs_), .dashpot = largest_eigenvalue(dashpots_)};
  }

 private:
  // From above, too large by less than 6 %: the trace of the 32nd power.
  static double largest_eigenvalue(const Matrix& matrix) {
    const double scale = matrix.trace();
    if (!(scale > 0)) return 0;
    Matrix power = matrix / scale;
    double exponent = 1;
    for (int squarings = 0; squarings < 5; ++squarings) {
      power = Matrix(power * power);
      exponent /= 2;
    }
    return scale * std::pow(power.trace(), exponent);
  }

  Matrix springs_ = Matrix::Zero();
  Matrix dashpots_ = Matrix::Zero();
};

/// Share of its radius by which a grain is pressed in shortest_contact: a spring that stiffens as
/// it is pressed is as stiff as there.
inline constexpr double usual_overlap = 0.01;

/// Shortest contact that two of the lightest grains can have [s], π √(m*/k) with the stiffest
/// spring at usual_overlap; infinite if there are none, or nothing is stiff.
template <class P, class Law>
double shortest_contact(const P& grains, const Materials<Law>& materials) {
  using Real = typename P::Real;
  const auto m = grains[mass];
  double shortest = std::numeric_limits<double>::infinity();
  const double lightest = -largest(m.size(), -shortest, [&](Index i) { return -double(m[i]); });
  if (!(lightest > 0) || !is_finite(lightest)) return shortest;
  const Index grain = first_where(m.size(), [&](Index i) { return double(m[i]) == lightest; });
  const double R = double(grains[radius][grain]);
  Contact<P::dimension, Real> contact{};
  contact.effective_mass = static_cast<Real>(lightest / 2);
  contact.effective_radius = static_cast<Real>(R / 2);
  contact.overlap = static_cast<Real>(usual_overlap * R);
  const double per_turn = lightest / double(grains[inertia][grain]);
  for (std::uint32_t a = 0; a < materials.count(); ++a) {
    for (std::uint32_t b = 0; b < materials.count(); ++b) {
      const Stiffness k = materials.between(a, b).stiffness(contact);
      // A spring along the tangent also has to turn the grain: 1 + m R²/I is 3 for discs,
      // 3.5 for spheres.
      const double stiffest = std::max({k.normal, 3.5 * k.tangential, k.rolling * per_turn});
      if (!(stiffest > 0)) continue;
      shortest =
          std::min(shortest, contact_duration({.mass = lightest / 2, .stiffness = stiffest}));
    }
  }
  return shortest;
}

/// What even a grain with as many contacts as any, all as stiff as any, would stand [s]; infinite
/// if nothing is stiff. law_of(sides) is the law of a near contact; margin [m] is how far those
/// that do not touch yet may be apart. `walls` are a WallsThen.
template <class P, class Walls, class LawOf>
double stable_for_all(const P& grains, const NearContacts& near, const Walls& walls,
                      typename P::Real margin, LawOf&& law_of) {
  const auto x = grains.with_ghosts(position);
  const auto R = grains.with_ghosts(radius);
  const auto m = grains[mass];
  const auto I = grains[inertia];
  Index most_contacts = 0;
  // The grain that a couple turns most easily, and the one that a force at its surface does.
  Lever loosest{.mass = 0, .inertia = 1, .arm = 0};
  for (Index i = 0; i < grains.size(); ++i) {
    most_contacts = std::max(most_contacts, near.of(i).size());
    const double per_turn = double(m[i]) / double(I[i]);
    const double turning = std::max(per_turn * squared(double(R[i])),
                                    loosest.mass * squared(loosest.arm));
    loosest.mass = std::max(loosest.mass, per_turn);
    loosest.arm = std::sqrt(turning / loosest.mass);
  }
  Stiffest all;
  near.for_each_contact([&](Index c) {
    const Sides sides = sides_of(grains, near, c);
    auto contact = constants_of(grains, sides);
    // A spring may grow stiffer as it is pressed.
    contact.overlap = margin;
    if (sides.j != no_index) {
      const Index a = near.first(c);
      const Index b = near.second(c);
      contact.overlap += std::max<typename P::Real>(0, R[a] + R[b] - (x[b] - x[a]).norm());
    } else {
      const auto at = walls.nearest(sides.wall, x[sides.i]);
      contact.overlap += std::max<typename P::Real>(0, R[sides.i] - at.distance);
    }
    const Stiffness k = law_of(sides).stiffness(contact);
    const Stiffest one = at_most(k, double(contact.effective_mass), loosest);
    all.spring = std::max(all.spring, one.spring);
    all.dashpot = std::max(all.dashpot, one.dashpot);
  });
  all.spring *= double(most_contacts);
  all.dashpot *= double(most_contacts);
  return all.stable_time_step();
}

/// Throws if dt [s] is beyond stability for a grain among the contacts of this step. A cheap bound
/// passes nearly always; where it does not, FrequencyBound decides.
template <class P, class T, class Walls, class LawOf>
void check_stability(const P& grains, const T& touches, const Walls& walls, double dt,
                     LawOf&& law_of) {
  using Row = typename T::Row;
  const auto m = grains[mass];
  const auto I = grains[inertia];
  struct Held {
    Contact<P::dimension, typename P::Real> contact{};
    Stiffness stiffness{};
    bool touches = false;
  };
  std::vector<Held> held(touches.near().size());
  for_each_touch(grains, touches, [&](Index c, const Sides& sides, const auto* row) {
    const auto contact = contact_of(grains, touches.seen(), row, sides, walls);
    held[c] = {contact, law_of(sides).stiffness(contact), true};
  });
  // f(contact, stiffness, lever of i)
  const auto for_each_contact_of = [&](Index i, auto&& f) {
    for (const auto part : touches.near().of(i)) {
      const Held& each = held[part.contact()];
      if (!each.touches) continue;
      const auto shorter = touches.seen().row_of(part.contact())[Row::shorter];
      f(each.contact, each.stiffness,
        Lever{.mass = double(m[i]),
              .inertia = double(I[i]),
              .arm = double(grains[radius][i] - shorter)});
    }
  };
  const auto is_beyond = [&](Index i) {
    Stiffest sum;
    for_each_contact_of(i, [&](const auto& contact, const Stiffness& k, const Lever& lever) {
      const Stiffest one = at_most(k, double(contact.effective_mass), lever);
      sum.spring += one.spring;
      sum.dashpot += one.dashpot;
    });
    return dt > sum.stable_time_step();
  };
  const auto stable_of = [&](Index i) {
    FrequencyBound<P::dimension, typename P::Real> bound;
    for_each_contact_of(i, [&](const auto& contact, const Stiffness& k, const Lever& lever) {
      bound.add(contact, k, lever);
    });
    return bound.stiffest().stable_time_step();
  };
  const Index broken =
      first_where(grains.size(), [&](Index i) { return is_beyond(i) && dt > stable_of(i); });
  if (broken == no_index) return;
  fail("dem::Contacts: time_step = " + to_text(dt) + " s exceeds the stable " +
           to_text(stable_of(broken)) + " s of a grain with its contacts; lower it",
       {.particle = broken, .id = grains.id(broken)});
}

}  // namespace silt::dem
