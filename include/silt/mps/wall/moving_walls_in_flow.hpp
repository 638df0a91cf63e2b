// SPDX-License-Identifier: MIT
// Walls that move and bodies that float, in the steps of a flow.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/mirror_rate.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/mps/wall/body_contacts.hpp>
#include <silt/mps/wall/body_coupling.hpp>
#include <silt/mps/wall/body_in_flow.hpp>
#include <silt/mps/wall/floating_body.hpp>
#include <silt/mps/wall/load_on_group.hpp>
#include <silt/mps/wall/moving_wall_checks.hpp>
#include <silt/mps/wall/prescribed_motion.hpp>
#include <silt/mps/wall/solid_bodies.hpp>
#include <silt/mps/wall/wall_motions.hpp>
#include <silt/mps/wall/wetted_bounds.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt::mps::detail {

/// The moving walls and bodies of a flow: where they are in a step, and what it does to them.
template <int Dim>
class MovingWallsInFlow final : public WallMover<Dim> {
 public:
  using Vec = silt::Vec<Dim>;

  /// Throws if a motion or a body is invalid.
  MovingWallsInFlow(const std::vector<MovingFaces<Dim>>& faces,
                    const std::vector<FloatingBody<Dim>>& bodies) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies_.emplace_back("MovingWalls: body " + std::to_string(b), bodies[b]);
      is_solid_.push_back(!bodies[b].mass_properties);
      if (is_solid_[b] || bodies[b].density == 0) continue;
      fail({"MovingWalls: body ", b, ": density = ", bodies[b].density,
            " kg/m³ has no meaning beside mass_properties; give one of them"});
    }
    for (std::size_t g = 0; g < faces.size(); ++g) {
      groups_.emplace_back("MovingWalls: moving wall " + std::to_string(g), faces[g]);
    }
    now_.steps.resize(groups_.size() + bodies_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      now_.steps[g].before = groups_[g].pose_at(0);
    }
    now_.last.resize(groups_.size() + bodies_.size());
  }

  std::unique_ptr<WallMover<Dim>> copy() const override {
    return std::make_unique<MovingWallsInFlow>(*this);
  }
  std::size_t number_of_bodies() const override { return bodies_.size(); }
  PointInBody find_in_solids(Index number, FunctionRef<Vec(Index)> x_of) const override {
    return solid_bodies().find(number, x_of);
  }
  const std::vector<BodyInFlow<Dim>>& bodies() const override { return bodies_; }
  void place(Faces<Dim>& faces) const override { faces.begin_step(now_.steps); }
  /// Bodies end approaches closer than the spacing [m], see BodyContacts.
  void begin_step(double t, double time_step, double spacing, Faces<Dim>& faces) override {
    time_step_ = time_step;
    coupling_.clear();
    holds_bodies_ = false;
    now_.last = now_.steps;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      now_.steps[g] = groups_[g].step(t, time_step, spacing);
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b].begin_step("MovingWalls: body " + std::to_string(b), t, time_step);
    }
    find_steps_of_bodies();
    faces.begin_step(now_.steps);
    if (now_.is_first) {
      require_resolved_bodies(bodies_, faces, group_of_body(0), spacing);
      require_no_crossing_at_first(faces, solid_bodies(), spacing, names());
    }
    if (!bodies_.empty()) {
      contacts_.end_approaches(
          bodies_, faces, spacing, time_step, [&](std::size_t b) { return group_of_body(b); },
          [&](std::uint32_t group, const Vec& x) { return velocity_at(group, x); });
      require_resolved_moves(bodies_, time_step, spacing);
      find_steps_of_bodies();
      faces.set_moves(now_.steps);
    }
    now_.fastest_given = std::max(now_.fastest_given, speed_of_given());
    if (now_.is_first) {
      now_.last = now_.steps;
      for (const BodyInFlow<Dim>& body : bodies_) {
        now_.fastest_given = std::max(now_.fastest_given, body.max_speed());
      }
      now_.extent = extent_of(faces);
    }
    now_.is_first = false;
    require_no_crossing(faces, spacing, names());
  }
  bool change_velocities(const FlowOfStep<Dim>& flow, Faces<Dim>& faces) override {
    if (bodies_.empty()) return false;
    if (coupling_.is_empty()) {
      require_heavy_enough(bodies_, flow.density);
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        bodies_[b].set_shares(wetted_bounds(flow, group_of_body(b), bodies_[b].state().position));
      }
    }
    loads_.resize(bodies_.size());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      loads_[b] = load_on(group_of_body(b), bodies_[b].state().position, flow);
    }
    if (holds_bodies_) return false;
    if (!coupling_.change(bodies_, loads_, flow)) {
      if (coupling_.is_empty()) return false;
      // What the coupling found may be into a wall against which a body is pressed.
      holds_bodies_ = true;
      contacts_.end_approaches_of_faces(bodies_, flow.spacing, flow.time_step);
    }
    const Buffer<StepOfFaces<Dim>> before = now_.steps;
    find_steps_of_bodies();
    faces.set_moves(now_.steps);
    return !holds_bodies_ || change_since(before, faces) > 1e-6 * flow.spacing / flow.time_step;
  }
  void end_step(const FlowOfStep<Dim>& flow) override {
    // In an impact, bodies have other velocities than at the beginning.
    if (!coupling_.is_empty()) {
      require_resolved_moves(bodies_, flow.time_step, flow.spacing);
      require_no_crossing(flow.near.faces(), flow.spacing, names());
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Vec acceleration = flow.acceleration(bodies_[b].state().position);
      bodies_[b].end_step(loads_[b], acceleration, flow.time_step);
      now_.fastest_of_fall = std::max(now_.fastest_of_fall, speed_of_fall(b, acceleration));
      const double expected = expected_speed();
      if (bodies_[b].max_speed() <= 10 * expected) continue;
      fail({"MovingWalls: body ", b, " moves at ", bodies_[b].max_speed(),
            " m/s, more than ten times ", expected,
            " m/s, the speed of bodies at first, of moving walls and of a fall through all walls; "
            "reduce the time step or its load, or give it a larger density"});
    }
  }

  std::vector<BodyLoad<Dim>> loads(const FlowOfStep<Dim>& flow) const override {
    std::vector<BodyLoad<Dim>> loads;
    for (std::uint32_t group = 1; group <= now_.steps.size(); ++group) {
      const bool is_body = group > groups_.size();
      const Vec about = is_body ? now_.steps[group - 1].before.x_of(
                                      bodies_[group - 1 - groups_.size()].mass_properties().centre)
                                : Vec(Vec::Zero());
      loads.push_back(load_on(group, about, flow));
    }
    return loads;
  }

  double longest_step(double t, double distance) const override {
    double longest = std::numeric_limits<double>::infinity();
    for (const PrescribedMotion<Dim>& group : groups_) {
      longest = std::min(longest, group.longest_step(t, distance));
    }
    for (const BodyInFlow<Dim>& body : bodies_) {
      longest = std::min(longest, distance / body.max_speed());
    }
    return longest;
  }
  double max_speed() const override {
    double fastest = speed_of_given();
    // Of a body not more than it can be expected to have: it may be the one that goes wrong.
    for (const BodyInFlow<Dim>& body : bodies_) {
      fastest = std::max(fastest, std::min(body.max_speed(), expected_speed()));
    }
    return fastest;
  }

  const RigidVelocity<Dim>& velocity(std::uint32_t group) const override {
    return now_.steps[group - 1].velocity;
  }
  MotionOfMirror<Dim> motion_of(std::span<const PlaneOfMirror<Dim>> planes) const override {
    const auto velocity_of = [&](std::uint32_t group) { return velocity(group); };
    const auto acceleration_of = [&](std::uint32_t group) {
      return Acceleration{now_.steps[group - 1], now_.last[group - 1], time_step_};
    };
    return {.slip = rate_of<Dim>(planes, AlongMirror::slip, velocity_of),
            .stick = rate_of<Dim>(planes, AlongMirror::stick, velocity_of),
            .change = rate_of<Dim>(planes, AlongMirror::slip, acceleration_of)};
  }
  std::string name_of(std::uint32_t group) const override {
    if (group == 0) return "a wall at rest";
    if (group <= groups_.size()) return "moving wall " + std::to_string(group - 1);
    return "body " + std::to_string(group - 1 - groups_.size());
  }

  void save() override {
    saved_ = now_;
    for (BodyInFlow<Dim>& body : bodies_) body.save();
  }
  void restore() noexcept override {
    std::swap(now_, saved_);
    for (BodyInFlow<Dim>& body : bodies_) body.restore();
  }
  void for_each_number(FunctionRef<void(double&)> f) override {
    double is_first = now_.is_first ? 1 : 0;
    f(is_first);
    f(now_.fastest_given);
    f(now_.fastest_of_fall);
    f(now_.extent);
    now_.is_first = is_first != 0;
    for (StepOfFaces<Dim>& step : now_.steps) for_each_number_of(step, f);
    for (BodyInFlow<Dim>& body : bodies_) body.for_each_number(f);
  }

 private:
  // Of the points of a group: the change of their mean velocity since the last step, over Δt
  // [m/s²]; 0 in the first step.
  struct Acceleration {
    const StepOfFaces<Dim>& now;
    const StepOfFaces<Dim>& last;
    double time_step;

    // Of the point that is at x at the beginning of the step.
    Vec at(const Vec& x) const {
      return (now.velocity.at(x) - last.velocity.at(last.move.X_of(x))) / time_step;
    }
  };

  // Of the velocities of bodies, at ends of their bounds [m/s].
  double change_since(const Buffer<StepOfFaces<Dim>>& before, const Faces<Dim>& faces) const {
    double change = 0;
    for (std::uint32_t group = group_of_body(0); group <= now_.steps.size(); ++group) {
      const auto bounds = faces.bounds_of_group(group);
      for (const Vec& x : {bounds.lower, bounds.upper}) {
        const Vec now = velocity(group).at(x);
        change = std::max(change, (now - before[group - 1].velocity.at(x)).norm());
      }
    }
    return change;
  }
  // Of the walls with a given motion, in the step [m/s].
  double speed_of_given() const {
    double fastest = 0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      fastest = std::max(fastest, groups_[g].max_speed(now_.steps[g]));
    }
    return fastest;
  }
  // After a fall through the extent of all walls [m/s].
  double speed_of_fall(std::size_t b, const Vec& acceleration) const {
    const double by_user =
        bodies_[b].load_of_user().force.norm() / bodies_[b].mass_properties().mass;
    return std::sqrt(2 * (acceleration.norm() + by_user) * now_.extent);
  }
  double expected_speed() const { return now_.fastest_given + now_.fastest_of_fall; }

  static BodyLoad<Dim> load_on(std::uint32_t group, const Vec& about, const FlowOfStep<Dim>& flow) {
    const LoadOnGroup<Dim> load(
        flow.near.faces(), group, flow.box, about,
        {.density = flow.density, .spacing = flow.spacing, .time_step = flow.time_step});
    return load.sum(flow.changes, flow.sum);
  }
  void find_steps_of_bodies() {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      now_.steps[groups_.size() + b] = bodies_[b].step(time_step_);
    }
  }
  // The group of a body.
  std::uint32_t group_of_body(std::size_t body) const {
    return static_cast<std::uint32_t>(groups_.size() + body + 1);
  }
  Vec velocity_at(std::uint32_t group, const Vec& x) const {
    return group > 0 ? velocity(group).at(x) : Vec(Vec::Zero());
  }
  template <class F>
  static void for_each_number_of(StepOfFaces<Dim>& step, F&& f) {
    for (double& number : step.before.rotation.reshaped()) f(number);
    for (double& number : step.before.shift) f(number);
    for (double& number : step.move.rotation.reshaped()) f(number);
    for (double& number : step.move.shift) f(number);
    for (double& number : step.velocity.linear) f(number);
    for (double& number : step.velocity.about) f(number);
    for (int k = 0; k < angular_size<Dim>; ++k) f(component(step.velocity.spin, k));
  }
  // The diagonal of the box around all of them [m].
  static double extent_of(const Faces<Dim>& faces) {
    if (faces.elements().empty()) return 0;
    auto all = faces.bounds_of(0);
    for (std::uint32_t k = 1; k < faces.elements().size(); ++k) all.enclose(faces.bounds_of(k));
    return (all.upper - all.lower).norm();
  }
  SolidBodies<Dim> solid_bodies() const {
    SolidBodies<Dim> solid;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (is_solid_[b]) solid.add(group_of_body(b), bodies_[b].faces());
    }
    return solid;
  }
  // Where faces go through others: those of a disc or a sphere are not where its contacts are.
  auto names() const {
    return [this](std::uint32_t group) {
      std::string name = name_of(group);
      if (group < group_of_body(0)) return name;
      const double away = bodies_[group - group_of_body(0)].deviation_of_faces();
      if (away > 0) {
        name += " (whose faces are up to " + to_text(away) +
                " m away from its radius: let it begin a spacing away from all others)";
      }
      return name;
    };
  }
  std::vector<PrescribedMotion<Dim>> groups_;
  std::vector<BodyInFlow<Dim>> bodies_;  // their groups follow those
  std::vector<bool> is_solid_;           // of each body: whether it is given by a density
  BodyContacts<Dim> contacts_;
  BodyCoupling<Dim> coupling_;
  bool holds_bodies_ = false;         // their velocities in the step are found
  std::vector<BodyLoad<Dim>> loads_;  // of the fluid in the step
  double time_step_ = 1;
  struct State {
    bool is_first = true;
    double fastest_given = 0;    // of walls, and of bodies at first [m/s]
    double fastest_of_fall = 0;  // see speed_of_fall()
    double extent = 0;           // of all walls at first [m]
    Buffer<StepOfFaces<Dim>> steps;
    Buffer<StepOfFaces<Dim>> last;
  };
  State now_;
  State saved_;
};

}  // namespace silt::mps::detail
