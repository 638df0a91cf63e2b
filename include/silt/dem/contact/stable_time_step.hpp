// SPDX-License-Identifier: MIT
// Stability limit of the time step for the existing contacts.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/elementary_time_steps.hpp>
#include <silt/dem/contact/single_contacts.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <utility>

namespace silt::dem::detail {

/// The law returns the stiffness of a contact: a stable time step can be computed.
template <class Law, int Dim, class Real>
concept KnowsStiffness = requires(const Law law, const Contact<Dim, Real> contact) {
  { law.stiffness(contact) } -> std::convertible_to<Stiffness>;
};

/// Bounds of the springs and dashpots of a grain, and the time step that is stable with them.
struct StabilityBounds {
  double spring = 0;   ///< ω² [1/s²]
  double dashpot = 0;  ///< Σ c/m [1/s], for dashpots that use v^{N−½}

  StabilityBounds& operator+=(const StabilityBounds& more) {
    spring += more.spring;
    dashpot += more.dashpot;
    return *this;
  }
  /// Makes each at least as large as the other's.
  void include(const StabilityBounds& other) {
    spring = std::max(spring, other.spring);
    dashpot = std::max(dashpot, other.dashpot);
  }

  /// [s]; infinite without stiffness.
  double stable_time_step() const {
    if (!(spring > 0)) return std::numeric_limits<double>::infinity();
    return dem::stable_time_step(
        {.angular_frequency = std::sqrt(spring), .beta = dashpot / spring});
  }
};

/// How easily a contact rotates a grain.
struct Lever {
  double mass_over_inertia;  ///< [1/m²]
  double arm;                ///< [m]
};

/// How the two grains of a contact share the energy of its spring; see FrequencyBound.
enum class Shares {
  equal,        ///< a = m_j/m_i: exact for a single pair
  by_root_mass  ///< a = √(m_j/m_i): less for a large grain, which may have many small neighbours
};

/// The share of the grain of mass m [kg], in mass-weighted coordinates [1/kg].
inline double share_of(double m, double effective_mass, Shares shares) {
  if (shares == Shares::equal) return 1 / effective_mass;
  const double of_other = std::max(0.0, 1 / effective_mass - 1 / m);  // 1/m_j, 0 for a wall
  return 1 / m + std::sqrt(of_other / m);
}

/// Upper bound of the contribution of one contact to the StabilityBounds of a grain.
inline StabilityBounds contribution_bound(const Stiffness& k, double share, const Lever& lever) {
  const double m_over_I = lever.mass_over_inertia;
  const double linear = std::max(k.normal, k.tangential * (1 + m_over_I * squared(lever.arm)));
  return {.spring = (linear + k.rolling * m_over_I) * share,
          .dashpot = (k.beta * linear + k.rolling_dashpot * m_over_I) * share};
}

/// A vector as three numbers, 0 beyond its dimensions.
template <int Dim, class Real>
std::array<double, 3> three_components(const Eigen::Matrix<Real, Dim, 1>& vector) {
  std::array<double, 3> three{};
  for (int k = 0; k < Dim; ++k) three[Index(k)] = double(vector[k]);
  return three;
}

/// Upper bound of the squared angular frequency [1/s²] of a grain with all its contacts, and
/// likewise of its dashpots.
///
/// The spring energy of a contact is ½ k (g_i·q_i + g_j·q_j)², with q the displacements and
/// rotations in mass-weighted coordinates. By the Cauchy–Schwarz inequality it is at most
/// ½ k ((1 + 1/a) (g_i·q_i)² + (1 + a) (g_j·q_j)²), a share of each of the two grains, for any
/// a > 0. The maximum, over all grains, of the largest eigenvalue of the sum of a grain's shares is
/// an upper bound of ω² of the whole system, for a = m_j/m_i exact for a single pair.
///
/// The spheres of clumps count as free ones: to hold them together does not raise ω, since the
/// masses and moments of inertia of the spheres of a clump add up to at most those of the clump.
class FrequencyBound {
  using Matrix = std::array<std::array<double, 6>, 6>;

