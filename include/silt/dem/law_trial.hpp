// SPDX-License-Identifier: MIT
// What is tried on a contact law. conformance.hpp is what users call.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/contact_way.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/law_finding.hpp>
#include <silt/dem/law_on_trial.hpp>
#include <silt/dem/prescribed_contact.hpp>
#include <silt/dem/trial_flight.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace silt::dem {

/// Tries a law in one dimension.
template <int Dim>
class ConformanceTrial {
 public:
  /// Throws if a number of the trial is out of range.
  ConformanceTrial(LawOnTrial<Dim> law, const LawTrial& trial)
      : law_(std::move(law)), trial_(trial) {
    trial.check();
    Grains<Dim> grain;
    add_grain(grain, Vec<Dim>(Vec<Dim>::Zero()),
              {.radius = trial.radius, .density = trial.density});
    motion_.mass = grain[mass][0] / 2;
    motion_.radius = trial.radius / 2;
  }

  std::vector<LawFinding> findings() {
    find_finite();
    const double stiffness = find_stiffness();
    if (!(stiffness > 0)) return found_;
    frequency_ = std::sqrt(stiffness / motion_.mass);
    find_symmetries();
    find_energies();
    find_impacts();
    return found_;
  }

 private:
  using Way = ContactWay;
  using Loads = std::vector<LawLoad<Dim>>;
  using Frame = Eigen::Matrix<double, Dim, Dim>;

  void note(std::string name, double value, double allowed, std::string sentence) {
    found_.push_back({Dim, std::move(name), value, allowed, std::move(sentence)});
  }

  // The larger of the two; infinity in place of what is not finite, so that it stays.
  static void raise(double& most, double value) {
    if (!is_finite(value)) value = std::numeric_limits<double>::infinity();
    most = std::max(most, value);
  }

  PrescribedContact<Dim> contact_on(const Way& way, double duration) const {
    PrescribedMotion motion = motion_;
    motion.duration = duration;
    return prescribe<Dim>(motion, [&](double u) { return pose_on<Dim>(way, u); });
  }

  Loads loads(const PrescribedContact<Dim>& contact) const {
    return loads_along<Dim>(law_.in_double, contact);
  }

