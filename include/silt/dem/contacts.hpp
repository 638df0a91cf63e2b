// SPDX-License-Identifier: MIT
// The interaction of DEM: finds who touches whom, remembers what a law remembers, asks the law for
// each contact once, and sums per grain in a fixed order.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/materials.hpp>
#include <silt/dem/stability.hpp>
#include <silt/dem/time_step.hpp>
#include <silt/dem/touches.hpp>
#include <silt/dem/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

namespace silt::dem {

/// Where the contact force takes hold.
enum class LeverArm {
  contact_point,  ///< in the middle of the overlap: keeps angular momentum to round-off
  radius,         ///< at R, as [SahChoi2004] (14) has it: off by δ/2
};

struct ContactSettings {
  LeverArm lever_arm = LeverArm::contact_point;
  double steps_per_contact = 50;  ///< of the default time step [-]
  bool refuse_unstable = true;    ///< throw when Δt is beyond what the existing contacts allow
};

/// Contacts under one law (or one per pair of materials), of grains among themselves and with walls.
/// A wall is any type that models dem::Wall.
template <class Law, class... Walls>
class Contacts {
 public:
  /// Throws if a parameter of the law or of a wall is out of range.
  explicit Contacts(Law law, Walls... walls) : Contacts(Materials<Law>{law}, std::move(walls)...) {}
  explicit Contacts(Materials<Law> materials, Walls... walls)
      : materials_(std::move(materials)), walls_(std::move(walls)...) {
    for_each_wall([this](auto& wall, Index w) {
      wall.check();
      check_material(wall.material, "of wall " + std::to_string(w));
    });
  }

