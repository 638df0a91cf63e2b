// SPDX-License-Identifier: MIT
// Clumps: rigid bodies of spheres, in 2D of discs. A sphere of a clump is a grain: contacts, walls
// and searches know nothing else, except that spheres of one clump have no contact with each other,
// and that the mass of the clump resists a contact. ClumpLeapfrog moves the clumps.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/clump/clump_drive.hpp>
#include <silt/dem/clump/clump_records.hpp>
#include <silt/dem/clump/clump_shape.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/geometry/free_rotation.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/orientation.hpp>
#include <silt/geometry/rigid_body.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// Where a clump is put, and how it moves.
template <int Dim>
struct ClumpPlacement {
  Vec<Dim> position = Vec<Dim>::Zero();               ///< of its centre of mass [m]
  Orientation<Dim> orientation = {};                  ///< against how its shape was given
  Vec<Dim> velocity = Vec<Dim>::Zero();               ///< of its centre of mass [m/s]
  AngularVec<Dim> spin = zero_of<AngularVec<Dim>>();  ///< [1/s]
};

/// A number of clumps, and which grains are their spheres. A ClumpLeapfrog has a copy: during a
/// run, add clumps to that of the integrator. What the program writes to position, velocity or spin
/// of a sphere of a clump has no effect: use set_velocity() and set_spin().
template <int Dim>
class Clumps {
  using Sphere = detail::SphereOfClump<Dim>;
  using Constants = detail::ClumpConstants<Dim>;
  using Motion = detail::ClumpMotion<Dim>;
  using Drive = detail::DriveOfClump<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

 public:
  /// Adds a clump, and its spheres to the grains; returns its name, which the field `clump` of the
  /// spheres has. Throws, and adds nothing, if a number is not finite, or if add_grain would refuse
  /// a sphere of this size and mass.
  template <class P>
    requires HasFields<P, clump_t, clump_mass_t> && (P::dimension == Dim)
  Id add(P& grains, const ClumpShape<Dim>& shape, const ClumpPlacement<Dim>& at) {
    check(at);
    check_fits(grains.box(), shape);
    const auto& given = shape.mass_properties();
    Constants clump_constants{.first = constants_->spheres.size(),
                              .spheres = shape.spheres().size(),
                              .mass = given.mass,
                              .inertia = given.inertia,
                              .inverse = inverse_of(given.inertia),
                              .beyond_spheres = shape.beyond_spheres()};
    own_constants();
    std::vector<Id> added;
    try {
      for (std::size_t s = 0; s < shape.spheres().size(); ++s) {
        Sphere sphere{.offset = shape.spheres()[s].centre - given.centre};
        sphere.id = add_sphere(grains, shape, s, at, sphere.offset);
        added.push_back(sphere.id);
        constants_->spheres.push_back(sphere);
      }
      clump_constants.name = added.front() + 1;
      motions_.push_back(motion_of(clump_constants, at));
      constants_->clumps.push_back(clump_constants);
    } catch (...) {
      motions_.resize(constants_->clumps.size());
      constants_->spheres.resize(clump_constants.first);
      for (const Id id : added) grains.remove(id);
      throw;
    }
    for (const Id id : added) grains[clump][grains.index_of(id)] = clump_constants.name;
    if (!drives_.empty()) drives_.emplace_back();
    rows_revision_ = 0;
    return clump_constants.name;
  }

  /// Removes every clump k for which removed(k) is true, with its spheres; the others keep their
  /// order. Returns their number.
  template <class P, std::predicate<Index> Removed>
  Index remove_if(P& grains, Removed&& removed) {
    std::vector<char> is_gone;
    for (Index k = 0; k < size(); ++k) is_gone.push_back(removed(k) ? 1 : 0);
    const Index number = Index(std::count(is_gone.begin(), is_gone.end(), 1));
    if (number == 0) return 0;
    std::vector<Id> names;
    for (Index k = 0; k < size(); ++k) {
      if (is_gone[k]) names.push_back(name(k));
    }
    std::sort(names.begin(), names.end());
    const auto names_of = std::as_const(grains)[clump];
    grains.remove_if(
        [&](Index i) { return std::binary_search(names.begin(), names.end(), names_of[i]); });
    keep_if([&](Index k) { return !is_gone[k]; });
    return number;
  }