 public:
  /// In 2 or 3 dimensions.
  explicit FrequencyBound(Index dimension) : dim_(dimension), size_(dimension == 2 ? 3 : 6) {}

  /// `normal` has as many components as there are dimensions, `share` is as of share_of().
  [[gnu::cold]] void add(const std::array<double, 3>& normal, const Stiffness& k,
                         const Lever& lever, double share) {
    // By coefficients: Eigen's products take long to compile, and are made of fused multiply-adds
    // where the processor has them.
    const auto& n = normal;
    // Velocity of the contact point as a function of the grain's velocity and scaled spin w √(I/m).
    std::array<std::array<double, 6>, 3> motion{};
    const double scaled_arm = lever.arm * std::sqrt(lever.mass_over_inertia);
    for (Index a = 0; a < dim_; ++a) {
      motion[a][a] = 1;
      if (dim_ == 2) {
        motion[a][2] = scaled_arm * (a == 0 ? n[1] : -n[0]);
      } else {
        motion[a][3 + (a + 1) % 3] = -scaled_arm * n[(a + 2) % 3];
        motion[a][3 + (a + 2) % 3] = scaled_arm * n[(a + 1) % 3];
      }
    }
    for (Index r = 0; r < size_; ++r) {
      for (Index c = 0; c < size_; ++c) {
        double sum = 0;
        for (Index a = 0; a < dim_; ++a) {
          for (Index b = 0; b < dim_; ++b) {
            const double spring =
                (a == b ? k.tangential : 0) + (k.normal - k.tangential) * n[a] * n[b];
            sum += motion[a][r] * spring * motion[b][c] * share;
          }
        }
        springs_[r][c] += sum;
        dashpots_[r][c] += k.beta * sum;
      }
    }
    for (Index r = dim_; r < size_; ++r) {
      springs_[r][r] += k.rolling * lever.mass_over_inertia * share;
      dashpots_[r][r] += k.rolling_dashpot * lever.mass_over_inertia * share;
    }
  }

  [[gnu::cold]] double stable_time_step() const {
    return StabilityBounds{.spring = largest_eigenvalue(springs_),
                           .dashpot = largest_eigenvalue(dashpots_)}
        .stable_time_step();
  }

 private:
  // Upper bound, less than 6 % too large: from the trace of the 32nd power.
  [[gnu::cold]] double largest_eigenvalue(const Matrix& matrix) const {
    const double scale = trace(matrix);
    if (!(scale > 0)) return 0;
    Matrix power = matrix;
    for (auto& row : power) {
      for (double& each : row) each /= scale;
    }
    double exponent = 1;
    for (int squarings = 0; squarings < 5; ++squarings) {
      Matrix square{};
      for (Index r = 0; r < size_; ++r) {
        for (Index k = 0; k < size_; ++k) {
          for (Index c = 0; c < size_; ++c) square[r][c] += power[r][k] * power[k][c];
        }
      }
      power = square;
      exponent /= 2;
    }
    return scale * std::pow(trace(power), exponent);
  }
  double trace(const Matrix& matrix) const {
    double sum = 0;
    for (Index k = 0; k < size_; ++k) sum += matrix[k][k];
    return sum;
  }

  Index dim_;
  Index size_;
  Matrix springs_{};
  Matrix dashpots_{};
};

/// The bounds of single grains even if all their pairs of the list touch; 0 without stiffness.
/// law_of(c) is the law of a contact, margin [m] the largest gap of contacts in the list, `walls` a
/// WallsAtTime. Refers to its arguments.
template <class P, class Walls, class LawOf>
class BoundsOfGrains {
  using Real = typename P::Real;

 public:
  BoundsOfGrains(const P& grains, const ContactList& list, const Walls& walls, Real margin,
                 const LawOf& law_of)
      : grains_(grains),
        list_(list),
        walls_(walls),
        margin_(margin),
        law_of_(law_of),
        x_(grains.with_halo(position)),
        R_(grains.with_halo(radius)),
        m_(grains.with_halo(mass)),
        resisting_m_(grains.with_halo(mass_in_contacts<P>())),
        I_(grains[inertia]),
        image_(grains.box()) {}

