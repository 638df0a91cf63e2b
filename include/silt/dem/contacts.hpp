// SPDX-License-Identifier: MIT
// The interaction of DEM: finds who touches whom, remembers what a law remembers, asks the law for
// each contact once, and sums per grain in a fixed order. A step is accelerate().
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/pair_memory.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/contact_lanes.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/materials.hpp>
#include <silt/dem/single_contacts.hpp>
#include <silt/dem/stability.hpp>
#include <silt/dem/time_step.hpp>
#include <silt/dem/touches.hpp>
#include <silt/dem/walls.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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
    accelerate_all(*this, grains, search, dt);
  }

  /// The first part of it: works out the force of every contact.
  template <class P, class S>
  void interact(P& grains, const S& search, double dt) {
    auto& touches = found<P>();
    touches.begin_step();
    grains.refresh_ghosts(velocity);
    grains.refresh_ghosts(spin);
    if (is_stale(grains, search, touches)) find_near(grains, search, touches, dt);
    ask_law(grains, touches, static_cast<typename P::Real>(dt));
    check_stability(grains, touches, dt);
  }

  /// The second: Σ F and Σ M (14) of grain i, in the order of the partners' ids.
  template <class P>
    requires HasFields<P, force_t, torque_t, material_t>
  void add_forces(P& grains, Index i) const {
    using Real = typename P::Real;
    using Lanes = LanesOf<P>;
    constexpr int Dim = P::dimension;
    const auto& touches = found<P>();
    const Real* const rows = touches.seen().rows.data();
    const Real R = grains[radius][i];
    Vec<Dim, Real> sum = Vec<Dim, Real>::Zero();
    auto turning = zero_of<Spin<Dim, Real>>();
    const auto parts = touches.near().of(i);
    __builtin_prefetch(rows + touches.near().soon_after(parts).contact() * Lanes::row_words);
    for (const auto part : parts) {
      const Real* const row = rows + part.contact() * Lanes::row_words;
      const Eigen::Map<const Vec<Dim, Real>> n(row + Lanes::n);
      const Eigen::Map<const Vec<Dim, Real>> F(row + Lanes::F);
      const Real arm = R - row[Lanes::arm_share] * row[Lanes::overlap];
      sum += part.is_second() ? Vec<Dim, Real>(-F) : Vec<Dim, Real>(F);
      turning -= arm * moment(Vec<Dim, Real>(n), Vec<Dim, Real>(F));
    }
    grains[force][i] += sum;
    grains[torque][i] += turning;
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
  Index size() const noexcept {
    return std::apply([](const auto&... each) { return (each.seen().count + ...); }, found_);
  }

  /// f(i, j, contact, force on i) for every contact of the last step whose grains are still there;
  /// i and j are the places of the two (owned ones, now), j is `nowhere` for a wall. The contact's
  /// velocity is that of the grains as they are given.
  template <class P, class F>
  void for_each_contact(const P& grains, F&& f) const {
    const auto& touches = found<P>();
    for_each_touch(grains, touches, [&](Index c, const Sides& sides) {
      const auto* const row = row_of(grains, touches, c);
      Vec<P::dimension, typename P::Real> force;
      for (int k = 0; k < P::dimension; ++k) force[k] = row[LanesOf<P>::F + k];
      f(sides.i, sides.j, contact_of(grains, touches, c, sides), force);
    });
  }

  /// Energy in the springs of the last step's contacts [J]; 0 for a law that does not tell.
  template <class P>
  double elastic_energy(const P& grains) const {
    using Memory = typename LawMemory<Law, P::dimension, typename P::Real>::type;
    double energy = 0;
    if constexpr (requires(const Contact<P::dimension, typename P::Real> contact, const Memory memory,
                           const Law law) { law.elastic_energy(contact, memory); }) {
      const auto& touches = found<P>();
      for_each_touch(grains, touches, [&](Index c, const Sides& sides) {
        energy += double(law_of(grains, sides)
                             .elastic_energy(contact_of(grains, touches, c, sides), memory_of<P>(c)));
      });
    }
    return energy;
  }

  /// What the law remembers of the pairs that touch, by ids: for a checkpoint.
  template <class P>
  auto memory(const P& grains) const {
    using Memory = PairMemory<typename LawMemory<Law, P::dimension, typename P::Real>::type>;
    std::vector<typename Memory::Entry> entries;
    const auto& near = found<P>().near();
    for_each_touch(grains, found<P>(), [&](Index c, const Sides&) {
      entries.push_back({near.first_id(c), near.second_id(c), memory_of<P>(c)});
    });
    return Memory(std::move(entries));
  }

  /// Replaces it: what a restart reads.
  template <class P, class Memory>
  void remember(const P&, const PairMemory<Memory>& memory) {
    using Words = typename FoundOf<P>::Near::Words;
    static_assert(
        std::same_as<Memory, typename LawMemory<Law, P::dimension, typename P::Real>::type>,
        "silt::dem::Contacts: this is not what the law remembers of grains like these");
    std::vector<typename PairMemory<Words>::Entry> entries;
    memory.for_each_pair([&](Id a, Id b, const Memory& own) {
      entries.push_back({a, b, words_from<P>(own)});
    });
    found<P>().remember(PairMemory<Words>(std::move(entries)));
  }

  void save() noexcept {
    std::apply([](auto&... each) { (each.save(), ...); }, found_);
  }
  void restore() noexcept {
    std::apply([](auto&... each) { (each.restore(), ...); }, found_);
  }

 private:
  template <class P>
  static constexpr bool knows_stiffness =
      requires(const Law law, const Contact<P::dimension, typename P::Real> c) {
        { law.stiffness(c) } -> std::convertible_to<Stiffness>;
      };

  template <class P>
  static constexpr int words_of = LawMemory<Law, P::dimension, typename P::Real>::words;
  template <int Dim, class Real>
  using Found = Touches<Dim, Real, LawMemory<Law, Dim, Real>::words>;
  template <class P>
  using FoundOf = Found<P::dimension, typename P::Real>;
  template <class P>
  using LanesOf = ContactLanes<P::dimension, typename P::Real>;

  // Contacts learns dimension and precision from the grains only; one of these four is in use.
  template <class P>
  auto& found() noexcept {
    return std::get<FoundOf<P>>(found_);
  }
  template <class P>
  const auto& found() const noexcept {
    return std::get<FoundOf<P>>(found_);
  }

  // Whether something else than the near contacts might touch: two grains come closer by at most the sum
  // of what they moved.
  template <class P, class S>
  static bool is_stale(const P& grains, const S& search, FoundOf<P>& touches) {
    auto& validity = touches.validity();
    if (validity.revision != grains.revision() || validity.since.size() != grains.size()) return true;
    if constexpr (KnowsTravel<S>) {
      if (search.travelled() - validity.travelled <= double(validity.margin / 2)) return false;
    }
    const auto x = grains[position];
    const auto near = squared(validity.margin / 2);
    // Not "beyond": a NaN is not near.
    return first_where(x.size(), [&](Index i) {
             return !((x[i] - validity.since[i]).squaredNorm() <= near);
           }) != nowhere;
  }

  template <class P>
  void check_grains(const P& grains) const {
    const auto R = grains[radius];
    const auto m = grains[mass];
    const auto materials = grains[material];
    const Index odd = first_where(grains.size(), [&](Index i) {
      return !(R[i] > 0 && m[i] > 0 && materials[i] < materials_.count());
    });
    if (odd == nowhere) return;
    const Where where{.particle = odd, .id = grains.id(odd)};
    check_material(materials[odd], "of a grain", where);
    fail("dem::Contacts: radius = " + to_text(double(R[odd])) + " m and mass = " +
             to_text(double(m[odd])) + " kg of a grain must be positive; set them",
         where);
  }

  template <class P, class S>
  void find_near(const P& grains, const S& search, FoundOf<P>& touches, double dt) const {
    using Real = typename P::Real;
    check_grains(grains);
    // Near enough to be few, far enough to last for some steps; no farther than the search sees.
    constexpr double lasting_steps = 20;
    const Real wide = reach(grains);
    const auto v = grains[velocity];
    const Real fastest = std::sqrt(
        largest(v.size(), Real(0), [&](Index i) { return v[i].squaredNorm(); }));
    const Real wanted = std::clamp<Real>(Real(2 * lasting_steps * dt) * fastest,
                                         Real(0.002) * wide, Real(0.1) * wide);
    const Real seen = search.radius() + margin_of<Real>(search) - wide;
    touches.renew_near([&](auto& near, auto& validity, auto&& recall) {
      validity.margin = std::clamp<Real>(wanted, 0, std::max<Real>(seen, 0));
      validity.revision = grains.revision();
      const auto owned = grains[position];
      validity.since.assign(owned.begin(), owned.end());
      if constexpr (KnowsTravel<S>) validity.travelled = search.travelled();
      const auto x = grains.with_ghosts(position);
      const auto R = grains.with_ghosts(radius);
      near.find_all(
          grains,
          [&](Index i, auto&& add) {
            for_each_candidate(search, i, [&](Index j) {
              // Of the two images of a pair, that in which the lower id is no ghost.
              if (j >= grains.size() && grains.id(j) < grains.id(i)) return;
              const Real limit = R[i] + R[j] + validity.margin;
              if (!((x[j] - x[i]).squaredNorm() < squared(limit))) return;
              const bool in_order = grains.id(i) < grains.id(j);
              add({static_cast<std::uint32_t>(in_order ? i : j),
                   static_cast<std::uint32_t>(in_order ? j : i)});
            });
          },
          [&](Index i, auto&& add) {
            for_each_wall([&](const auto& wall, Index w) {
              if (wall.nearest(x[i]).distance < R[i] + validity.margin) {
                add(static_cast<std::uint32_t>(w));
              }
            });
          },
          fresh_memory<P>(), recall);
    });
    note_stable_time_step(grains, touches);
  }

  template <class P, class Memory>
  static auto words_from(const Memory& own) {
    typename FoundOf<P>::Near::Words words{};
    if constexpr (words_of<P> > 0) {
      std::memcpy(words.data(), static_cast<const void*>(&own), sizeof own);
    }
    return words;
  }
  template <class P>
  static auto fresh_memory() {
    return words_from<P>(typename LawMemory<Law, P::dimension, typename P::Real>::type{});
  }

  // Geometry of eight contacts.
  template <class P>
  void measure(LanesOf<P>& eight, const typename LanesOf<P>::Columns& columns,
               const FoundOf<P>& touches, Index group) const {
    using Real = typename P::Real;
    const auto& near = touches.near();
    const Real to_contact = settings_.lever_arm == LeverArm::radius ? Real(0) : Real(1);
    const int filled = near.filled(group);
    if (!near.is_of_walls(group)) {
      eight.between(columns, near.first(group), near.second(group), filled, to_contact / 2);
      return;
    }
    eight.at_walls(columns, near.first(group), near.second(group), filled, to_contact,
                   [this](std::uint32_t number, const typename P::Vec& x) {
                     NearestPoint<P::dimension, Real> nearest{};
                     for_each_wall([&](const auto& wall, Index w) {
                       if (w == number) nearest = wall.nearest(x);
                     });
                     return nearest;
                   });
  }

  // The law's force for every contact.
  template <class P>
  void ask_law(const P& grains, FoundOf<P>& touches, typename P::Real dt) {
    using Lanes = LanesOf<P>;
    auto& seen = touches.seen();
    seen.time_step = dt;
    seen.rows.resize(touches.near().size() * Lanes::row_words);
    counts_.assign(chunk_count(touches.near().size()), 0);
    const typename Lanes::Columns columns(grains);
    touches.use_memory([&](const auto& near, auto&& before, auto&& after) {
      for_each_chunk(near.size(), [&](Chunk chunk) {
        Lanes eight;
        Index count = 0;
        for (Index group = chunk.first / lanes; group < chunk.last / lanes; ++group) {
          if (group + 4 < near.groups() && !near.is_of_walls(group + 4)) {
            columns.prefetch(near.second(group + 4));
          }
          measure<P>(eight, columns, touches, group);
          check_centres(near, eight, group);
          ask(grains, near, eight, group, dt, before(group), after(group));
          eight.give(&seen.rows[group * lanes * Lanes::row_words]);
          count += static_cast<Index>(eight.count());
        }
        counts_[chunk.number] = count;
      });
    });
    seen.count = std::accumulate(counts_.begin(), counts_.end(), Index(0));
  }

  template <class P, class Near>
  void ask(const P& grains, const Near& near, LanesOf<P>& eight, Index group, typename P::Real dt,
           const typename P::Real* before, typename P::Real* after) const {
    const auto fresh = fresh_memory<P>();
    if constexpr (LawInLanes<Law, P::dimension, typename P::Real>) {
      if (materials_.count() == 1 && eight.count() > 0) {
        eight.ask(materials_.between(0, 0), dt, fresh, before, after);
        return;
      }
    }
    for (int lane = 0; lane < lanes; ++lane) {
      if (eight.touches(lane)) {
        const Sides sides = sides_of(grains, near, group * lanes + Index(lane));
        eight.ask_one(law_of(grains, sides), lane, dt, before, after);
      } else {
        eight.rest(lane, fresh, after);
      }
    }
  }

  template <class Near, class Lanes>
  static void check_centres(const Near& near, const Lanes& eight, Index group) {
    const int lane = eight.coincident();
    if (lane == lanes) return;
    const Index c = group * lanes + static_cast<Index>(lane);
    fail("dem::Contacts: the centres of grains " + std::to_string(near.first_id(c)) + " and " +
             std::to_string(near.second_id(c)) + " coincide; place them apart",
         {.particle = near.first(group)[lane], .id = near.first_id(c)});
  }

  template <class P>
  auto memory_of(Index c) const {
    return LanesOf<P>::template memory_at<Law>(found<P>().near().memory(c / lanes),
                                               static_cast<int>(c % lanes));
  }

  template <class P>
  void note_stable_time_step(const P& grains, FoundOf<P>& touches) const {
    if constexpr (knows_stiffness<P>) {
      touches.validity().stable_time_step = stable_for_all(
          grains, touches.near(), touches.validity().margin,
          [&](const Sides& sides) -> const Law& { return law_of(grains, sides); });
    }
  }

  template <class P>
  void check_stability(const P& grains, const FoundOf<P>& touches, double dt) const {
    if constexpr (knows_stiffness<P>) {
      if (!settings_.refuse_unstable || dt <= touches.validity().stable_time_step) return;
      const Unstable unstable =
          find_unstable(grains, touches, dt,
                        [&](const Sides& sides) -> const Law& { return law_of(grains, sides); });
      if (unstable.grain == nowhere) return;
      fail("dem::Contacts: time_step = " + to_text(dt) + " s exceeds the stable " +
               to_text(unstable.stable_time_step) + " s of a grain with its contacts; lower it",
           {.particle = unstable.grain, .id = grains.id(unstable.grain)});
    }
  }

  template <class P>
  const Law& law_of(const P& grains, const Sides& sides) const {
    std::uint32_t other = 0;
    if (sides.j != nowhere) {
      other = grains[material][sides.j];
    } else {
      for_each_wall([&](const auto& wall, Index w) {
        if (w == sides.wall) other = wall.material;
      });
    }
    const std::uint32_t own = grains[material][sides.i];
    check_material(std::max(own, other), "of a grain", {.particle = sides.i, .id = grains.id(sides.i)});
    return materials_.between(own, other);
  }

  void check_material(std::uint32_t number, const std::string& whose, Where where = {}) const {
    if (number >= materials_.count()) {
      fail("dem::Contacts: material " + std::to_string(number) + " " + whose + ", but there are " +
               std::to_string(materials_.count()) + "; give Contacts all materials",
           where);
    }
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
  std::vector<Index> counts_;  // by chunk
};

}  // namespace silt::dem
