// SPDX-License-Identifier: MIT
// Which particles of a process are near the space of others.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mpi/cuts.hpp>
#include <silt/mpi/world.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace silt::mpi {

/// Adds the processes that own space within a depth [m] of x, also across periodic sides of the box.
template <class Box, int Dim>
void add_processes_near(const Vec<Dim>& x, const Box& box, double depth, Cuts<Dim>& cuts,
                        std::vector<int>& processes) {
  std::array<std::array<double, 3>, 3> shifts{};
  std::array<int, 3> count{1, 1, 1};
  for (int k = 0; k < Dim; ++k) {
    if (!box.periodic[Index(k)]) continue;
    const double period = double(box.upper[k]) - double(box.lower[k]);
    auto& of_axis = shifts[Index(k)];
    int& n = count[Index(k)];
    if (x[k] - depth < double(box.lower[k])) of_axis[Index(n++)] = period;
    if (x[k] + depth > double(box.upper[k])) of_axis[Index(n++)] = -period;
  }
  for (int a = 0; a < count[0]; ++a) {
    for (int b = 0; b < count[1]; ++b) {
      for (int c = 0; c < count[2]; ++c) {
        Vec<Dim> at = x;
        const std::array<int, 3> chosen{a, b, c};
        for (int k = 0; k < Dim; ++k) at[k] += shifts[Index(k)][Index(chosen[Index(k)])];
        cuts.add_owners_of(at.array() - depth, at.array() + depth, processes);
      }
    }
  }
}

/// For each process, the owned particles within a depth [m] of its space; none for this one.
template <class P>
std::vector<std::vector<std::uint32_t>> rows_near_processes(const P& particles, double depth,
                                                            Cuts<P::dimension>& cuts,
                                                            const World& world) {
  const auto x = particles[position];
  std::vector<std::vector<std::uint32_t>> rows(Index(world.size()));
  std::vector<int> processes;
  for (Index i = 0; i < x.size(); ++i) {
    processes.clear();
    add_processes_near(Vec<P::dimension>(x[i].template cast<double>()), particles.box(), depth, cuts, processes);
    std::sort(processes.begin(), processes.end());
    processes.erase(std::unique(processes.begin(), processes.end()), processes.end());
    for (const int process : processes) {
      if (process != world.rank()) rows[Index(process)].push_back(std::uint32_t(i));
    }
  }
  return rows;
}

}  // namespace silt::mpi