  /// Throws if a law returns a stiffness that is not possible.
  StabilityBounds operator()(Index i) const {
    const Lever lever{.mass_over_inertia = double(m_[i]) / double(I_[i]), .arm = double(R_[i])};
    StabilityBounds sum;
    for (const ContactList::Side side : list_.of(i)) sum += contribution(i, side.contact(), lever);
    return sum;
  }

 private:
  StabilityBounds contribution(Index i, Index c, const Lever& lever) const {
    const ContactBodies bodies = bodies_of(list_, c);
    Contact<P::dimension, Real> contact;
    contact.effective_mass = effective(resisting_m_, bodies);
    contact.effective_radius = R_[bodies.i];
    // Springs may stiffen with the overlap.
    contact.overlap = margin_;
    if (bodies.j != no_index) {
      contact.effective_radius *= R_[bodies.j] / (R_[bodies.i] + R_[bodies.j]);
      const Real distance = image_(typename P::Vec(x_[bodies.j] - x_[bodies.i])).norm();
      contact.overlap += std::max<Real>(0, R_[bodies.i] + R_[bodies.j] - distance);
    } else {
      const auto at = walls_.nearest(bodies.wall, x_[bodies.i]);
      contact.overlap += std::max<Real>(0, R_[bodies.i] - at.distance);
    }
    const double share =
        share_of(double(m_[i]), double(effective(m_, bodies)), Shares::by_root_mass);
    const Stiffness k = law_of_(c).stiffness(contact);
    check_stiffness(k, [] { return "a contact of this grain"; }, {i, grains_.id(i)});
    return contribution_bound(k, share, lever);
  }
  template <class Masses>
  static Real effective(const Masses& m, const ContactBodies& bodies) {
    if (bodies.j == no_index) return m[bodies.i];
    return m[bodies.i] * (m[bodies.j] / (m[bodies.i] + m[bodies.j]));
  }

  const P& grains_;
  const ContactList& list_;
  const Walls& walls_;
  Real margin_;
  const LawOf& law_of_;
  decltype(std::declval<const P&>().with_halo(position)) x_;
  decltype(std::declval<const P&>().with_halo(radius)) R_;
  decltype(std::declval<const P&>().with_halo(mass)) m_;
  decltype(std::declval<const P&>().with_halo(mass_in_contacts<P>())) resisting_m_;
  decltype(std::declval<const P&>()[inertia]) I_;
  NearestImage<P::dimension, Real> image_;
};

/// A time step [s] that is stable for all grains, even if all pairs of the list touch. Infinite
/// without stiffness. `bounds_of` is a BoundsOfGrains. Throws as it does.
template <class BoundsOf>
double stable_for_all(const ContactList& list, const BoundsOf& bounds_of) {
  Buffer<StabilityBounds> of_block(list.blocks());
  list.for_each_block([&](Index b, Index first, Index last) {
    StabilityBounds largest;
    for (Index i = first; i < last; ++i) largest.include(bounds_of(i));
    of_block[b] = largest;
  });
  StabilityBounds all;
  for (const StabilityBounds& one : of_block) all.include(one);
  return all.stable_time_step();
}

/// The same for the grains with contacts that were added to the list from contact `first` on.
template <class BoundsOf>
double stable_for_added(const ContactList& list, Index first, const BoundsOf& bounds_of) {
  StabilityBounds all;
  for (Index c = first; c < list.size(); ++c) {
    all.include(bounds_of(list.first(c)));
    if (!list.is_of_wall(c)) all.include(bounds_of(list.second(c)));
  }
  return all.stable_time_step();
}

/// A contact of a step with its springs.
struct LinearisedContact {
  bool touches = false;
  Stiffness stiffness{};
  double effective_mass = 0;       ///< [kg]
  std::array<double, 3> normal{};  ///< 0 beyond the dimensions
  std::array<double, 2> arms{};    ///< lever arms, of the first and the second [m]
};
/// The mass of a grain [kg] and its ratio to the moment of inertia [1/m²].
struct MassOfGrain {
  double mass;
  double mass_over_inertia;
};

/// Whether steps are stable for the contacts of a list, which `contacts` has by their numbers.
class StabilityCheck {
 public:
  StabilityCheck(Index dimension, const ContactList& list,
                 std::span<const LinearisedContact> contacts,
                 FunctionRef<MassOfGrain(Index)> mass_of)
      : dim_(dimension), list_(list), contacts_(contacts), mass_of_(mass_of) {}

