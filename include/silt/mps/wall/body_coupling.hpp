// SPDX-License-Identifier: MIT
// Finds velocities of bodies and pressures of the fluid that belong together.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/mps/wall/body_in_flow.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace silt::mps {

/// In an impact, the velocity W with which the faces of a body move in the step and the velocity V that
/// the load then gives the body differ: the fluid takes the momentum Mₐ W at once, whatever the mass of the
/// body. Then W changes within the step, and the pressure is found again, until both agree, as in a solve for
/// pressure and accelerations together. W ← W + θ (V − W) alone would need many solves; Anderson's
/// acceleration [Anderson1965], the combination of all W of the step whose V − W is least, needs one more than
/// there are components if V depends linearly on W. A smooth motion needs no further solve: W follows V from
/// step to step, see BodyInFlow.
template <int Dim>
class BodyCoupling {
 public:
  /// At the beginning of a step.
  void clear() { tried_ = 0; }
  /// Whether no velocities were tried in the step.
  bool is_empty() const { return tried_ == 0; }

  /// Whether the velocities of the bodies had to be changed, with these loads of the fluid.
  bool change(std::vector<BodyInFlow<Dim>>& bodies, const std::vector<BodyLoad<Dim>>& loads,
              const FlowOfStep<Dim>& flow) {
    const Eigen::Index size = Eigen::Index(bodies.size()) * components;
    const Numbers all_behind = behind_of(bodies, loads, flow);
    const auto [now, share] = velocities_of(bodies);
    if (tried_ == 0) is_coupled_.assign(bodies.size(), false);
    bool agree = true;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const auto own = [&](const Numbers& numbers) {
        return numbers.segment(Eigen::Index(b) * components, components).norm();
      };
      // A body that falls, or lies on a floor, is behind by what gravity gives it in the step.
      const double by_gravity =
          of_mass(bodies[b]) * flow.acceleration(bodies[b].state().position).norm();
      if (!(own(all_behind) > 0.05 * own(now) + 1.01 * flow.time_step * by_gravity)) continue;
      is_coupled_[b] = true;
      agree = false;
    }
    if (agree || tried_ >= max_solves) return false;
    // Other bodies do not take part: theirs may be much larger than what a light one has to agree
    // to.
    const auto of_coupled = [&](Numbers numbers) {
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!is_coupled_[b]) numbers.segment(Eigen::Index(b) * components, components).setZero();
      }
      return numbers;
    };
    const Numbers behind = of_coupled(all_behind);
    // Differences from what was tried before, in columns.
    const Eigen::Index known = std::min<Eigen::Index>(Eigen::Index(tried_), size);
    Numbers next = now + share.cwiseProduct(behind);
    if (known > 0) {
      Matrix dx(size, known), df(size, known);
      for (Eigen::Index k = 0; k < known; ++k) {
        const Try& before = tries_[tried_ - 1 - std::size_t(k)];
        dx.col(k) = now - before.velocities;
        df.col(k) = of_coupled(all_behind - before.behind);
      }
      Matrix normal = df.transpose() * df;
      const double scale = normal.trace() / double(known);
      for (Eigen::Index k = 0; k < known; ++k) normal(k, k) += 1e-10 * scale;
      const Numbers right = df.transpose() * behind;
      const Numbers weights = normal.fullPivLu().solve(right);
      next -= dx * weights + share.cwiseProduct(Numbers(df * weights));
    }
    tries_.resize(max_solves);
    tries_[tried_++] = {now, all_behind};
    const Numbers step = next - now;
    Eigen::Index row = 0;
    for (BodyInFlow<Dim>& body : bodies) {
      typename BodyInFlow<Dim>::Velocities by{Vec<Dim>::Zero(), zero_of<AngularVec<Dim>>()};
      for (int k = 0; k < Dim; ++k) by.linear[k] = step[row++] / of_mass(body);
      for (int k = 0; k < angular_size<Dim>; ++k) component(by.spin, k) = step[row++] / of_spin(body);
      body.change_faces(by);
    }
    return true;
  }

 private:
  using Numbers = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;
  static constexpr Eigen::Index components = Dim + angular_size<Dim>;
  static constexpr std::size_t max_solves = 16;

  // Velocities times roots of masses: their squares are energies.
  struct Try {
    Numbers velocities;
    Numbers behind;  // V − W
  };
  struct Scaled {
    Numbers velocities;
    Numbers share;  // θ
  };
  static double of_mass(const BodyInFlow<Dim>& body) {
    return std::sqrt(body.mass_properties().mass);
  }
  static double of_spin(const BodyInFlow<Dim>& body) { return std::sqrt(body.least_inertia()); }

  static Numbers behind_of(const std::vector<BodyInFlow<Dim>>& bodies,
                           const std::vector<BodyLoad<Dim>>& loads, const FlowOfStep<Dim>& flow) {
    Numbers behind(Eigen::Index(bodies.size()) * components);
    Eigen::Index row = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const BodyInFlow<Dim>& body = bodies[b];
      const auto by =
          body.behind(loads[b], flow.acceleration(body.state().position), flow.time_step);
      for (int k = 0; k < Dim; ++k) behind[row++] = of_mass(body) * by.linear[k];
      for (int k = 0; k < angular_size<Dim>; ++k) behind[row++] = of_spin(body) * component(by.spin, k);
    }
    return behind;
  }
  static Scaled velocities_of(const std::vector<BodyInFlow<Dim>>& bodies) {
    const Eigen::Index size = Eigen::Index(bodies.size()) * components;
    Scaled scaled{Numbers(size), Numbers(size)};
    Eigen::Index row = 0;
    for (const BodyInFlow<Dim>& body : bodies) {
      const BodyState<Dim> state = body.state();
      for (int k = 0; k < Dim; ++k) {
        scaled.share[row] = body.share()[k];
        scaled.velocities[row++] = of_mass(body) * state.velocity[k];
      }
      for (int k = 0; k < angular_size<Dim>; ++k) {
        scaled.share[row] = body.share_of_spin();
        scaled.velocities[row++] = of_spin(body) * component(state.spin, k);
      }
    }
    return scaled;
  }

  std::vector<bool> is_coupled_;  // of each body, in this step
  std::vector<Try> tries_;
  std::size_t tried_ = 0;
};

}  // namespace silt::mps