  void find_finite() {
    PrescribedContact<Dim> contacts;
    for (const double overlap : {1e-30, 1e-9, 1.0}) {
      for (const double speed : {0.0, 1e-30, 1.0}) {
        for (const double slip : {0.0, 1e-30, 1.0}) {
          Contact<Dim, double> contact;
          contact.normal = Vec<Dim>::Unit(0);
          contact.overlap = overlap * trial_.overlap;
          contact.relative_velocity = -speed * Vec<Dim>::Unit(0) + slip * Vec<Dim>::Unit(1);
          contact.effective_mass = motion_.mass;
          contact.effective_radius = motion_.radius;
          contact.time_step = 1e-6;
          contacts.insert(contacts.end(), 2, contact);
          contacts.emplace_back();  // parted
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
    note("finite answers", broken, 0,
         "contacts that begin, rest or do not slide got so many answers that are not finite "
         "numbers; look for a division by an overlap, a speed or a length that may be 0");
  }

  // Of a slow press, from half of the overlap to nearly all of it [N/m].
  double find_stiffness() {
    const auto contact = contact_on({.depth = trial_.overlap}, 1000);
    const Loads answers = loads(contact);
    const auto push = [&](double share) {
      Index k = 0;
      while (contact[k].overlap < share * trial_.overlap) ++k;
      return answers[k].force.dot(contact[k].normal);
    };
    const double stiffness = (push(0.99) - push(0.5)) / (0.49 * trial_.overlap);
    note("pushes back", stiffness > 0 ? 0 : 1, 0,
         "pressed from half of LawTrial::overlap to all of it, the contact does not push more; "
         "normal points the way that i is pushed");
    return stiffness;
  }

  // Some that stick, slide and roll, fast enough for dashpots to count. They never return to where
  // they were: a slider would stand just at its limit then, and round-off would decide.
  EightContacts<Dim> some_contacts() const {
    EightContacts<Dim> contacts;
    const double slips[] = {0.05, 0.3, 1, 3};
    for (Index k = 0; k < contacts.size(); ++k) {
      const double slip = slips[k / 2] * trial_.overlap;
      contacts[k] = contact_on({.depth = trial_.overlap,
                                .dip = 0.5,
                                .slip = slip,
                                .turn = slip / trial_.radius,
                                .phase = 0.7 + 1.8 * double(k % 2),
                                .pace = 1.37},
                               20 / frequency_);
    }
    return contacts;
  }

  // Most by which loads differ from `sign` times `right`, seen in these frames; over the largest.
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

  void find_symmetries() {
    const auto still = [](double) { return Frame(Frame::Identity()); };
    const auto turned = [](double) { return turned_frame<Dim>(2.1, {0.3, -0.5, 0.8}); };
    // About an axis in the contact plane: of a turn about the normal a law is not told.
    const auto turning = [](double u) { return turned_frame<Dim>(1.3 * u, {0, 0.6, 0.8}); };
    const auto contacts = some_contacts();
    EightLoads<Dim> in_lanes;
    if (law_.in_lanes) in_lanes = law_.in_lanes(contacts);
    double reaction = 0, frame = 0, carried = 0, in_float = 0, lanes_apart = 0;
    for (Index c = 0; c < contacts.size(); ++c) {
      const auto& contact = contacts[c];
      const Loads right = loads(contact);
      raise(reaction,
            difference(loads(from_the_other_side<Dim>(contact)), -1, right, still));
      raise(frame, difference(loads(in_frames<Dim>(contact, turned)), 1, right, turned));
      raise(carried,
            difference(loads(in_frames<Dim>(contact, turning)), 1, right, turning));
      if (law_.in_float) {
        raise(in_float, difference(loads_along<Dim>(law_.in_float, contact), 1, right, still));
      }
      if (law_.in_lanes) raise(lanes_apart, difference(in_lanes[c], 1, right, still));
    }
    note("action equals reaction", reaction, 1e-12,
         "share of the load by which that on j, asked from its side, is not the opposite of that "
         "on i; let forces change sign with normal and velocity, and couples with the spin");
    note("the same in any frame", frame, 1e-9,
         "share of the load by which it does not turn with the contact; use no fixed direction");
    note("memory turns with the contact", carried, 0.02,
         "share of the load by which it stays behind when both grains turn as one body; bring what "
         "is remembered into the plane of the new normal");
    note("the same in float", in_float, 2e-3,
         "share of the load by which float differs from double; look for small differences of "
         "large numbers, and for constants that float does not have");
    note("the same for eight at once", lanes_apart, 1e-9,
         "share of the load by which eight contacts asked together differ from the same asked one "
         "by one; let the answer depend on contact and memory only");
  }

  void find_energies() {
    const double d = trial_.overlap;
    double stored = 0;
    const auto find = [&](const std::string& name, const std::vector<Way>& ways,
                          const std::string& sentence) {
      double most = 0;
      for (const Way& way : ways) {
        // Fast, where dashpots count, and slow, where they do not hide springs.
        for (const double duration : {15 / frequency_, 1e5 / frequency_}) {
          const auto contact = contact_on(way, duration);
          const EnergyGain gain = energy_gain<Dim>(contact, loads(contact));
          raise(most, gain.whole);
          raise(stored, gain.at_any_time);
        }
      }
      note(name, most, 5e-4,
           "share of the work by which a contact gave more than it took " + sentence);
    };
    constexpr double quarter = std::numbers::pi / 2;
    std::vector<Way> slides, slides_under_changing_load, rolls;
    for (const double slip : {0.05, 0.2, 1.0, 5.0}) {
      slides.push_back({.depth = d, .slip = slip * d, .phase = quarter, .aside = true});
      if (Dim == 3) slides.push_back({.depth = d, .slip = slip * d, .round = true});
      // Halfway between in step and a quarter late, what a softening spring makes is most.
      for (const double quarters : {0.5, 1.5}) {
        slides_under_changing_load.push_back(
            {.depth = d, .dip = 0.5, .slip = slip * d, .phase = quarters * quarter});
      }
      const double turn = slip * d / trial_.radius;
      rolls.push_back({.depth = d, .dip = 0.7, .turn = turn, .phase = 1});
      rolls.push_back({.depth = d, .turn = turn, .phase = quarter, .aside = true});
    }
    find("no energy from pressing",
         {{.depth = d}, {.depth = d, .dip = 0.5}, {.depth = d, .dip = 1.3}},
         "when pressed and let go; a dashpot must push while the two approach");
    find("no energy from sliding", slides,
         "when sheared to and fro under load; the force on i must go against its slip");
    find("no energy from sliding under changing load", slides_under_changing_load,
         "when sheared while the load comes and goes; a spring that softens with the load must "
         "lose force with it");
    if (law_.gives_couple) {
      find("no energy from rolling", rolls,
           "when rolled and twisted to and fro; the couple on i must go against relative_spin");
    }
    if (law_.tells_energy) {
      note("elastic_energy is what the springs hold", stored, 5e-3,
           "share of the work by which what a contact gave and says it stores grew; compare "
           "elastic_energy(contact, memory) with the integral of the force");
    }
  }

  void find_impacts() {
    const Grain grain{.radius = trial_.radius, .density = trial_.density};
    FlightStart start{.time_step = std::numbers::pi / frequency_ / 400,
                      .longest = 40 * std::numbers::pi / frequency_};
    double restitution = 0, energy = 0, loss_falls = 0;
    const auto fly = [&] {
      const FlightReport report = TrialFlight<Dim>(grain, start)(law_.in_double());
      raise(energy, report.energy_after / report.energy_before - 1);
      return report;
    };
    for (const bool wall : {false, true}) {
      start.wall = wall;
      double last_loss = 0;
      for (const double share : {0.1, 0.3, 1.0}) {
        start.speed = share * frequency_ * trial_.overlap;
        start.angle = start.spin = 0;
        const FlightReport head_on = fly();
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
    note("restitution is at most 1", restitution, 0.005,
         "what restitution has above 1 in head-on impacts; a dashpot must push while the two "
         "approach");
    note("a faster impact loses no less", loss_falls, 0.005,
         "share of its energy by which a head-on impact lost less than a slower one");
    note("no energy from impacts", energy, 0.01,
         "share by which motion and spin had more energy after an impact than before");
  }

  LawOnTrial<Dim> law_;
  LawTrial trial_;
  PrescribedMotion motion_;
  double frequency_ = 0;  // of a contact of that overlap, about [1/s]
  std::vector<LawFinding> found_;
};

}  // namespace silt::dem