  Index size() const noexcept { return motions_.size(); }
  /// As the field `clump` of its spheres.
  Id name(Index k) const { return constants_->clumps[k].name; }
  double mass_of(Index k) const { return constants_->clumps[k].mass; }  ///< [kg]
  /// About its centre of mass, where its shape was given [kg m²].
  const silt::Inertia<Dim>& inertia_of(Index k) const { return constants_->clumps[k].inertia; }
  /// Position and motion; with velocity and spin as the integrator stores them, at half steps.
  BodyState<Dim> state(Index k) const {
    const Motion& motion = motions_[k];
    return {.pose = {.rotation = motion.orientation.matrix(), .shift = motion.position},
            .position = motion.position,
            .orientation = motion.orientation,
            .velocity = motion.velocity,
            .spin = spin_with(k, motion.momentum)};
  }
  /// The spin [1/s] that it has in its orientation with this angular momentum [kg m²/s].
  AngularVec<Dim> spin_with(Index k, const AngularVec<Dim>& momentum) const {
    return rotate_freely(motions_[k].orientation, momentum, constants_->clumps[k].inverse, 0).spin;
  }
  /// Angular momentum about its centre of mass [kg m²/s].
  const AngularVec<Dim>& angular_momentum(Index k) const { return motions_[k].momentum; }
  /// The clump with this name; `no_index` if it was removed.
  Index find(Id of_clump) const {
    const auto& all = constants_->clumps;
    const auto at = std::find_if(all.begin(), all.end(),
                                 [&](const Constants& each) { return each.name == of_clump; });
    return at == all.end() ? no_index : Index(at - all.begin());
  }

  /// Drives a clump from the next step on. Throws if force or torque are not finite.
  void set_drive(Index k, const ClumpDrive<Dim>& drive) {
    drive.check();
    drives_.resize(size());
    drives_[k].drive = drive;
    drives_[k].is_any = true;
    drives_[k].spin = state(k).spin;
  }
  /// Changes the velocity [m/s] of a clump. Throws if it is not finite.
  void set_velocity(Index k, const Vec<Dim>& v) {
    require_finite("dem::Clumps: velocity", v);
    motions_[k].velocity = v;
  }
  /// Changes the spin [1/s] of a clump. Throws if it is not finite.
  void set_spin(Index k, const AngularVec<Dim>& w) {
    require_finite("dem::Clumps: spin", w);
    motions_[k].momentum = momentum_with(constants_->clumps[k], motions_[k].orientation, w);
    if (!drives_.empty()) drives_[k].spin = w;
  }
  /// Whether set_drive() was called for it.
  bool is_driven(Index k) const { return !drives_.empty() && drives_[k].is_any; }
  /// Force [N] and torque [N m] on its spheres in the last step, without those of its drive; only
  /// of a clump that is_driven().
  BodyLoad<Dim> load(Index k) const { return is_driven(k) ? drives_[k].load : BodyLoad<Dim>{}; }

  /// f(i, r) for each of its spheres: the index in the grains, and the vector from the centre of
  /// mass [m]. Throws if one was removed.
  template <class P, class F>
  void for_each_sphere(const P& grains, Index k, F&& f) const {
    const Constants& body = constants_->clumps[k];
    const Matrix Q = motions_[k].orientation.matrix();
    for (const Sphere& sphere : spheres_of(body)) {
      f(index_of(grains, sphere, body), multiply(Q, sphere.offset));
    }
  }

  /// What kinetic_energy() and rotational_energy() of the grains lack of the energy of the clumps,
  /// with the spins of these grains [J]; 0 in 2D.
  template <class P>
  double energy_beyond_spheres(const P& grains) const {
    if constexpr (Dim == 2) {
      return 0;
    } else {
      return ordered_sum(size(), 0.0, [&](Index k) {
        const Vec<3> w = spin_in(grains, k);
        return w.dot(momentum_beyond_spheres(k, w)) / 2;
      });
    }
  }
  /// What angular_momentum() of the grains lacks of that of the clumps, likewise [kg m²/s].
  template <class P>
  AngularVec<Dim> momentum_beyond_spheres(const P& grains) const {
    if constexpr (Dim == 2) {
      return 0;
    } else {
      return ordered_sum(size(), Vec<3>(Vec<3>::Zero()),
                         [&](Index k) { return momentum_beyond_spheres(k, spin_in(grains, k)); });
    }
  }

