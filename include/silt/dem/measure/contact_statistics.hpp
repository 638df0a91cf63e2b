// SPDX-License-Identifier: MIT
// Distributions of contacts: how strong their forces are, and which directions they have.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace silt::dem {

/// What contact_statistics() returns, of contacts between grains; those with walls do not count.
template <int Dim>
struct ContactStatistics {
  Index number = 0;              ///< of contacts
  double mean_normal_force = 0;  ///< ⟨F_n⟩ [N]
  /// Fabric tensor ⟨n nᵀ⟩ of [Satake1982] [-]; 1/Dim times the unit tensor if no direction is
  /// preferred.
  Eigen::Matrix<double, Dim, Dim> fabric = Eigen::Matrix<double, Dim, Dim>::Zero();
  /// The same weighted with F_n: ⟨F_n n nᵀ⟩/⟨F_n⟩ [-].
  Eigen::Matrix<double, Dim, Dim> force_fabric = Eigen::Matrix<double, Dim, Dim>::Zero();
  double mobilised_friction = 0;  ///< ⟨|F_t|⟩/⟨F_n⟩ [-]
  double bin_width = 0;           ///< of the density, in F_n/⟨F_n⟩ [-]
  /// Probability density of F_n/⟨F_n⟩ in bins from 0 on [-]; the last one has all beyond it.
  std::vector<double> density{};
};

/// Bins of the distribution of forces.
struct ForceBins {
  double width = 0.25;  ///< in units of the mean normal force [-], above 0
  Index number = 24;    ///< 1 to 1e6
};

/// Of the last step. Throws if the bins are out of range. Of grains of one process.
template <class P, class C>
ContactStatistics<P::dimension> contact_statistics(const P& grains, const C& contacts,
                                                   const ForceBins& bins = {}) {
  static_assert(silt::detail::are_of_one_process<P>,
                "silt::dem::contact_statistics: it knows the contacts of one process only");
  constexpr int Dim = P::dimension;
  require_positive("dem::ForceBins: width", bins.width);
  if (bins.number < 1 || bins.number > 1000000) {
    fail({"dem::ForceBins: number = ", bins.number, " is not in 1 to 1e6"});
  }
  ContactStatistics<Dim> result{.bin_width = bins.width, .density = {}};
  std::vector<double> normal_forces;
  double tangential = 0;
  contacts.for_each_contact(grains,
                            [&](Index, Index j, const auto& contact, const auto& force_on_i) {
                              if (j == no_index) return;
                              const Vec<Dim> n = in_double(contact.normal);
                              const Vec<Dim> f = in_double(force_on_i);
                              const double f_n = f.dot(n);
                              normal_forces.push_back(f_n);
                              tangential += (f - f_n * n).norm();
                              result.fabric += n * n.transpose();
                              result.force_fabric += f_n * (n * n.transpose());
                            });
  result.number = normal_forces.size();
  if (result.number == 0) return result;
  double sum = 0;
  for (const double f_n : normal_forces) sum += f_n;
  const double number = double(result.number);
  result.mean_normal_force = sum / number;
  result.fabric /= number;
  result.density.assign(bins.number, 0.0);
  if (!(sum > 0)) return result;
  result.force_fabric /= sum;
  result.mobilised_friction = tangential / sum;
  for (const double f_n : normal_forces) {
    const double place = std::max(0.0, f_n / result.mean_normal_force / bins.width);
    const Index bin = place < double(bins.number) ? Index(place) : bins.number - 1;
    result.density[bin] += 1 / (number * bins.width);
  }
  return result;
}

}  // namespace silt::dem
