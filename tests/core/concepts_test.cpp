// SPDX-License-Identifier: MIT
// Models of each concept: an archetype with exactly the required members, types of the library, and
// types that lack one requirement.
#include <silt/coupled/drag.hpp>
#include <silt/dem.hpp>
#include <silt/geometry/any_rigid_motion.hpp>
#include <silt/geometry/given_motions.hpp>
#include <silt/integrate/semi_implicit.hpp>
#include <silt/io/csv_series.hpp>
#include <silt/measure/flux.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/measure/wall_gauge.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace silt::test::concepts_test {
namespace {

using Grains = dem::Grains<2>;
using Points = Particles<2, double>;
struct Nothing {};

// --- ParticleSet, HasFields, Field
// ----------------------------------------------------------------

struct ParticleArchetype {
  using Real = double;
  using Vec = silt::Vec<2>;
  static constexpr int dimension = 2;
  Index size() const;
  Vec* operator[](position_t);
};
static_assert(ParticleSet<ParticleArchetype>);
static_assert(ParticleSet<Grains> && ParticleSet<Particles<3, float>>);
static_assert(!ParticleSet<Nothing> && !ParticleSet<std::vector<Vec<2>>>);

static_assert(HasFields<Grains, mass_t, radius_t, dem::material_t> &&
              HasFields<Points, position_t>);
static_assert(!HasFields<Points, velocity_t> && !HasFields<Nothing, position_t>);

static_assert(Field<position_t> && !Field<Nothing> && !Field<double>);

// --- NeighbourSearch
// ------------------------------------------------------------------------------

struct SearchArchetype {
  void set_radius(double);
  double radius() const;
  void update(ParticleArchetype&);
  template <class F>
  void for_each_neighbour(Index, F&&) const;
  template <class F>
  void for_each_pair(F&&) const;
};
static_assert(NeighbourSearch<SearchArchetype, ParticleArchetype>);
static_assert(NeighbourSearch<UniformGrid<2>, Grains> &&
              NeighbourSearch<NeighbourList<2>, Grains> && NeighbourSearch<BruteForce<2>, Points>);
static_assert(!NeighbourSearch<Nothing, Grains> && !NeighbourSearch<UniformGrid<2>, Nothing>);
static_assert(!NeighbourSearch<UniformGrid<3>, Grains> &&
              !NeighbourSearch<NeighbourList<3>, Grains> &&
              !NeighbourSearch<BruteForce<2, float>, Grains>);

// --- HasReach, Interaction
// ------------------------------------------------------------------------

struct InteractionArchetype {
  double reach(const ParticleArchetype&) const;
  void accelerate(ParticleArchetype&, SearchArchetype&, double);
};
static_assert(HasReach<InteractionArchetype, ParticleArchetype>);
static_assert(Interaction<InteractionArchetype, ParticleArchetype, SearchArchetype>);
using Contacts = dem::Contacts<dem::CundallStrack, dem::Plane<2>>;
static_assert(Interaction<Contacts, Grains, UniformGrid<2>>);
static_assert(Interaction<Gravity<2>, Grains, BruteForce<2>>);
static_assert(Interaction<Forces<Gravity<2>, Contacts>, Grains, NeighbourList<2>>);
static_assert(!Interaction<Nothing, Grains, UniformGrid<2>> && !HasReach<Nothing, Grains>);
static_assert(!Interaction<Gravity<2>, Points, UniformGrid<2>>);  // no mass, no force
static_assert(!Interaction<Gravity<3>, Grains, UniformGrid<2>>);
static_assert(!Interaction<Gravity<2>, dem::Grains<2, float>, UniformGrid<2, float>>);
static_assert(
    !Interaction<dem::Contacts<dem::CundallStrack, dem::Plane<3>>, Grains, UniformGrid<2>>);
static_assert(!Interaction<dem::Contacts<Nothing>, Grains, UniformGrid<2>>);

// --- PressureInteraction, Integrator
// --------------------------------------------------------------

struct FlowArchetype {
  double reach(const ParticleArchetype&) const;
  void predict(ParticleArchetype&, SearchArchetype&, double);
  void collide(ParticleArchetype&, SearchArchetype&, double);
  SolveReport project(ParticleArchetype&, SearchArchetype&, double);
  void correct(ParticleArchetype&, double);
};
static_assert(PressureInteraction<FlowArchetype, ParticleArchetype, SearchArchetype>);
static_assert(!PressureInteraction<Contacts, Grains, UniformGrid<2>>);
static_assert(!Interaction<FlowArchetype, ParticleArchetype, SearchArchetype>);

struct IntegratorArchetype {
  void step(ParticleArchetype&, SearchArchetype&, InteractionArchetype&, double);
};
static_assert(
    Integrator<IntegratorArchetype, ParticleArchetype, SearchArchetype, InteractionArchetype>);
static_assert(Integrator<Leapfrog<>, Grains, UniformGrid<2>, Contacts>);
static_assert(!Integrator<SemiImplicit<>, Grains, UniformGrid<2>, Contacts>);
static_assert(!Integrator<Leapfrog<>, ParticleArchetype, SearchArchetype, FlowArchetype>);
static_assert(!Integrator<Nothing, Grains, UniformGrid<2>, Contacts>);

// --- optional members of components
// -----------------------------------------------------------------------

struct ChooserArchetype {
  double time_step(const ParticleArchetype&);
};
static_assert(ChoosesTimeStep<ChooserArchetype, ParticleArchetype>);
static_assert(ChoosesTimeStep<Contacts, Grains> && !ChoosesTimeStep<Gravity<2>, Grains>);
struct LimiterArchetype {
  std::string limit_of_time_step(const ParticleArchetype&) const;
};
static_assert(LimitsTimeStep<LimiterArchetype, ParticleArchetype>);
static_assert(LimitsTimeStep<ForParticles<Contacts, Grains>, Grains>);
static_assert(LimitsTimeStep<ForParticles<Forces<Contacts>, Grains>, Grains>);
static_assert(!LimitsTimeStep<Gravity<2>, Grains>);

struct CheckerArchetype {
  void check_step(const ParticleArchetype&, const FinishedStep&) const;
};
static_assert(ChecksSteps<CheckerArchetype, ParticleArchetype>);
static_assert(ChecksSteps<ForParticles<Contacts, Grains>, Grains>);
static_assert(ChecksSteps<ForParticles<Forces<Contacts>, Grains>, Grains>);
static_assert(!ChecksSteps<Gravity<2>, Grains>);

struct TransactionalArchetype {
  void save();
  void restore() noexcept;
};
struct MayThrowOnRestore {
  void save();
  void restore();
};
static_assert(Transactional<TransactionalArchetype> &&
              Transactional<ForParticles<Contacts, Grains>>);
static_assert(!Transactional<MayThrowOnRestore> && !Transactional<Gravity<2>>);

struct DampingArchetype {
  double kicked(double, double, double) const;
};
static_assert(Damping<DampingArchetype> && Damping<NoDamping> && Damping<GlobalDamping, float>);
static_assert(!Damping<Nothing>);

struct DragLawArchetype {
  double coefficient(const coupled::GrainInFluid&) const;
};
static_assert(coupled::DragLaw<DragLawArchetype> && coupled::DragLaw<coupled::Ergun> &&
              coupled::DragLaw<coupled::NoDrag>);
static_assert(!coupled::DragLaw<Nothing>);

struct ObserverArchetype {
  void operator()(const Grains&) const;
};
static_assert(Observer<ObserverArchetype, Grains> && !Observer<Nothing, Grains>);

// --- contact laws and walls
// -----------------------------------------------------------------------

struct LawArchetype {
  Vec<2> force(const dem::Contact<2, double>&) const;
};
struct LawWithHistoryArchetype {
  template <int Dim, class Real>
  struct History {};
  Vec<2> force(const dem::Contact<2, double>&, History<2, double>&) const;
};
static_assert(dem::LawWithoutHistory<LawArchetype, 2, double> &&
              !dem::LawWithHistory<LawArchetype, 2, double>);
static_assert(dem::LawWithHistory<LawWithHistoryArchetype, 2, double> &&
              !dem::LawWithoutHistory<LawWithHistoryArchetype, 2, double>);
static_assert(dem::ContactLaw<dem::CundallStrack, 2, double> &&
              dem::ContactLaw<dem::CundallStrack, 3, float> &&
              dem::ContactLaw<dem::CundallStrackIncremental, 3, double>);
static_assert(!dem::ContactLaw<LawArchetype, 3, double> && !dem::ContactLaw<Nothing, 2, double>);

struct WallArchetype {
  std::uint32_t material;
  dem::NearestPoint<2, double> nearest(const Vec<2>&) const;
  void check();
};
static_assert(dem::Wall<WallArchetype, 2, double>);
static_assert(dem::Wall<dem::Plane<2>, 2, double> && dem::Wall<dem::Plane<3, float>, 3, float> &&
              dem::Wall<dem::Segment<>, 2, double>);
static_assert(!dem::Wall<dem::Plane<2>, 3, double> && !dem::Wall<dem::Segment<>, 2, float> &&
              !dem::Wall<Nothing, 2, double>);

struct MotionArchetype {
  Pose<2> pose_at(double) const;
  RigidVelocity<2> velocity_at(double) const;
};
static_assert(RigidMotion<MotionArchetype, 2, double> && !RigidMotion<MotionArchetype, 3, double>);
static_assert(RigidMotion<Vibration<3, float>, 3, float> &&
              RigidMotion<TabulatedMotion<2>, 2, double> &&
              RigidMotion<AnyRigidMotion<3>, 3, double>);
static_assert(!RigidMotion<Nothing, 2, double> && !RigidMotion<dem::Plane<2>, 2, double>);

struct MeasureArchetype {
  std::vector<std::string> columns() const;
  std::string filter() const;
};
static_assert(WritesRows<MeasureArchetype> && WritesRows<SurfaceHeight<3>> && WritesRows<Flux<2>>);
static_assert(!WritesRows<Nothing> && !WritesRows<WallGauge<2>>);  // of which field?

TEST(Concepts, HoldAtCompileTime) { SUCCEED(); }

}  // namespace
}  // namespace silt::test::concepts_test
