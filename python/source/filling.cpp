// SPDX-License-Identifier: MIT
// Water at rest between the walls of flows.
#include <silt/core/types.hpp>
#include <silt/mps/filling/fill.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include "empty_tank.hpp"
#include "flow_setup.hpp"

#include <utility>

namespace silt::python {

template <int Dim>
FilledPool fill_pool(const PoolSetup<Dim>& setup) {
  auto tank = empty_tank_of("fill", setup.flow);
  const mps::Filling filling =
      mps::fill(tank.particles, tank.walls,
                {.inside = setup.inside, .level = setup.level, .spacing = setup.flow.spacing});
  FilledPool pool{.positions = {{}, Dim}, .volume = filling.volume, .deviation = filling.deviation};
  for (const Vec<Dim>& x : std::as_const(tank.particles)[position]) {
    pool.positions.numbers.insert(pool.positions.numbers.end(), x.begin(), x.end());
  }
  return pool;
}

template FilledPool fill_pool(const PoolSetup<2>&);
template FilledPool fill_pool(const PoolSetup<3>&);

}  // namespace silt::python
