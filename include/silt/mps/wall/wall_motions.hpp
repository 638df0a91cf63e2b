// SPDX-License-Identifier: MIT
// Walls of faces that move: where they are in a step, and how fast. What moves them is compiled
// only in programs that have moving walls, see moving_walls.hpp.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/point_checksum.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>
#include <silt/mps/wall/flow_of_step.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace silt {

template <int Dim>
struct BodyLoad;

}  // namespace silt

namespace silt::mps {

template <int Dim>
class BodyInFlow;

/// How a mirror moves in a step.
template <int Dim>
struct MotionOfMirror {
  MirrorRate<Dim> slip;    ///< where fluid slips along the walls
  MirrorRate<Dim> stick;   ///< where it sticks to them
  MirrorRate<Dim> change;  ///< of the former since the last step, over Δt [1/s²], [m/s²]

  bool operator==(const MotionOfMirror&) const = default;
};

/// A point that is in a body.
struct PointInBody {
  Index point;          ///< of those asked for; their number if none is in a body
  std::uint32_t group;  ///< of the faces of the body
};

/// What moves the groups of faces of a flow, which are numbered from 1 on.
template <int Dim>
class WallMover {
 public:
  using Vec = silt::Vec<Dim>;

  WallMover() = default;
  virtual ~WallMover() = default;
  /// Another one with the same state.
  virtual std::unique_ptr<WallMover> copy() const = 0;

  /// Places the faces where they were at the beginning of the last step; before the first one, at the
  /// time 0.
  virtual void place(Faces<Dim>& faces) const = 0;
  /// A step from time t [s] on, of this length [s], which the faces get. Spacing l0 in [m]. Throws
  /// if a wall has no position, or goes into another one.
  virtual void begin_step(double t, double time_step, double spacing, Faces<Dim>& faces) = 0;
  /// To be called when the changes of the momentum of the particles have been found: whether it changed
  /// the velocities with which bodies move in this step, so that they have to be found again. The
  /// faces get other moves then.
  virtual bool change_velocities(const FlowOfStep<Dim>& flow, Faces<Dim>& faces) = 0;
  /// Ends the step of the bodies, with the load of the last call of change_velocities().
  virtual void end_step(const FlowOfStep<Dim>& flow) = 0;
  /// Load of the fluid on each group, group 1 first, in a step that has ended: force and torque,
  /// about the centre of mass of a body, otherwise about the origin.
  virtual std::vector<BodyLoad<Dim>> loads(const FlowOfStep<Dim>& flow) const = 0;
  /// The longest time step from time t [s] on, in which no wall moves by more than `distance` [m]
  /// or a twentieth of its period [s].
  virtual double longest_step(double t, double distance) const = 0;
  /// Of the fastest wall in the step [m/s].
  virtual double max_speed() const = 0;
  /// Names the walls of a group, for messages.
  virtual std::string name_of(std::uint32_t group) const = 0;
  /// The number of bodies, whose groups are the last ones.
  virtual std::size_t number_of_bodies() const = 0;
  /// Before the first step, the first of some points, x_of(k) in [m], that is in a body without holes.
  virtual PointInBody find_in_solids(Index number, FunctionRef<Vec(Index)> x_of) const = 0;
  /// Bodies that move freely.
  virtual const std::vector<BodyInFlow<Dim>>& bodies() const = 0;
  /// Keeps the state before a step.
  virtual void save() = 0;
  /// The state that was kept.
  virtual void restore() noexcept = 0;
  /// f(number) for all that the next step needs of the last one.
  virtual void for_each_number(FunctionRef<void(double&)> f) = 0;

  /// The mean velocity of a group in the step.
  virtual const RigidVelocity<Dim>& velocity(std::uint32_t group) const = 0;
  /// How the mirror of these planes moves, see rate_of().
  virtual MotionOfMirror<Dim> motion_of(std::span<const PlaneOfMirror<Dim>> planes) const = 0;

 protected:
  WallMover(const WallMover&) = default;
  WallMover& operator=(const WallMover&) = default;
};

/// The motions of the walls of a flow; empty if all are at rest.
template <int Dim>
class WallMotions {
 public:
  using Vec = silt::Vec<Dim>;

