// SPDX-License-Identifier: MIT
// The terms of the energy ledger: energies, work and losses; the mean velocities of a step, and the
// work of single contacts from them.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact/single_contacts.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <initializer_list>
#include <utility>
#include <vector>

namespace silt::dem {

/// Energies at one time, all in [J].
struct Energies {
  double kinetic = 0;     ///< Σ ½ m v²
  double rotational = 0;  ///< Σ ½ I ω²
  double potential = 0;   ///< −Σ m g·x, zero at the origin; jumps when a grain crosses a periodic
                          ///< side along g
  ElasticEnergies elastic{};  ///< in the springs of contacts

  /// Sum of all [J].
  double sum() const { return kinetic + rotational + potential + elastic.sum(); }
};

/// Work done on the grains, by mechanism; negative: energy taken from them. All in [J].
struct Work {
  double normal_spring = 0;
  double tangential_spring = 0;
  double rolling_spring = 0;  ///< and twisting
  double adhesion = 0;
  double normal_dashpot = 0;
  double tangential_dashpot = 0;
  double rolling_dashpot = 0;
  double contact = 0;  ///< all contact forces of a law without components()
  double walls = 0;    ///< by moving walls
  double gravity = 0;
  double damping = 0;         ///< by the global damping of the integrator
  double removed_grains = 0;  ///< by grains removed in the step, on the remaining ones
  double drives = 0;          ///< by what drives clumps, and damps those, see ClumpDrive
  double other = 0;           ///< by forces unknown to the ledger

  /// By all springs of contacts, adhesion included [J].
  double springs() const { return normal_spring + tangential_spring + rolling_spring + adhesion; }
  /// Sum of all terms [J].
  double sum() const {
    double sum = 0;
    for_each([&](double Work::* term) { sum += this->*term; });
    return sum;
  }
  /// max |term| [J]
  double max_term() const {
    double maximum = 0;
    for_each([&](double Work::* term) { maximum = std::max(maximum, std::abs(this->*term)); });
    return maximum;
  }
  /// Adds `share` times others.
  void add(const Work& others, double share) {
    for_each([&](double Work::* term) { this->*term += share * (others.*term); });
  }

  /// f(pointer to member) for every term.
  template <class F>
  static void for_each(F&& f) {
    for (double Work::* const term :
         {&Work::normal_spring, &Work::tangential_spring, &Work::rolling_spring, &Work::adhesion,
          &Work::normal_dashpot, &Work::tangential_dashpot, &Work::rolling_dashpot, &Work::contact,
          &Work::walls, &Work::gravity, &Work::damping, &Work::removed_grains, &Work::drives,
          &Work::other}) {
      f(term);
    }
  }
};

/// Energy lost from springs. All in [J], not below 0.
struct Losses {
  double friction = 0;          ///< dissipated by tangential sliders
  double rolling_friction = 0;  ///< dissipated by the sliders of rolling and twisting
  double plastic = 0;           ///< dissipated by yielding normal springs
  double separation = 0;  ///< stored in tangential and rolling springs when contacts ended, and
                          ///< in necks and bridges that broke

  /// Sum of all [J].
  double sum() const { return friction + rolling_friction + plastic + separation; }
  Losses& operator+=(const Losses& more) {
    friction += more.friction;
    rolling_friction += more.rolling_friction;
    plastic += more.plastic;
    separation += more.separation;
    return *this;
  }
};

namespace detail {

/// v^N and θ'^N, [SahChoi2004] (27) (28), always in double precision, and the work of contacts from
/// N − ½ to N + ½.
template <class P>
class MeanMotion {
 public:
  static constexpr int dimension = P::dimension;
  using Vector = Vec<dimension, double>;
  using Turn = AngularVec<dimension, double>;