  /// A grain for which dt [s] is unstable, however the energies of springs are shared; `no_index`
  /// if there is none. A cheap bound is nearly always sufficient; otherwise FrequencyBound decides.
  Index find_unstable(double dt) const {
    if (find_unstable(dt, Shares::by_root_mass) == no_index) return no_index;
    return find_unstable(dt, Shares::equal);
  }
  /// For one grain [s].
  double stable_time_step(Index grain, Shares shares = Shares::equal) const {
    FrequencyBound bound(dim_);
    for_each_contact_of(grain, shares,
                        [&](const LinearisedContact& contact, const Lever& lever, double share) {
                          bound.add(contact.normal, contact.stiffness, lever, share);
                        });
    return bound.stable_time_step();
  }

 private:
  Index find_unstable(double dt, Shares shares) const {
    return first_where(list_.grains(), [&](Index i) {
      return dt > cheap_bound(i, shares) && dt > stable_time_step(i, shares);
    });
  }
  double cheap_bound(Index grain, Shares shares) const {
    StabilityBounds sum;
    for_each_contact_of(grain, shares,
                        [&](const LinearisedContact& contact, const Lever& lever, double share) {
                          sum += contribution_bound(contact.stiffness, share, lever);
                        });
    return sum.stable_time_step();
  }
  // f(contact, lever, share)
  template <class F>
  void for_each_contact_of(Index grain, Shares shares, F&& f) const {
    const MassOfGrain m = mass_of_(grain);
    for (const ContactList::Side side : list_.of(grain)) {
      const LinearisedContact& contact = contacts_[side.contact()];
      if (!contact.touches) continue;
      f(contact,
        Lever{.mass_over_inertia = m.mass_over_inertia, .arm = contact.arms[side.is_second()]},
        share_of(m.mass, contact.effective_mass, shares));
    }
  }

  Index dim_;
  const ContactList& list_;
  std::span<const LinearisedContact> contacts_;
  FunctionRef<MassOfGrain(Index)> mass_of_;
};

/// Throws if dt [s] exceeds the stability limit of a grain with the contacts of this step, a
/// ContactsOfStep.
template <class P, class ContactsOfStep>
void check_stability(const P& grains, const ContactsOfStep& contacts, double dt) {
  Buffer<LinearisedContact> linearised(contacts.list().size());
  contacts.for_each_stiffness([&](Index c, const ContactBodies& bodies, const auto& contact,
                                  const Stiffness& k, auto arm_reduction) {
    const auto R = grains.with_halo(radius);
    LinearisedContact& each = linearised[c];
    each = {.touches = true, .stiffness = k, .effective_mass = double(contact.effective_mass)};
    if constexpr (HasFields<P, clump_mass_t>) {
      const auto m = grains.with_halo(mass);
      const double m_i = double(m[bodies.i]);
      each.effective_mass =
          bodies.j == no_index ? m_i : m_i * double(m[bodies.j]) / (m_i + double(m[bodies.j]));
    }
    each.normal = three_components(contact.normal);
    each.arms[0] = double(R[bodies.i] - arm_reduction);
    if (bodies.j != no_index) each.arms[1] = double(R[bodies.j] - arm_reduction);
  });
  const auto mass_of = [m = grains[mass], I = grains[inertia]](Index i) {
    return MassOfGrain{double(m[i]), double(m[i]) / double(I[i])};
  };
  const StabilityCheck check(P::dimension, contacts.list(), linearised, mass_of);
  const Index unstable = check.find_unstable(dt);
  if (unstable == no_index) return;
  fail_as_unstable("dem::Contacts", dt, check.stable_time_step(unstable),
                   "a grain with its contacts", {.particle = unstable, .id = grains.id(unstable)});
}

}  // namespace silt::dem::detail