  /// None.
  WallMotions() = default;
  /// Null: none.
  explicit WallMotions(std::unique_ptr<WallMover<Dim>> mover) : mover_(std::move(mover)) {}
  WallMotions(WallMotions&&) noexcept = default;
  WallMotions& operator=(WallMotions&&) noexcept = default;
  WallMotions(const WallMotions& other) : mover_(other.empty() ? nullptr : other.mover_->copy()) {}
  WallMotions& operator=(const WallMotions& other) { return *this = WallMotions(other); }
  ~WallMotions() = default;

  /// Whether there is nothing that moves.
  bool empty() const noexcept { return mover_ == nullptr; }
  /// What moves them, unless this is empty.
  WallMover<Dim>& operator*() const noexcept { return *mover_; }
  WallMover<Dim>* operator->() const noexcept { return mover_.get(); }

  /// Of a point x [m] of a group, 0: at rest [m/s].
  Vec velocity_at(std::uint32_t group, const Vec& x) const {
    return group > 0 ? mover_->velocity(group).at(x) : Vec(Vec::Zero());
  }

  void save() {
    if (!empty()) mover_->save();
  }
  void restore() noexcept {
    if (!empty()) mover_->restore();
  }
  /// What the next step needs of the last one. Throws if the checkpoint is of other walls.
  template <class Archive>
  void transfer(Archive& archive) {
    Buffer<double> numbers;
    if constexpr (!Archive::reads) {
      if (!empty()) mover_->for_each_number([&](double& number) { numbers.push_back(number); });
    }
    archive("state", numbers);
    if constexpr (Archive::reads) {
      Index next = 0;
      const auto read = [&](double& number) {
        if (next < numbers.size()) number = numbers[next];
        ++next;
      };
      if (!empty()) mover_->for_each_number(read);
      if (next == numbers.size()) return;
      fail({"ImageWalls: the checkpoint has ", numbers.size(),
            " numbers of moving walls and bodies, not ", next, "; use the same walls"});
    }
  }

 private:
  std::unique_ptr<WallMover<Dim>> mover_;
};

/// Walls that move, of any type W with
///
///   w.groups()        std::vector<std::vector<Face<Dim>>>, where they are defined
///   w.mover()         std::unique_ptr<WallMover<Dim>> of these groups
///   w.add_to(sum)     adds what identifies them to a PointChecksum
///
/// such as MovingWalls.
template <int Dim>
class AnyMovingWalls {
 public:
  /// None.
  AnyMovingWalls() = default;
  template <class W>
    requires requires(const W walls, PointChecksum& sum) {
      walls.groups();
      walls.mover();
      walls.add_to(sum);
    }
  AnyMovingWalls(W walls) : walls_(std::make_shared<const Of<W>>(std::move(walls))) {}

  /// Whether there are none.
  bool empty() const noexcept { return walls_ == nullptr; }
  /// See above; of none, no groups and nothing that moves.
  std::vector<std::vector<Face<Dim>>> groups() const {
    return empty() ? std::vector<std::vector<Face<Dim>>>() : walls_->groups();
  }
  std::unique_ptr<WallMover<Dim>> mover() const { return empty() ? nullptr : walls_->mover(); }
  void add_to(PointChecksum& sum) const {
    if (!empty()) walls_->add_to(sum);
  }

 private:
  struct Any {
    virtual ~Any() = default;
    virtual std::vector<std::vector<Face<Dim>>> groups() const = 0;
    virtual std::unique_ptr<WallMover<Dim>> mover() const = 0;
    virtual void add_to(PointChecksum& sum) const = 0;
  };
  template <class W>
  struct Of final : Any {
    explicit Of(W given) : walls(std::move(given)) {}
    std::vector<std::vector<Face<Dim>>> groups() const override { return walls.groups(); }
    std::unique_ptr<WallMover<Dim>> mover() const override { return walls.mover(); }
    void add_to(PointChecksum& sum) const override { walls.add_to(sum); }
    W walls;
  };

  std::shared_ptr<const Any> walls_;
};

}  // namespace silt::mps