  /// Grains before a step and those remaining after it; duration is that of the kick [s]. Removed
  /// grains keep the velocities they had before the step. Of spheres of clumps, set_clumps() adds
  /// the changes.
  void set(const P& before, const P& after, double duration) {
    const auto is_single = [&](Index i) {
      if constexpr (HasFields<P, clump_t>) {
        return before[clump][i] == 0;
      } else {
        return true;
      }
    };
    duration_ = duration;
    kinetic_change_ = rotational_change_ = carried_away_ = 0;
    v_.resize(before.size());
    w_.resize(before.size());
    stays_.assign(before.size(), false);
    for (Index i = 0; i < before.size(); ++i) {
      v_[i] = in_double(before[velocity][i]);
      w_[i] = in_double(before[spin][i]);
    }
    for (Index k = 0; k < after.size(); ++k) {
      const Index i = before.index_of(after.id(k));
      const Vector v = in_double(after[velocity][k]) - v_[i];
      const Turn w = in_double(after[spin][k]) - w_[i];
      stays_[i] = true;
      v_[i] += v / 2;
      w_[i] += w / 2;
      if (!is_single(i)) continue;
      kinetic_change_ += double(before[mass][i]) * v.dot(v_[i]);
      rotational_change_ += double(before[inertia][i]) * dot(w, w_[i]);
    }
    for (Index i = 0; i < before.size(); ++i) {
      if (stays_[i] || !is_single(i)) continue;
      carried_away_ += (double(before[mass][i]) * v_[i].squaredNorm() +
                        double(before[inertia][i]) * squared_norm(w_[i])) /
                       2;
    }
  }

  /// The Clumps of these grains, before the step and after it. Between two kicks their angular
  /// momenta do not change, nor does the energy of their rotation, see geometry/free_rotation.hpp.
  template <class Clumps>
  void set_clumps(const P& grains, const Clumps& before, const Clumps& after) {
    Index next = 0;
    clumps_.clear();
    driven_.clear();
    for (Index k = 0; k < before.size(); ++k) {
      const auto was = before.state(k);
      // The clumps that remain are in the same order.
      if (next == after.size() || after.name(next) != before.name(k)) {
        carried_away_ += (before.mass_of(k) * was.velocity.squaredNorm() +
                          dot(before.angular_momentum(k), was.spin)) /
                         2;
        continue;
      }
      const Vector v = after.state(next).velocity - was.velocity;
      const Turn momentum = after.angular_momentum(next) - before.angular_momentum(k);
      const Vector mean_v = was.velocity + v / 2;
      Turn mean_w = before.spin_with(k, Turn(before.angular_momentum(k) + momentum / 2));
      const double kinetic = before.mass_of(k) * v.dot(mean_v);
      double rotational = dot(momentum, mean_w);
      if (after.is_driven(next)) {  // it may keep its spin
        const auto now = after.state(next);
        mean_w = (was.spin + now.spin) / 2;
        rotational = (dot(after.angular_momentum(next), now.spin) -
                      dot(before.angular_momentum(k), was.spin)) /
                     2;
        driven_.push_back({k, kinetic + rotational});
      } else {
        clumps_.push_back(
            {before.mass_of(k), mean_v, mean_w, Turn(before.angular_momentum(k) + momentum / 2)});
      }
      kinetic_change_ += kinetic;
      rotational_change_ += rotational;
      before.for_each_sphere(grains, k, [&](Index i, const Vector& r) {
        v_[i] = mean_v + cross(mean_w, r);
        w_[i] = mean_w;
      });
      ++next;
    }
  }

  /// For a checkpoint, see core/transfer.hpp: the quantities that are used between steps.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("kinetic_change", kinetic_change_);
    archive("rotational_change", rotational_change_);
  }

  /// Of a damping model on the clumps [W].
  template <class D>
  double power_on_clumps(const D& damping) const {
    double power = 0;
    for (const Clump& each : clumps_) {
      power += each.mass * each.v.dot(damping.drag(each.v)) +
               dot(each.w, Turn(damping.drag(each.momentum)));
    }
    return power;
  }

