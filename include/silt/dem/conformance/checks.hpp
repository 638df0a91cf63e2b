// SPDX-License-Identifier: MIT
// The conformance checks of a contact law, their conditions and results. The user interface is
// conformance.hpp.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/conformance/impact.hpp>
#include <silt/dem/conformance/law_adapter.hpp>
#include <silt/dem/conformance/prescribed_contact.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace silt::dem {

/// Conditions of the checks; choose those for which the law is intended.
struct ConformanceConditions {
  double radius = 0.01;   ///< R of the grains [m]
  double density = 2500;  ///< ρ [kg/m³]
  double overlap = 1e-4;  ///< typical maximum overlap δ [m]

  /// Throws if a number is out of range.
  void check() const {
    require_positive("ConformanceConditions: radius", radius);
    require_positive("ConformanceConditions: density", density);
    require_positive("ConformanceConditions: overlap", overlap);
    if (overlap > radius / 2) {
      fail({"ConformanceConditions: overlap = ", overlap,
            " m is more than half of radius = ", radius, " m; decrease it"});
    }
  }
};

/// Result of one check.
struct ConformanceCheck {
  int dimension = 0;        ///< 2 or 3, of the contact that was checked
  std::string name;         ///< e.g. "action equals reaction"
  double value = 0;         ///< measured [-]
  double limit = 0;         ///< of the value [-]
  std::string explanation;  ///< meaning of the value, and hints if it is too large

  /// Whether the value is within the limit.
  bool passes() const { return value <= limit; }
};

/// Results of all checks of a law.
struct ConformanceReport {
  std::vector<ConformanceCheck> checks;  ///< in the order in which they were made

  /// Whether all checks pass.
  bool passes() const {
    return std::all_of(checks.begin(), checks.end(),
                       [](const auto& check) { return check.passes(); });
  }
  /// Whether the check with this name passes in every dimension; false if there is no such check.
  bool passes(std::string_view name) const {
    bool found = false;
    for (const ConformanceCheck& check : checks) {
      if (check.name != name) continue;
      if (!check.passes()) return false;
      found = true;
    }
    return found;
  }
  /// One line for each failed check.
  std::string text() const {
    std::string text;
    for (const ConformanceCheck& check : checks) {
      if (check.passes()) continue;
      text += std::to_string(check.dimension) + "D, " + check.name + ": " + to_text(check.value) +
              ", limit " + to_text(check.limit) + ": " + check.explanation + "\n";
    }
    return text;
  }
};

namespace detail {

/// Checks a law in one dimension.
template <int Dim>
class ConformanceChecks {
 public:
  /// Throws if a condition is out of range.
  ConformanceChecks(LawAdapter<Dim> law, const ConformanceConditions& conditions)
      : law_(std::move(law)), conditions_(conditions) {
    conditions.check();
    Grains<Dim> grain;
    add_grain(grain, Vec<Dim>(Vec<Dim>::Zero()),
              {.radius = conditions.radius, .density = conditions.density});
    motion_.mass = grain[mass][0] / 2;
    motion_.radius = conditions.radius / 2;
  }

  std::vector<ConformanceCheck> run() {
    check_finite();
    const double stiffness = check_stiffness();
    if (!(stiffness > 0)) return checks_;
    frequency_ = std::sqrt(stiffness / motion_.mass);
    check_symmetries();
    check_energies();
    check_impacts();
    return checks_;
  }

 private:
  using Path = ContactPath;
  using Loads = std::vector<LawLoad<Dim>>;
  using Frame = Eigen::Matrix<double, Dim, Dim>;

  void add_check(std::string name, double value, double limit, std::string explanation) {
    checks_.push_back({Dim, std::move(name), value, limit, std::move(explanation)});
  }

  // Keeps the larger of the two. Values that are not finite count as infinity.
  static void raise(double& maximum, double value) {
    if (!is_finite(value)) value = std::numeric_limits<double>::infinity();
    maximum = std::max(maximum, value);
  }

  PrescribedContact<Dim> contact_on(const Path& path, double duration) const {
    PrescribedMotion motion = motion_;
    motion.duration = duration;
    return prescribe<Dim>(motion, [&](double u) { return pose_on<Dim>(path, u); });
  }

  Loads loads(const PrescribedContact<Dim>& contact) const {
    return loads_along<Dim>(law_.in_double, contact);
  }

