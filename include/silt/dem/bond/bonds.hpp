// SPDX-License-Identifier: MIT
// Bonds between grains, an interaction independent of contacts. In each step every bond is advanced
// by the motion of its two grains (parallel_bond.hpp), broken bonds are removed, and the forces on
// each grain are summed in a fixed order.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/dem/bond/bond_indices.hpp>
#include <silt/dem/bond/bond_stability.hpp>
#include <silt/dem/bond/parallel_bond.hpp>
#include <silt/dem/contact/stable_time_step.hpp>
#include <silt/dem/law/contact.hpp>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// The ids `one` and `other` of two grains, in either order.
struct IdPair {
  Id one = 0;
  Id other = 0;
};

/// Which grains bond_all_touching() considers as touching.
struct Touching {
  double max_gap = 0;  ///< largest distance between the two surfaces [m]
};

/// Numbers of the bonds that have broken so far, `in_tension` or `in_shear`.
struct BrokenBonds {
  std::uint64_t in_tension = 0;
  std::uint64_t in_shear = 0;
  double energy = 0;  ///< stored in their springs when they broke, and dissipated [J]
};

/// Bonds between grains. They act in addition to contacts: if a bonded pair overlaps, both the bond
/// and the contact repel. The bonds of a removed grain are removed with it.
template <int Dim, class RealType = double>
class Bonds {
 public:
  using Real = RealType;
  using Bond = dem::Bond<Dim, Real>;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  /// Throws if a parameter of the law is out of range.
  explicit Bonds(const ParallelBond& law) : law_(law) { law_.check(); }

  /// Bonds two grains, stress-free at their present positions, across a periodic side if that is
  /// nearer. Throws if a grain does not exist, if both ids are the same, if the grains coincide, or
  /// if they are already bonded.
  template <class P>
  void bond(const P& grains, const IdPair& pair) {
    const Bond bond = bond_between(grains, pair);
    if (is_bonded(pair)) {
      fail({"dem::Bonds: the grains ", names_of(bond), " are already bonded; bond each pair once"});
    }
    bonds_.insert(std::lower_bound(bonds_.begin(), bonds_.end(), bond, comes_before), bond);
    stability_.forget();
    indices_.invalidate();
  }

  /// Bonds all pairs with a gap of at most max_gap that are not yet bonded, and returns their
  /// number. `search` is the neighbour search to use, e.g. UniformGrid<Dim>{}. Throws as bond()
  /// does.
  template <class P, class S>
    requires NeighbourSearch<S, P>
  Index bond_all_touching(P grains, S search, const Touching& touching = {}) {
    require_not_negative("Touching: max_gap", touching.max_gap);
    const auto R = grains[radius];
    const Real max_radius = largest(R.size(), Real(0), [&](Index i) { return R[i]; });
    const Real gap = static_cast<Real>(touching.max_gap);
    if (!(max_radius > 0)) return 0;
    // Pairs that touch to round-off count; searches find pairs strictly within their radius.
    constexpr Real round_off = 64 * std::numeric_limits<Real>::epsilon();
    search.set_radius((2 * max_radius + gap) * (1 + 2 * round_off));
    search.update(grains);
    std::vector<Bond> found;
    search.for_each_pair([&](Index i, Index j, const auto&, Real distance) {
      const Index other = grains.owner(j);
      const Real reach = grains[radius][i] + grains[radius][other] + gap;
      const IdPair pair{grains.id(i), grains.id(other)};
      if (distance > reach * (1 + round_off) || is_bonded(pair)) return;
      found.push_back(bond_between(grains, pair));
    });
    bonds_.insert(bonds_.end(), found.begin(), found.end());
    std::sort(bonds_.begin(), bonds_.end(), comes_before);
    stability_.forget();
    indices_.invalidate();
    return found.size();
  }

  /// Whether there is an intact bond between the two, in either order.
  bool is_bonded(const IdPair& pair) const {
    const auto [a, b] = std::minmax(pair.one, pair.other);
    return std::binary_search(bonds_.begin(), bonds_.end(), Bond{.a = a, .b = b}, comes_before);
  }

  /// The parameters of all bonds.
  const ParallelBond& law() const noexcept { return law_; }
  /// The intact bonds, sorted by ids, in their state at the last step.
  std::span<const Bond> bonds() const noexcept { return bonds_; }
  /// Numbers of broken bonds since the beginning.
  const BrokenBonds& broken() const noexcept { return broken_; }

