// SPDX-License-Identifier: MIT
// What changed the momentum of a fluid in a step, from which the loads of walls are found.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/momentum_change.hpp>
#include <silt/mps/fluid/step_changes.hpp>


namespace silt::mps {

/// Those of the particles in the last step, where they were when the pressure was found: some may
/// have been removed since.
template <int Dim>
class MomentumChanges {
 public:
  /// The changes of all particles.
  const Buffer<MomentumChange<Dim>>& all() const noexcept { return all_; }
  void clear() noexcept { all_.clear(); }
  /// Keeps those of the last step in the next one, until it has found its own.
  void save() noexcept { all_.swap(saved_); }
  void restore() noexcept { all_.swap(saved_); }

  /// Finds them from the particles and from what the stages of the step changed.
  /// The pressure acts on bulk volumes, see BulkVolumes.
  template <FluidParticles P, class Change, class Volumes>
  void find(const P& particles, const StepChanges<Change>& changes, const Volumes& volumes) {
    all_.resize(particles.size());
    const auto x = particles[position];
    const auto pressures = particles[pressure];
    for_each(particles.size(), [&](Index i) {
      Change change = changes.pressure[i] * volumes[i];
      if (!changes.friction.empty()) change += changes.friction[i];
      if (!changes.collision.empty()) change += changes.collision[i];
      all_[i] = {.position = x[i].template cast<double>(),
                 .velocity_change = change.template cast<double>(),
                 .pressure = double(pressures[i])};
      if (!changes.wall_stress.empty()) {
        all_[i].wall_stress = changes.wall_stress[i].template cast<double>();
      }
    });
  }

 private:
  Buffer<MomentumChange<Dim>> all_;
  Buffer<MomentumChange<Dim>> saved_;
};

}  // namespace silt::mps