  /// Moves the clumps, see ClumpLeapfrog. change(v, a) is a component of the velocity, or of the
  /// angular momentum, after a kick by the force per mass, or by the torque. put(i, x, v, w), from
  /// make_put() for a range of clumps, is called for every sphere with what it is after dt [s] of
  /// free motion; the clumps are there if they `drift`.
  template <class P, class Change, class MakePut>
  void advance(const P& grains, double dt, bool drift, const Change& change,
               const MakePut& make_put) {
    update_indices(grains);
    const auto f = grains[force];
    const auto t = grains[torque];
    const Box<Dim> box = box_in_double(grains.box());
    for_each_range(size(), [&](Index begin, Index end) {
      auto put = make_put();
      const auto fetch = [&](Index k) {
        const Constants& body = constants_->clumps[k];
        for (Index s = 0; s < body.spheres; ++s) put.fetch(indices_[body.first + s]);
      };
      constexpr Index ahead = 4;
      for (Index k = begin; k < std::min(begin + ahead, end); ++k) fetch(k);
      for (Index k = begin; k < end; ++k) {
        if (k + ahead < end) fetch(k + ahead);
        const Constants& body = constants_->clumps[k];
        const Sphere* const spheres = constants_->spheres.data() + body.first;
        const Index* const indices = indices_.data() + body.first;
        Motion& motion = motions_[k];
        const Matrix Q = motion.orientation.matrix();
        Vec<Dim> sum = Vec<Dim>::Zero();
        auto sum_of_torques = zero_of<AngularVec<Dim>>();
        for (Index s = 0; s < body.spheres; ++s) {
          const Vec<Dim> of_sphere = in_double(f[indices[s]]);
          sum += of_sphere;
          sum_of_torques +=
              cross(multiply(Q, spheres[s].offset), of_sphere) + in_double(t[indices[s]]);
        }
        Drive* const drive = is_driven(k) ? &drives_[k] : nullptr;
        if (drive) {
          drive->load = {.force = sum, .torque = sum_of_torques};
          sum += drive->drive.force;
          sum_of_torques += drive->drive.torque;
        }
        for (int d = 0; d < Dim; ++d) {
          if (drive && drive->drive.keeps_velocity[std::size_t(d)]) continue;
          motion.velocity[d] = change(motion.velocity[d], sum[d] / body.mass);
        }
        const bool keeps_spin = drive && drive->drive.keeps_spin;
        for (int d = 0; d < angular_size<Dim> && !keeps_spin; ++d) {
          double& momentum = component(motion.momentum, d);
          momentum = change(momentum, component(sum_of_torques, d));
        }
        const FreeRotation<Dim> rotation =
            keeps_spin ? turn_with(motion.orientation, drive->spin, dt)
                       : rotate_freely(motion.orientation, Q, motion.momentum, body.inverse, dt);
        check_turn(body, rotation.spin, dt);
        const Matrix after = rotation.end.matrix();
        const Vec<Dim> moved = motion.position + dt * motion.velocity;
        // Spheres move along chords.
        const Matrix middle = (Q + after) / 2;
        for (Index s = 0; s < body.spheres; ++s) {
          const Vec<Dim> v =
              motion.velocity + cross(rotation.spin, multiply(middle, spheres[s].offset));
          put(indices[s], Vec<Dim>(moved + multiply(after, spheres[s].offset)), v, rotation.spin);
        }
        if (!drift) continue;
        motion.position = box.wrap(moved);
        motion.orientation = rotation.end;
        if (keeps_spin) motion.momentum = momentum_with(body, rotation.end, drive->spin);
      }
    });
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    auto all = std::make_shared<AllConstants>(*constants_);
    archive.finite([&] {
      archive("clumps", all->clumps);
      archive("spheres", all->spheres);
      archive("motions", motions_);
      archive("drives", drives_);
    });
    if constexpr (Archive::reads) {
      check(*all);
      constants_ = std::move(all);
      rows_revision_ = 0;
    }
  }

 private:
  struct AllConstants {
    std::vector<Constants> clumps;
    std::vector<Sphere> spheres;
  };

  template <class P>
  AngularVec<Dim> spin_in(const P& grains, Index k) const {
    const Constants& body = constants_->clumps[k];
    return in_double(grains[spin][index_of(grains, constants_->spheres[body.first], body)]);
  }
  Vec<3> momentum_beyond_spheres(Index k, const Vec<3>& w) const {
    const Eigen::Matrix<double, 3, 3> Q = motions_[k].orientation.matrix();
    const Vec<3> in_body = multiply(Eigen::Matrix<double, 3, 3>(Q.transpose()), w);
    return multiply(Q, multiply(constants_->clumps[k].beyond_spheres, in_body));
  }