  /// 0 [m]: bonds need no neighbour search.
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }

  template <class P>
  bool needs_search(const P&) const {
    return false;
  }

  /// Adds forces [N] and torques [N m], in a pass over the grains if one is given, see
  /// AcceleratesInPass in core/concepts.hpp. Throws if the grains of a bond coincide, or if dt
  /// exceeds the stability limit of the bonds alone.
  template <class P, class S>
    requires HasFields<P, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t> &&
             std::same_as<typename P::Vec, Vec>
  void accelerate(P& grains, S&, double dt, const Pass& pass = {}) {
    advance_bonds(grains, dt);
    for_each_in_pass(grains.size(), pass, [&](Index i) { add_loads(grains, i); });
  }

  /// Default time step [s]: 1/50 of half the shortest period of the bonds; infinite without bonds.
  template <class P>
  double time_step(const P& grains) {
    update_indices(grains);
    return stability_.time_step() * std::numbers::pi / 100;
  }

  /// Energy in the bonds of the last step [J].
  template <class P>
  double elastic_energy(const P& grains) const {
    double energy = 0;
    for (const Bond& bond : bonds_) {
      const detail::BondEnds ends = detail::ends_of(grains, bond);
      if (ends.a == no_index || ends.b == no_index) continue;  // removed since
      energy += state_at(grains, bond, ends).elastic_energy;
    }
    return energy;
  }

  /// Stresses of a bond in the last step. Throws if one of its grains has been removed.
  template <class P>
  BondState state(const P& grains, const Bond& bond) const {
    const detail::BondEnds ends = detail::ends_of(grains, bond);
    if (ends.a == no_index || ends.b == no_index) {
      fail({"dem::Bonds: of the bond between the grains ", names_of(bond),
            ", a grain has been removed; ask only for the state of bonds() after the next step"});
    }
    return state_at(grains, bond, ends);
  }

  /// Throws if the grains of a bond move in the step, relative to each other, by more than its
  /// length at rest: its rotation is then not resolved. Called by Simulation.
  template <class P>
  void check_step(const P& grains, const FinishedStep& step) const {
    const auto v = grains[velocity];
    const auto displacement = [&](Index k) {
      const detail::BondEnds ends = indices_.ends(k);
      return double((v[ends.a] - v[ends.b]).norm()) * step.time_step;
    };
    const Index k = first_where(bonds_.size(), [&](Index bond) {
      return !(displacement(bond) <= double(bonds_[bond].rest_length));
    });
    if (k == no_index) return;
    fail({"dem::Bonds: the bonded grains ", names_of(bonds_[k]), " move by ", displacement(k),
          " m relative to each other in the step, but their bond is ", bonds_[k].rest_length,
          " m long; reduce the time step"},
         {.particle = indices_.ends(k).a, .id = bonds_[k].a});
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.setup("law", law_.setup());
    archive.finite([&] {
      archive("bonds", bonds_);
      archive("last_time_step", last_time_step_);
      archive("broken_in_tension", broken_.in_tension);
      archive("broken_in_shear", broken_.in_shear);
      archive("broken_energy", broken_.energy);
    });
    stability_.transfer(archive);
    if constexpr (Archive::reads) {
      for (Index k = 0; k < bonds_.size(); ++k) {
        const bool is_sorted = k == 0 || comes_before(bonds_[k - 1], bonds_[k]);
        if (is_sorted && bonds_[k].a < bonds_[k].b) continue;
        fail({"dem::Bonds: the bond between the grains ", names_of(bonds_[k]),
              " occurs twice or is out of order; use an earlier checkpoint"});
      }
      indices_.invalidate();
    }
  }

  void save() noexcept { is_kept_ = false; }
  void restore() noexcept {
    if (is_kept_) {
      std::swap(bonds_, kept_bonds_);
      broken_ = kept_broken_;
      last_time_step_ = kept_time_step_;
      indices_.invalidate();
    }
    is_kept_ = false;
  }

 private:
  // Brings the bonds to the positions of the grains and removes the broken ones.
  template <class P>
  void advance_bonds(P& grains, double dt) {
    keep_state();
    update_indices(grains);
    if (!(dt <= stability_.time_step())) refuse(grains, dt);
    const Real passed = static_cast<Real>(last_time_step_);
    const NearestImage<Dim, Real> image(grains.box());
    for_each(bonds_.size(), [&](Index k) { advance_bond(grains, k, image, passed); });
    remove_broken(grains);
    last_time_step_ = dt;
  }

  // Adds Σ F and Σ M of grain i, in the order of the bonds' ids.
  template <class P>
  void add_loads(P& grains, Index i) const {
    for (const Index k : indices_.of(i)) {
      const Bond& bond = bonds_[k];
      const detail::BondEnds ends = indices_.ends(k);
      const bool is_a = ends.a == i;
      const Real share = arm_of_a(grains, ends);
      // The force acts on both grains at the same point: this conserves angular momentum.
      const Vec arm = (is_a ? -share : 1 - share) * bond.length * bond.normal;
      const Real sign = is_a ? Real(1) : Real(-1);
      const Vec f = sign * bond.force;
      grains[force][i] += f;
      grains[torque][i] += cross(arm, f) + sign * bond.couple;
    }
  }

  template <class P>
  static Bond bond_between(const P& grains, const IdPair& pair) {
    const auto [a, b] = std::minmax(pair.one, pair.other);
    Bond bond{.a = a, .b = b};
    const detail::BondEnds ends = detail::ends_of(grains, bond);
    if (a == b || ends.a == no_index || ends.b == no_index) {
      fail({"dem::Bonds: the ids ", names_of(bond),
            " are not those of two different grains; give two existing ids"});
    }
    const NearestImage<Dim, Real> image(grains.box());
    const Vec between = image(grains[position][ends.a] - grains[position][ends.b]);
    bond.rest_length = bond.length = between.norm();
    require_positive("dem::Bonds: distance of the grains " + names_of(bond), double(bond.length));
    bond.normal = between / bond.length;
    return bond;
  }
  static std::string names_of(const Bond& bond) {
    return std::to_string(bond.a) + " and " + std::to_string(bond.b);
  }

  static bool comes_before(const Bond& one, const Bond& other) {
    return std::pair(one.a, one.b) < std::pair(other.a, other.b);
  }

  template <class P>
  BondState state_at(const P& grains, const Bond& bond, const detail::BondEnds& ends) const {
    const BeamSection section = section_at(grains, ends, law_);
    return detail::state_of(bond, section, springs_of(law_, section));
  }

  // Stores the state for restore().
  void keep_state() {
    if (is_kept_) return;
    kept_bonds_ = bonds_;
    kept_broken_ = broken_;
    kept_time_step_ = last_time_step_;
    is_kept_ = true;
  }

  template <class P>
  void update_indices(const P& grains) {
    if (!indices_.are_valid_for(grains)) indices_.find(grains, bonds_);
    stability_.update(grains, bonds_, indices_, law_);
  }

  template <class P>
  [[noreturn]] void refuse(const P& grains, double dt) const {
    fail_as_unstable("dem::Bonds", dt, stability_.time_step(), "a grain with its bonds",
                     {.particle = grains.index_of(stability_.grain()), .id = stability_.grain()});
  }

  template <class P>
  void advance_bond(const P& grains, Index k, const NearestImage<Dim, Real>& image, Real passed) {
    const detail::BondEnds ends = indices_.ends(k);
    const auto x = grains[position];
    // A bond may be longer than half a periodic side: of the images, the one nearest to where the
    // grain was relative to the other.
    const Vec nearest = image(x[ends.a] - x[ends.b]);
    const Vec before = bonds_[k].length * bonds_[k].normal;
    const Vec moved = nearest - before;
    const detail::BondMotion<Dim, Real> motion{.between = nearest + (image(moved) - moved),
                                               .rotation_a = grains[spin][ends.a] * passed,
                                               .rotation_b = grains[spin][ends.b] * passed,
                                               .arm_a = arm_of_a(grains, ends),
                                               .time_step = passed};
    if (!(motion.between.squaredNorm() >= std::numeric_limits<Real>::min())) {
      fail({"dem::Bonds: the bonded grains ", names_of(bonds_[k]),
            " coincide or have an invalid position; use a smaller time step"},
           {.particle = ends.a, .id = bonds_[k].a});
    }
    advance(bonds_[k], motion, springs_of(law_, section_at(grains, ends, law_)), law_.beta);
  }

  template <class P>
  void remove_broken(const P& grains) {
    const auto state_of_bond = [&](Index k) {
      return state_at(grains, bonds_[k], indices_.ends(k));
    };
    const auto breaks = [&](const BondState& state) {
      return state.tensile_stress > law_.tensile_strength ||
             state.shear_stress > law_.shear_strength;
    };
    const Index first =
        first_where(bonds_.size(), [&](Index k) { return breaks(state_of_bond(k)); });
    if (first == no_index) return;
    Index held = first;
    for (Index k = first; k < bonds_.size(); ++k) {
      const BondState state = state_of_bond(k);
      if (!breaks(state)) {
        bonds_[held++] = bonds_[k];
        continue;
      }
      ++(state.tensile_stress > law_.tensile_strength ? broken_.in_tension : broken_.in_shear);
      broken_.energy += state.elastic_energy;
    }
    bonds_.resize(held);
    indices_.find(grains, bonds_);
  }

  ParallelBond law_;
  std::vector<Bond> bonds_;  // sorted by ids
  BrokenBonds broken_;
  double last_time_step_ = 0;  // [s]; duration of the motion at the next evaluation

  detail::BondIndices indices_;
  detail::BondStability stability_;

  std::vector<Bond> kept_bonds_;
  BrokenBonds kept_broken_;
  double kept_time_step_ = 0;
  bool is_kept_ = false;
};

}  // namespace silt::dem
