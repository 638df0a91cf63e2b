// SPDX-License-Identifier: MIT
// Load and wear of a wall of grains over time, for a CsvSeries.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/dem/wall/wall.hpp>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::dem {

/// Measure of a wall, given by its number: its load in the last step, and since the beginning the
/// work of the tangential forces on it and the volume that wears off, V = k ∫ F_n |u_t| dt
/// [Archard1953], with u_t the velocity at which grains slide on it. With the velocities at half
/// steps. Of the grains of one process. To be used in a CsvSeries, or with after_step() called
/// after every step.
template <int Dim>
class WallWear {
 public:
  struct Settings {
    Index wall = 0;                     ///< its number
    double coefficient = 0;             ///< k: volume per force and way [m³/(N m)]; 0: no wear
    Vec<Dim> about = Vec<Dim>::Zero();  ///< point of the torque [m]
  };
  /// Throws if the coefficient is negative, or the point not finite.
  explicit WallWear(const Settings& settings) : settings_(settings) {
    require_not_negative("dem::WallWear: coefficient", settings_.coefficient);
    require_finite("dem::WallWear: about", settings_.about);
  }

  const Vec<Dim>& force() const noexcept { return force_; }           ///< on the wall [N]
  const AngularVec<Dim>& torque() const noexcept { return torque_; }  ///< on the wall [N m]
  double sliding_work() const noexcept { return work_; }              ///< of tangential forces [J]
  double worn_volume() const noexcept { return worn_; }               ///< [m³]

  /// Throws if there is no such wall.
  template <class Sim, class... Run>
  void after_step(const Sim& simulation, const Run&...) {
    static_assert(
        silt::detail::are_of_one_process<std::remove_cvref_t<decltype(simulation.particles())>>,
        "silt::dem::WallWear: it knows the contacts of one process only");
    force_ = Vec<Dim>::Zero();
    torque_ = zero_of<AngularVec<Dim>>();
    add(simulation.interaction(), simulation.particles(), simulation.last_time_step());
  }

  /// For a CsvSeries: the names of the numbers, how they are found, and the numbers [N, N m, J,
  /// m³].
  std::vector<std::string> columns() const {
    std::vector<std::string> names;
    const char* const axes[] = {"x", "y", "z"};
    for (int k = 0; k < Dim; ++k) names.push_back(std::string("force_") + axes[k] + " [N]");
    for (int k = 0; k < angular_size<Dim>; ++k) {
      names.push_back(Dim == 2 ? "torque [N m]" : std::string("torque_") + axes[k] + " [N m]");
    }
    names.insert(names.end(), {"sliding_work [J]", "worn_volume [m3]"});
    return names;
  }
  std::string filter() const {  ///< see columns()
    return message_of({"load of wall ", settings_.wall, " in the last step, torque about ",
                       to_text(settings_.about), " m; sums of all steps before, wear with k = ",
                       settings_.coefficient, " m3/(N m)"});
  }
  /// See columns() [N, N m, J, m³].
  template <class Sim>
  std::vector<double> row(const Sim&) const {
    std::vector<double> numbers;
    for (int k = 0; k < Dim; ++k) numbers.push_back(force_[k]);
    for (int k = 0; k < angular_size<Dim>; ++k) numbers.push_back(component(torque_, k));
    numbers.insert(numbers.end(), {work_, worn_});
    return numbers;
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("force", force_);
    archive("torque", torque_);
    archive("work", work_);
    archive("worn", worn_);
  }

 private:
  template <class I, class P>
  void add(const I& interaction, const P& grains, double dt) {
    if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
      interaction.for_each_part([&](const auto& part) { add(part, grains, dt); });
    } else if constexpr (requires {
                           interaction.for_each_wall_contact(grains, [](const auto&) {});
                         }) {
      interaction.is_wall_present(settings_.wall);  // throws if there is none
      interaction.for_each_wall_contact(grains, [&](const auto& touch) {
        if (touch.wall == settings_.wall) add_contact(grains, touch, dt);
      });
    }
  }
  template <class P, class Touch>
  void add_contact(const P& grains, const Touch& touch, double dt) {
    const Vec<Dim> point = in_double(touch.point);
    const Vec<Dim> of_contact = in_double(touch.force);
    const AngularVec<Dim> couple = in_double(touch.couple);
    force_ += of_contact;
    torque_ += cross(Vec<Dim>(point - settings_.about), of_contact) + couple;
    const Vec<Dim> arm = point - in_double(grains[position][touch.grain]);
    const double length = std::sqrt(arm.squaredNorm());
    if (!(length > 0)) return;
    const Vec<Dim> n = arm / length;
    const AngularVec<Dim> w = in_double(grains[spin][touch.grain]);
    const Vec<Dim> u =
        in_double(grains[velocity][touch.grain]) + cross(w, arm) - in_double(touch.velocity);
    const Vec<Dim> u_t = u - u.dot(n) * n;
    const double normal = of_contact.dot(n);
    work_ += (of_contact - normal * n).dot(u_t) * dt;
    worn_ += settings_.coefficient * std::abs(normal) * std::sqrt(u_t.squaredNorm()) * dt;
  }

  Settings settings_;
  Vec<Dim> force_ = Vec<Dim>::Zero();
  AngularVec<Dim> torque_ = zero_of<AngularVec<Dim>>();
  double work_ = 0;
  double worn_ = 0;
};

}  // namespace silt::dem
