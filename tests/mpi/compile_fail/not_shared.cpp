// expect: EnergyLedger: it knows the grains of one|does not know the unknowns of other processes|cannot be settled yet|Inflow: grains cannot be added|state that does not migrate|write_csv: a file has|write_black_box: the particles around
// SPDX-License-Identifier: MIT
// flags: -DLEDGER
// flags: -DINFLOW
// flags: -DBONDS
// flags: -DCSV
// flags: -DBLACK_BOX
// flags: -DSETTLE
// flags: -DSOLVER
#include <silt/dem.hpp>
#include <silt/io/black_box.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/mpi.hpp>

#include <utility>

using namespace silt;

#ifdef SILT_VALID
template <class P>
P given(P grains, const mpi::World&) {
  return grains;
}
#else
template <class P>
auto given(P grains, const mpi::World& world) {
  return mpi::distribute(std::move(grains), world);
}
#endif

int main() {
  const mpi::World world;
  auto grains = dem::make_grains(lattice<2>({{0, 0}, {1, 1}}, 0.1), {.radius = 0.05, .density = 2500});
  const dem::CundallStrack law{.normal_stiffness = 1e6, .tangential_stiffness = 5e5};
  Simulation bed{given(grains, world), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
#if defined LEDGER || defined SILT_VALID
  dem::EnergyLedger ledger(bed);
#endif
#if defined INFLOW || defined SILT_VALID
  dem::Inflow inflow(Box<2>{{0, 0}, {1, 1}}, dem::Blend{dem::UniformSizes{0.04, 0.05}, 2500},
                     {.number = 10});
  bed.run({.until = 1}, inflow);
#endif
#if defined BONDS || defined SILT_VALID
  dem::Bonds<2> bonds({.normal_stiffness = 1e9, .tangential_stiffness = 1e9});
  Simulation bonded{given(grains, world), UniformGrid<2>{}, Forces{dem::Contacts{law}, bonds},
                    Leapfrog{}};
  bonded.step();
#endif
#if defined CSV || defined SILT_VALID
  write_csv("bed.csv", bed.particles());
#endif
#if defined BLACK_BOX || defined SILT_VALID
  write_black_box({"bed.silt"}, bed, Error("none"));
#endif
#if defined SETTLE || defined SILT_VALID
  dem::settle(bed, {.speed = 1e-3, .check_every = 0.1, .max_time = 1});
#endif
#if defined SOLVER || defined SILT_VALID
  const auto tank = mps::make_tank(
      mps::Tank<2>{.column = {0.4, 0.4}, .size = {.length = 0.8, .height = 0.8}, .spacing = 0.04});
  Simulation dam{given(tank, world), UniformGrid<2>{}, mps::Flow<mps::Case10>{{.spacing = 0.04}},
                 SemiImplicit<>{}};
  dam.step();
#endif
}
