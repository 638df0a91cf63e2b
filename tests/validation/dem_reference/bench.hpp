// SPDX-License-Identifier: MIT
// A simulation of a few grains under Cundall and Strack's law with up to two planes: compiled once
// for all cases of the table.
#pragma once

#include "support/grains.hpp"

#include <array>
#include <functional>
#include <memory>
#include <string>

namespace silt::test {

template <int Dim>
struct BenchSetup {
  dem::CundallStrack law;
  Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s²]
  double alpha = 0;                     ///< global damping [1/s]
  std::vector<dem::Plane<Dim>> walls = {};  ///< at most two
  bool refuse_unstable = true;
};

template <int Dim>
class Bench {
 public:
  using Grains = dem::Grains<Dim>;
  /// f(i, j, contact, force on i); j is `no_index` at a wall.
  using OnContact =
      std::function<void(Index, Index, const dem::Contact<Dim, double>&, const Vec<Dim>&)>;

  Bench(const Grains& grains, const BenchSetup<Dim>& setup);
  ~Bench();

  const Grains& grains() const;
  Grains at_whole_step() const;  ///< with the velocities of time()
  double time() const;           ///< [s]
  double time_step();            ///< default [s]
  void step(double dt);
  void run(double until);             ///< with the default time step
  void run(double until, double dt);  ///< [s]
  Index contacts() const;
  void for_each_contact(const OnContact& f) const;
  /// Steps until a contact came and went; the largest overlap on the way [m].
  double through_contact(double dt);

 private:
  struct Simulated;
  std::unique_ptr<Simulated> simulated_;
};

/// What differs is the moment of inertia, I = c m R².
struct Body {
  std::string name;
  dem::Shape shape;
  double c;
};
inline const Body disc{"disc", dem::Shape::natural, 0.5};
inline const Body sphere{"sphere", dem::Shape::natural, 0.4};
inline const Body sphere_in_the_plane{"sphere in the plane", dem::Shape::sphere, 0.4};

/// Spin of a grain that rolls in +x on a floor whose normal is the last axis: positive forward.
inline double forward_spin(double spin) { return -spin; }
inline double forward_spin(const Vec<3>& spin) { return spin[1]; }

}  // namespace silt::test