  void check_finite() {
    PrescribedContact<Dim> contacts;
    for (const double overlap : {1e-30, 1e-9, 1.0}) {
      for (const double speed : {0.0, 1e-30, 1.0}) {
        for (const double slip : {0.0, 1e-30, 1.0}) {
          Contact<Dim, double> contact;
          contact.normal = Vec<Dim>::Unit(0);
          contact.overlap = overlap * conditions_.overlap;
          contact.relative_velocity = -speed * Vec<Dim>::Unit(0) + slip * Vec<Dim>::Unit(1);
          contact.effective_mass = motion_.mass;
          contact.effective_radius = motion_.radius;
          contact.time_step = 1e-6;
          contacts.insert(contacts.end(), 2, contact);
          contacts.emplace_back();  // separated
        }
      }
    }
    double broken = 0;
    for (const auto& in_precision : {law_.in_double, law_.in_float}) {
      if (!in_precision) continue;
      for (const auto& load : loads_along<Dim>(in_precision, contacts)) {
        const bool sound =
            is_finite(load.force) && is_finite(load.couple) && is_finite(load.stored);
        if (!sound) broken += 1;
      }
    }
    add_check(
        "finite results", broken, 0,
        "number of results that are not finite, for contacts with overlap, speed or slip near 0; "
        "check for divisions by an overlap, a speed or a length that may be 0");
  }

  // Secant stiffness of slow loading, from half of the overlap to nearly all of it [N/m].
  double check_stiffness() {
    const auto contact = contact_on({.depth = conditions_.overlap}, 1000);
    const Loads answers = loads(contact);
    const auto push = [&](double share) {
      Index k = 0;
      while (contact[k].overlap < share * conditions_.overlap) ++k;
      return answers[k].force.dot(contact[k].normal);
    };
    const double stiffness = (push(0.99) - push(0.5)) / (0.49 * conditions_.overlap);
    add_check(
        "repulsive", stiffness > 0 ? 0 : 1, 0,
        "the repulsive force does not increase between half of ConformanceConditions::overlap and "
        "all of it; normal points from j to i");
    return stiffness;
  }

  // Contacts that stick, slide and roll, fast enough for dashpots to matter. They never return to
  // an earlier state: a slider would then be exactly at its limit, and its state would depend on
  // round-off.
  EightContacts<Dim> some_contacts() const {
    EightContacts<Dim> contacts;
    const double slips[] = {0.05, 0.3, 1, 3};
    for (Index k = 0; k < contacts.size(); ++k) {
      const double slip = slips[k / 2] * conditions_.overlap;
      contacts[k] = contact_on({.depth = conditions_.overlap,
                                .unloading = 0.5,
                                .slip = slip,
                                .rotation = slip / conditions_.radius,
                                .phase = 0.7 + 1.8 * double(k % 2),
                                .pace = 1.37},
                               20 / frequency_);
    }
    return contacts;
  }

  // Maximum difference of `loads` and `sign` times `right` in these frames, relative to the
  // maximum.
  template <class FrameAt>
  static double difference(const Loads& loads, double sign, const Loads& right,
                           FrameAt&& frame_at) {
    double force = 0, couple = 0, force_apart = 0, couple_apart = 0;
    for (Index k = 0; k < loads.size(); ++k) {
      const Frame frame = frame_at(double(k + 1) / double(loads.size()));
      const AngularVec<Dim> seen = in_frame<Dim>(frame, right[k].couple);
      raise(force, right[k].force.norm());
      raise(couple, squared_norm(right[k].couple));
      raise(force_apart, (loads[k].force - sign * (frame * right[k].force)).norm());
      raise(couple_apart, squared_norm(AngularVec<Dim>(loads[k].couple - sign * seen)));
    }
    return std::max(force_apart / force, couple > 0 ? std::sqrt(couple_apart / couple) : 0.0);
  }

  void check_symmetries() {
    const auto still = [](double) { return Frame(Frame::Identity()); };
    const auto turned = [](double) { return rotated_frame<Dim>(2.1, {0.3, -0.5, 0.8}); };
    // About an axis in the contact plane: rotation about the normal is not part of a law's input.
    const auto turning = [](double u) { return rotated_frame<Dim>(1.3 * u, {0, 0.6, 0.8}); };
    const auto contacts = some_contacts();
    EightLoads<Dim> in_lanes;
    if (law_.in_lanes) in_lanes = law_.in_lanes(contacts);
    double reaction = 0, frame = 0, carried = 0, in_float = 0, lanes_apart = 0;
    for (Index c = 0; c < contacts.size(); ++c) {
      const auto& contact = contacts[c];
      const Loads right = loads(contact);
      raise(reaction, difference(loads(from_the_other_side<Dim>(contact)), -1, right, still));
      raise(frame, difference(loads(in_frames<Dim>(contact, turned)), 1, right, turned));
      raise(carried, difference(loads(in_frames<Dim>(contact, turning)), 1, right, turning));
      if (law_.in_float) {
        raise(in_float, difference(loads_along<Dim>(law_.in_float, contact), 1, right, still));
      }
      if (law_.in_lanes) raise(lanes_apart, difference(in_lanes[c], 1, right, still));
    }
    add_check(
        "action equals reaction", reaction, 1e-12,
        "relative deviation of the load on j, evaluated from its side, from the opposite of that "
        "on i; forces must change sign with normal and velocity, and couples with the spin");
    add_check("the same in any frame", frame, 1e-9,
              "relative deviation of the load in a rotated frame; use no fixed direction");
    add_check(
        "history rotates with the contact", carried, 0.02,
        "relative deviation of the load when both grains rotate as one body; rotate vectors of "
        "the history into the plane of the new normal");
    add_check("the same in float", in_float, 2e-3,
              "relative deviation of the load in float from double; check for small differences of "
              "large numbers and for constants that float cannot represent");
    add_check("independent of vectorisation", lanes_apart, 1e-9,
              "relative deviation of the load of eight contacts evaluated at once from the same "
              "evaluated one at a time; the result must depend on contact and history only");
  }