  /// The same contacts with other settings. Throws if they are out of range.
  Contacts with(const ContactSettings& settings) const {
    require_positive("ContactSettings: steps_per_contact", settings.steps_per_contact);
    Contacts contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Fails to compile, in words, for grains that these contacts cannot act on.
  template <class P>
  static constexpr void explain() {
    static_assert(HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                            material_t>,
                  "silt::dem::Contacts: these particles lack a field of dem::Grains");
    static_assert(ContactLaw<Law, P::dimension, typename P::Real>,
                  "silt::dem::Contacts: the law has neither force(contact) nor force(contact, "
                  "memory) that gives a vector (see ContactLaw in silt/dem/contact.hpp)");
    static_assert((Wall<Walls, P::dimension, typename P::Real> && ...),
                  "silt::dem::Contacts: a wall lacks nearest(x), material or check(), or is of "
                  "another dimension or precision (see Wall in silt/dem/walls.hpp)");
  }

  /// Two of the largest radius [m].
  template <class P>
  typename P::Real reach(const P& grains) const {
    using Real = typename P::Real;
    const auto R = grains[radius];
    return 2 * largest(R.size(), Real(0), [&](Index i) { return R[i]; });
  }

  /// Adds contact forces and moments. Throws if two centres coincide, if a radius or mass is not
  /// positive, if a material is unknown, or if dt is beyond stability.
  template <class P, class S>
    requires HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                       material_t> &&
             ContactLaw<Law, P::dimension, typename P::Real> &&
             (Wall<Walls, P::dimension, typename P::Real> && ...)
  void accelerate(P& grains, const S& search, double dt) {
    auto& touches = found<P>();
    check_grains(grains);
    grains.refresh_ghosts(velocity);
    grains.refresh_ghosts(spin);
    find(grains, search, touches);
    ask_law(grains, touches, static_cast<typename P::Real>(dt));
    add_to_grains(grains, touches);
    if constexpr (knows_stiffness<P>) {
      if (settings_.refuse_unstable) check_stability(grains, touches, dt);
    }
    count_ = touches.size();
  }

  /// A fraction 1/steps_per_contact of the shortest contact that the lightest grains can have [s].
  template <class P>
  double time_step(const P& grains) const {
    using Contact = dem::Contact<P::dimension, typename P::Real>;
    const auto m = grains[mass];
    double duration = std::numeric_limits<double>::infinity();
    if constexpr (knows_stiffness<P>) {
      const double lightest = -largest(m.size(), -std::numeric_limits<double>::infinity(),
                                       [&](Index i) { return -double(m[i]); });
      if (!(lightest > 0) || !is_finite(lightest)) return duration;
      Contact contact{};
      contact.effective_mass = static_cast<typename P::Real>(lightest / 2);
      contact.effective_radius = 1;
      // A spring along the tangent also has to turn the grain: 1 + m R²/I is 3 for discs, 3.5 for
      // spheres.
      for (std::uint32_t a = 0; a < materials_.count(); ++a) {
        for (std::uint32_t b = 0; b < materials_.count(); ++b) {
          const Stiffness k = materials_.between(a, b).stiffness(contact);
          const double stiffest = std::max(k.normal, 3.5 * k.tangential);
          if (!(stiffest > 0)) continue;
          duration =
              std::min(duration, contact_duration({.mass = lightest / 2, .stiffness = stiffest}));
        }
      }
    }
    return duration / settings_.steps_per_contact;
  }

  /// Contacts of the last step, walls included.
  Index size() const noexcept { return count_; }

  /// f(i, j, contact, force on i) for every contact of the last step whose grains are still there;
  /// i and j are the places of the two (owned ones, now), j is `nowhere` for a wall.
  template <class P, class F>
  void for_each_contact(const P& grains, F&& f) const {
    for (const auto& touch : found<P>().all()) {
      if (is_there(grains, touch)) {
        f(grains.index_of(touch.id), grains.index_of(touch.partner), touch.contact, touch.force);
      }
    }
  }

  /// Energy in the springs of the last step's contacts [J]; 0 for a law that does not tell.
  template <class P>
  double elastic_energy(const P& grains) const {
    const auto& last = found<P>();
    double energy = 0;
    if constexpr (requires(const TouchOf<P> t, const MemoryOf<P> m, const Law law) {
                    law.elastic_energy(t.contact, m);
                  }) {
      energy = ordered_sum(last.size(), 0.0, [&](Index c) {
        const TouchOf<P>& touch = last.all()[c];
        if (!is_there(grains, touch)) return 0.0;
        return double(law_of(touch).elastic_energy(touch.contact, last.memory().values()[c]));
      });
    }
    return energy;
  }

  /// What the law remembers of the pairs that touch, by ids: for a checkpoint.
  template <class P>
  auto& memory(const P&) noexcept {
    return found<P>().memory();
  }
  template <class P>
  const auto& memory(const P&) const noexcept {
    return found<P>().memory();
  }

  void save() noexcept {
    std::apply([](auto&... each) { (each.save(), ...); }, found_);
    saved_count_ = count_;
  }
  void restore() noexcept {
    std::apply([](auto&... each) { (each.restore(), ...); }, found_);
    count_ = saved_count_;
  }

 private:
  template <int Dim, class Real>
  static auto memory_type() {
    if constexpr (LawWithMemory<Law, Dim, Real>) {
      return typename Law::template Memory<Dim, Real>{};
    } else {
      return NoMemory{};
    }
  }
  template <class P>
  using MemoryOf = decltype(memory_type<P::dimension, typename P::Real>());

  template <class P>
  static constexpr bool knows_stiffness =
      requires(const Law law, const Contact<P::dimension, typename P::Real> c) {
        { law.stiffness(c) } -> std::convertible_to<Stiffness>;
      };

  template <int Dim, class Real>
  using Found = Touches<Dim, Real, decltype(memory_type<Dim, Real>())>;
  template <class P>
  using FoundOf = Found<P::dimension, typename P::Real>;
  template <class P>
  using TouchOf = Touch<P::dimension, typename P::Real>;

  // Grains may have been removed since the contact was found.
  template <class P>
  static bool is_there(const P& grains, const TouchOf<P>& touch) {
    return grains.index_of(touch.id) != nowhere &&
           (touch.j == nowhere || grains.index_of(touch.partner) != nowhere);
  }

  // Contacts learns dimension and precision from the grains only; one of these four is in use.
  template <class P>
  auto& found() noexcept {
    return std::get<FoundOf<P>>(found_);
  }
  template <class P>
  const auto& found() const noexcept {
    return std::get<FoundOf<P>>(found_);
  }

  template <class P>
  static void check_grains(const P& grains) {
    const auto R = grains[radius];
    const auto m = grains[mass];
    const Index odd = first_where(grains.size(), [&](Index i) { return !(R[i] > 0) || !(m[i] > 0); });
    if (odd != nowhere) {
      const Where where{.particle = odd, .id = grains.id(odd)};
      fail("dem::Contacts: radius = " + to_text(double(R[odd])) + " m and mass = " +
               to_text(double(m[odd])) + " kg of a grain must be positive; set them",
           where);
    }
  }

  template <class P, class S>
  void find(const P& grains, const S& search, FoundOf<P>& touches) const {
    using Real = typename P::Real;
    using Vec = typename P::Vec;
    const auto x = grains[position];
    const auto R = grains.with_ghosts(radius);
    const auto materials = grains.with_ghosts(material);
    touches.renew(grains, [&](Index i, auto&& add) {
      if (materials[i] >= materials_.count()) {
        check_material(materials[i], "of a grain", {.particle = i, .id = grains.id(i)});
      }
      search.for_each_neighbour(i, [&](Index j, const Vec& r_ij, Real r) {
        const Real overlap = R[i] + R[j] - r;
        if (!(overlap > 0) || grains.id(j) <= grains.id(i)) return;
        if (!(r > 0)) {
          fail("dem::Contacts: the centres of grains " + std::to_string(grains.id(i)) + " and " +
                   std::to_string(grains.id(j)) + " coincide; place them apart",
               {.particle = i, .id = grains.id(i)});
        }
        TouchOf<P> touch;
        touch.j = j;
        touch.id = grains.id(i);
        touch.partner = grains.id(j);
        touch.material = materials[i];
        touch.partner_material = materials[j];
        touch.contact.normal = -r_ij / r;
        touch.contact.overlap = overlap;
        touch.arm_i = arm(R[i], overlap / 2);
        touch.arm_j = arm(R[j], overlap / 2);
        add(touch);
      });
      for_each_wall([&](const auto& wall, Index w) {
        const auto nearest = wall.nearest(x[i]);
        const Real overlap = R[i] - nearest.distance;
        if (!(overlap > 0)) return;
        TouchOf<P> touch;
        touch.id = grains.id(i);
        touch.partner = wall_id(w);
        touch.material = materials[i];
        touch.partner_material = wall.material;
        touch.contact.normal = nearest.normal;
        touch.contact.overlap = overlap;
        touch.arm_i = arm(R[i], overlap);
        add(touch);
      });
    });
  }

  // The law's force for every contact.
  template <class P>
  void ask_law(const P& grains, FoundOf<P>& touches, typename P::Real dt) const {
    using Vec = typename P::Vec;
    const auto v = grains.with_ghosts(velocity);
    const auto w = grains.with_ghosts(spin);
    const auto m = grains.with_ghosts(mass);
    const auto R = grains.with_ghosts(radius);
    for_each(grains.size(), [&](Index i) {
      auto memory = touches.memory_of_row(i).begin();
      for (TouchOf<P>& touch : touches.row(i)) {
        auto& contact = touch.contact;
        const Vec& n = contact.normal;
        contact.time_step = dt;
        contact.relative_velocity = v[i] - cross(w[i], Vec(touch.arm_i * n));
        contact.effective_mass = m[i];
        contact.effective_radius = R[i];
        if (const Index j = touch.j; j != nowhere) {
          contact.relative_velocity -= v[j] + cross(w[j], Vec(touch.arm_j * n));
          contact.effective_mass = m[i] * m[j] / (m[i] + m[j]);
          contact.effective_radius = R[i] * R[j] / (R[i] + R[j]);
        }
        const Law& law = law_of(touch);
        if constexpr (LawWithMemory<Law, P::dimension, typename P::Real>) {
          touch.force = law.force(std::as_const(contact), *memory);
        } else {
          touch.force = law.force(std::as_const(contact));
        }
        ++memory;
      }
    });
  }

  // Σ F and Σ M (14).
  template <class P>
  static void add_to_grains(P& grains, const FoundOf<P>& touches) {
    using Vec = typename P::Vec;
    const auto F = grains[force];
    const auto M = grains[torque];
    for_each(grains.size(), [&](Index i) {
      touches.for_each_of(i, [&](const TouchOf<P>& touch, bool is_own) {
        const Vec& n = touch.contact.normal;
        F[i] += is_own ? touch.force : Vec(-touch.force);
        M[i] += is_own ? moment(Vec(-touch.arm_i * n), touch.force)
                       : moment(Vec(touch.arm_j * n), Vec(-touch.force));
      });
    });
  }

  template <class P>
  void check_stability(const P& grains, const FoundOf<P>& touches, double dt) const {
    const Unstable unstable = find_unstable(grains, touches, dt, [&](const TouchOf<P>& touch) {
      return Stiffness(law_of(touch).stiffness(touch.contact));
    });
    if (unstable.grain == nowhere) return;
    fail("dem::Contacts: time_step = " + to_text(dt) + " s exceeds the stable " +
             to_text(unstable.stable_time_step) + " s of a grain with its contacts; lower it",
         {.particle = unstable.grain, .id = grains.id(unstable.grain)});
  }

  template <int Dim, class Real>
  const Law& law_of(const Touch<Dim, Real>& touch) const {
    return materials_.between(touch.material, touch.partner_material);
  }

  void check_material(std::uint32_t number, const std::string& whose, Where where = {}) const {
    if (number >= materials_.count()) {
      fail("dem::Contacts: material " + std::to_string(number) + " " + whose + ", but there are " +
               std::to_string(materials_.count()) + "; give Contacts all materials",
           where);
    }
  }

  template <class Real>
  Real arm(Real R, Real to_contact_point) const {
    return settings_.lever_arm == LeverArm::radius ? R : R - to_contact_point;
  }

  template <class F>
  void for_each_wall(F&& f) {
    Index w = 0;
    std::apply([&](auto&... wall) { (f(wall, w++), ...); }, walls_);
  }
  template <class F>
  void for_each_wall(F&& f) const {
    Index w = 0;
    std::apply([&](const auto&... wall) { (f(wall, w++), ...); }, walls_);
  }

  Materials<Law> materials_;
  std::tuple<Walls...> walls_;
  ContactSettings settings_;
  std::tuple<Found<2, float>, Found<2, double>, Found<3, float>, Found<3, double>> found_;
  Index count_ = 0;
  Index saved_count_ = 0;
};

}  // namespace silt::dem