  static void check_turn(const Constants& body, const AngularVec<Dim>& w, double dt) {
    const double squared = squared_norm(w) * dt * dt;
    if (!(squared > 1)) return;
    fail({"dem::Clumps: the clump ", body.name, " turns by ", std::sqrt(squared),
          " rad in a step of ", std::abs(dt), " s, more than 1 rad; lower the time step"});
  }

  template <class Real>
  static void check_fits(const Box<Dim, Real>& box, const ClumpShape<Dim>& shape) {
    const double diameter = 2 * shape.bounding_radius();
    for (int k = 0; k < Dim; ++k) {
      const double period = double(box.upper[k] - box.lower[k]);
      if (!box.periodic[std::size_t(k)] || !(diameter > period / 2)) continue;
      fail({"dem::Clumps: a clump with a bounding diameter of ", diameter,
            " m is longer than half of the period ", period, " m of axis ", k,
            "; enlarge the box"});
    }
  }

  static void check(const ClumpPlacement<Dim>& at) {
    require_finite("dem::ClumpPlacement: position", at.position);
    require_finite("dem::ClumpPlacement: velocity", at.velocity);
    require_finite("dem::ClumpPlacement: spin", at.spin);
    if constexpr (Dim == 2) {
      require_finite("dem::ClumpPlacement: orientation", at.orientation.angle);
    } else {
      const double squared = at.orientation.quaternion.squaredNorm();
      if (!(std::abs(squared - 1) < 1e-6)) {
        fail({"dem::ClumpPlacement: orientation: the square of the quaternion is ", squared,
              ", not 1; normalise it"});
      }
    }
  }
  // What was read must fit.
  void check(const AllConstants& all) const {
    std::uint64_t next = 0;
    bool fits = motions_.size() == all.clumps.size() &&
                (drives_.empty() || drives_.size() == motions_.size());
    for (const Constants& body : all.clumps) {
      fits = fits && body.first == next && body.spheres > 0 &&
             body.spheres <= all.spheres.size() - next && body.mass > 0 && is_inertia(body.inertia);
      if (!fits) break;
      next += body.spheres;
    }
    if (fits && next == all.spheres.size()) return;
    fail("dem::Clumps: the clumps that were read do not fit each other; use an earlier checkpoint");
  }

  void own_constants() {
    if (constants_.use_count() > 1) constants_ = std::make_shared<AllConstants>(*constants_);
  }
  std::span<const Sphere> spheres_of(const Constants& body) const {
    return std::span<const Sphere>(constants_->spheres).subspan(body.first, body.spheres);
  }
  static Motion motion_of(const Constants& body, const ClumpPlacement<Dim>& at) {
    Motion motion{.position = at.position, .orientation = at.orientation, .velocity = at.velocity};
    if constexpr (Dim == 3) motion.orientation.quaternion.normalize();
    motion.momentum = momentum_with(body, motion.orientation, at.spin);
    return motion;
  }
  static AngularVec<Dim> momentum_with(const Constants& body, const Orientation<Dim>& orientation,
                                       const AngularVec<Dim>& w) {
    if constexpr (Dim == 2) {
      return body.inertia * w;
    } else {
      const Matrix Q = orientation.matrix();
      return multiply(Q, multiply(body.inertia, multiply(Matrix(Q.transpose()), w)));
    }
  }
  template <class P>
  static Id add_sphere(P& grains, const ClumpShape<Dim>& shape, std::size_t s,
                       const ClumpPlacement<Dim>& at, const Vec<Dim>& offset) {
    using Real = typename P::Real;
    const double r = shape.spheres()[s].radius;
    const detail::ShareOfClump& share = shape.shares()[s];
    const double m = shape.mass_properties().mass;
    for (const auto value : {share.mass, share.inertia, m}) {
      if (is_positive_normal(Real(value))) continue;
      fail({"dem::Clumps: the mass or moment of inertia of a sphere of a clump of ", m, " kg is ",
            value, " in the precision of the grains; use other units, or double"});
    }
    if (!is_radius(Real(r)) || !has_products(Real(r), Real(share.mass)) ||
        !has_products(Real(r), Real(m))) {
      fail({"dem::Clumps: radius = ", r, " m and mass = ", share.mass,
            " kg of a sphere of a clump of ", m,
            " kg have products that underflow or overflow; use other units, or double"});
    }
    const Vec<Dim> arm = multiply(at.orientation.matrix(), offset);
    const typename P::Vec x = (at.position + arm).template cast<Real>();
    const Vec<Dim> v = at.velocity + cross(at.spin, arm);
    const Index i =
        grains.add(grains.box().wrap(x), Initial{radius, Real(r)}, Initial{mass, Real(share.mass)},
                   Initial{inertia, Real(share.inertia)}, Initial{clump_mass, Real(m)},
                   Initial{material, static_cast<std::uint32_t>(shape.material_index())},
                   Initial{velocity, typename P::Vec(v.template cast<Real>())});
    if constexpr (Dim == 2) {
      grains[spin][i] = Real(at.spin);
    } else {
      grains[spin][i] = at.spin.template cast<Real>();
    }
    return grains.id(i);
  }