  void check_energies() {
    const double d = conditions_.overlap;
    double stored = 0;
    const auto find = [&](const std::string& name, const std::vector<Path>& paths,
                          const std::string& explanation) {
      double maximum = 0;
      for (const Path& path : paths) {
        // Fast, where dashpots matter, and slow, where they do not mask errors of the springs.
        for (const double duration : {15 / frequency_, 1e5 / frequency_}) {
          const auto contact = contact_on(path, duration);
          const EnergyGain gain = energy_gain<Dim>(contact, loads(contact));
          raise(maximum, gain.total);
          raise(stored, gain.max_growth);
        }
      }
      add_check(name, maximum, 5e-4,
                "energy generated by a contact, relative to the work, " + explanation);
    };
    constexpr double quarter = std::numbers::pi / 2;
    std::vector<Path> slides, slides_under_changing_load, rolls;
    for (const double slip : {0.05, 0.2, 1.0, 5.0}) {
      slides.push_back({.depth = d, .slip = slip * d, .phase = quarter, .shifted_release = true});
      if (Dim == 3) slides.push_back({.depth = d, .slip = slip * d, .circular = true});
      // The energy generated by a softening spring is largest at phases of 1/8 and 3/8 of a cycle.
      for (const double quarters : {0.5, 1.5}) {
        slides_under_changing_load.push_back(
            {.depth = d, .unloading = 0.5, .slip = slip * d, .phase = quarters * quarter});
      }
      const double rotation = slip * d / conditions_.radius;
      rolls.push_back({.depth = d, .unloading = 0.7, .rotation = rotation, .phase = 1});
      rolls.push_back(
          {.depth = d, .rotation = rotation, .phase = quarter, .shifted_release = true});
    }
    find("no energy gain in normal loading",
         {{.depth = d}, {.depth = d, .unloading = 0.5}, {.depth = d, .unloading = 1.3}},
         "in loading and unloading; a dashpot must be repulsive during approach");
    find("no energy gain in sliding", slides,
         "in cyclic shear under load; the force on i must oppose its slip");
    find("no energy gain in sliding under changing load", slides_under_changing_load,
         "in cyclic shear under cyclic load; a spring that softens on unloading must lose force in "
         "proportion");
    if (law_.gives_couple) {
      find("no energy gain in rolling", rolls,
           "in cyclic rolling and twisting; the couple on i must oppose relative_spin");
    }
    if (law_.gives_energy) {
      add_check(
          "elastic_energy is the energy of the springs", stored, 5e-3,
          "largest growth of the released plus the stored energy, relative to the work; compare "
          "elastic_energy(contact, history) with the integral of the force");
    }
  }

  void check_impacts() {
    const Grain grain{.radius = conditions_.radius, .density = conditions_.density};
    ImpactStart start{.time_step = std::numbers::pi / frequency_ / 400,
                      .max_time = 40 * std::numbers::pi / frequency_};
    double restitution = 0, energy = 0, loss_falls = 0;
    const auto fly = [&] {
      const ImpactResult report = TestImpact<Dim>(grain, start)(law_.in_double());
      raise(energy, report.energy_after / report.energy_before - 1);
      return report;
    };
    for (const bool wall : {false, true}) {
      start.wall = wall;
      double last_loss = 0;
      for (const double share : {0.1, 0.3, 1.0}) {
        start.speed = share * frequency_ * conditions_.overlap;
        start.angle = start.spin = 0;
        const ImpactResult head_on = fly();
        const double loss = head_on.energy_before - head_on.energy_after;
        raise(restitution, head_on.restitution - 1);
        raise(loss_falls, (last_loss - loss) / head_on.energy_before);
        last_loss = loss;
        for (const double angle : {0.5, 1.2}) {
          start.angle = angle;
          for (const double spin : {0.0, 1.0, -1.0}) {
            start.spin = spin;
            fly();
          }
        }
      }
    }
    add_check(
        "restitution is at most 1", restitution, 0.005,
        "excess of the restitution over 1 in head-on impacts; a dashpot must be repulsive during "
        "approach");
    add_check(
        "energy loss does not decrease with speed", loss_falls, 0.005,
        "amount by which a head-on impact lost less energy than a slower one, relative to its "
        "energy");
    add_check("no energy gain in impacts", energy, 0.01,
              "relative increase of the kinetic energy, including rotation, in an impact");
  }

  LawAdapter<Dim> law_;
  ConformanceConditions conditions_;
  PrescribedMotion motion_;
  double frequency_ = 0;  // approximate angular frequency of a contact [1/s]
  std::vector<ConformanceCheck> checks_;
};

}  // namespace detail
}  // namespace silt::dem