  /// f(k, change of its energy [J]) for each of the clumps before the step that is driven.
  template <class F>
  void for_each_driven(F&& f) const {
    for (const auto& [k, change] : driven_) f(k, change);
  }
  double duration() const noexcept { return duration_; }
  bool stays(Index i) const noexcept { return stays_[i]; }
  const Vector& velocity_of(Index i) const noexcept { return v_[i]; }
  const Turn& spin_of(Index i) const noexcept { return w_[i]; }

  /// Changes of the energies of the remaining grains [J].
  double kinetic_change() const noexcept { return kinetic_change_; }
  double rotational_change() const noexcept { return rotational_change_; }
  /// Kinetic energy of the removed grains, including rotation [J].
  double carried_away() const noexcept { return carried_away_; }

  /// Adds the work and losses of a contact, an EvaluatedContact of these grains.
  template <class Each>
  void add_contact(const P& before, const Each& each, Work& done, Losses& lost) const {
    const auto [i, j, wall] = each.bodies;
    if (!stays_[i] && (j == no_index || !stays_[j])) return;
    const Vector n = in_double(each.contact.normal);
    const auto arm = [&](Index k) { return before[radius][k] - each.arm_reduction; };
    const auto surface = [&](Index k, double a) { return Vector(v_[k] + a * cross(w_[k], n)); };
    // Of the other side, grain or wall.
    Vector v_other;
    Turn w_other;
    if (j != no_index) {
      v_other = surface(j, double(arm(j)));
      w_other = w_[j];
    } else {
      v_other = in_double(each.wall_velocity);
      w_other = in_double(each.wall_spin);
    }
    const Vector v_own = surface(i, -double(arm(i)));
    const Load load = add_parts(each.answer, each.contact.normal, (v_own - v_other) * duration_,
                                (w_[i] - w_other) * duration_, done, lost);
    const auto work = [&](const Vector& v, const Turn& w) {
      return (load.force.dot(v) + dot(load.couple, w)) * duration_;
    };
    if (j == no_index) {
      done.walls += work(v_other, w_other);
    } else if (!stays_[j]) {
      done.removed_grains += work(v_other, w_other);
    } else if (!stays_[i]) {
      done.removed_grains -= work(v_own, w_[i]);
    }
  }

 private:
  // Load on the first grain.
  struct Load {
    Vector force;
    Turn couple;
  };
  // For the relative displacement u [m] and rotation `turn` of the two surfaces.
  template <class Answer>
  static Load add_parts(const Answer& answer, const typename P::Vec& n, const Vector& u,
                        const Turn& turn, Work& done, Losses& lost) {
    if constexpr (std::convertible_to<Answer, typename P::Vec>) {
      done.contact += in_double(answer).dot(u);
    } else {
      const double u_n = in_double(n).dot(u);
      done.normal_spring += double(answer.normal_spring) * u_n;
      done.normal_dashpot += double(answer.normal_dashpot) * u_n;
      done.adhesion += double(answer.adhesion) * u_n;
      done.tangential_spring += in_double(answer.tangential_spring).dot(u);
      done.tangential_dashpot += in_double(answer.tangential_dashpot).dot(u);
      lost.friction += double(answer.friction);
      lost.plastic += double(answer.plastic);
      if constexpr (requires { answer.couple(); }) {
        done.rolling_spring += dot(in_double(answer.rolling_spring), turn);
        done.rolling_dashpot += dot(in_double(answer.rolling_dashpot), turn);
        lost.rolling_friction += double(answer.rolling_friction);
      }
    }
    return {in_double(force_of(answer, n)), in_double(couple_of(answer))};
  }

  // A clump at N.
  struct Clump {
    double mass;
    Vector v;
    Turn w;
    Turn momentum;
  };

  double duration_ = 0;
  double kinetic_change_ = 0;
  double rotational_change_ = 0;
  double carried_away_ = 0;
  std::vector<Vector> v_;
  std::vector<Turn> w_;
  std::vector<char> stays_;
  std::vector<Clump> clumps_;
  std::vector<std::pair<Index, double>> driven_;
};

}  // namespace detail
}  // namespace silt::dem