  template <class Real>
  static Box<Dim> box_in_double(const Box<Dim, Real>& box) {
    return {.lower = in_double(box.lower),
            .upper = in_double(box.upper),
            .periodic = box.periodic,
            .on_escape = box.on_escape};
  }

  template <class Kept>
  void keep_if(Kept&& kept) {
    auto all = std::make_shared<AllConstants>();
    std::vector<Motion> motions;
    std::vector<Drive> drives;
    for (Index k = 0; k < size(); ++k) {
      if (!kept(k)) continue;
      Constants body = constants_->clumps[k];
      const auto spheres = spheres_of(body);
      body.first = all->spheres.size();
      all->spheres.insert(all->spheres.end(), spheres.begin(), spheres.end());
      all->clumps.push_back(body);
      motions.push_back(motions_[k]);
      if (!drives_.empty()) drives.push_back(drives_[k]);
    }
    constants_ = std::move(all);
    motions_ = std::move(motions);
    drives_ = std::move(drives);
    rows_revision_ = 0;
  }

  template <class P>
  static Index index_of(const P& grains, const Sphere& sphere, const Constants& body) {
    const Index i = grains.index_of(sphere.id);
    if (i == no_index) {
      fail({"dem::Clumps: the sphere ", sphere.id, " of the clump ", body.name,
            " was removed; remove whole clumps, with dem::Clumps::remove_if() or dem::Outflow"});
    }
    return i;
  }
  // Clumps without any of their spheres are gone.
  template <class P>
  void update_indices(const P& grains) {
    if (rows_revision_ == grains.rows_revision() && grains_ == grains.size() &&
        indices_.size() == constants_->spheres.size()) {
      return;
    }
    const auto is_left = [&](Index k) {
      const auto spheres = spheres_of(constants_->clumps[k]);
      return std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
        return grains.index_of(sphere.id) != no_index;
      });
    };
    bool are_all_left = true;
    for (Index k = 0; k < size(); ++k) are_all_left = are_all_left && is_left(k);
    if (!are_all_left) keep_if(is_left);
    indices_.clear();
    for (const Constants& body : constants_->clumps) {
      for (const Sphere& sphere : spheres_of(body)) {
        indices_.push_back(index_of(grains, sphere, body));
      }
    }
    check_all_known(grains);
    rows_revision_ = grains.rows_revision();
    grains_ = grains.size();
  }

  // Every sphere of a clump must be one of these.
  template <class P>
  void check_all_known(const P& grains) const {
    std::vector<Id> names(grains.size(), 0);
    for (const Constants& body : constants_->clumps) {
      for (Index s = body.first; s < body.first + body.spheres; ++s) names[indices_[s]] = body.name;
    }
    const auto given = grains[clump];
    const Index odd = first_where(names.size(), [&](Index i) { return names[i] != given[i]; });
    if (odd == no_index) return;
    fail({"dem::Clumps: a grain belongs to the clump ", given[odd],
          ", which the integrator does not have; add clumps to a simulation by "
          "simulation.integrator().clumps().add(…)"},
         {.particle = odd, .id = grains.id(odd)});
  }

  // A simulation has copies of its integrator, which share what does not change.
  std::shared_ptr<AllConstants> constants_ = std::make_shared<AllConstants>();
  std::vector<Motion> motions_;
  std::vector<Drive> drives_;   // empty as long as none is driven
  std::vector<Index> indices_;  // of the spheres, in grains with this rows_revision()
  std::uint64_t rows_revision_ = 0;
  Index grains_ = 0;  // their number then
};

}  // namespace silt::dem
