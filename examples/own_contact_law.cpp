// SPDX-License-Identifier: MIT
// A user-defined contact law: Hertz's normal force with the dissipation of Hunt and Crossley
// (1975), and viscous friction with a Coulomb limit. It is a plain struct, which needs no
// registration and works for discs and spheres, in double and in float.
//
// A ball is thrown along a floor and bounces. It leaves the floor rolling, with 5/7 of its speed.
// Run it in any folder, then open bounce_2d.pvd and bounce_3d.pvd in ParaView.
#include <silt/dem.hpp>
#include <silt/io/vtk.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

struct Hertz {
  double modulus = 0;   ///< E* of the pair [Pa]
  double loss = 0;      ///< Hunt and Crossley: about 3/2 (1 − e)/v at impact speed v [s/m]
  double drag = 0;      ///< viscous friction coefficient, below sliding [N s/m]
  double friction = 0;  ///< Coulomb friction coefficient µ [-]

  template <class Contact>
  typename Contact::Vec force(const Contact& c) const {
    using Real = typename Contact::Real;
    using Vec = typename Contact::Vec;
    const Real contact_radius = std::sqrt(c.effective_radius * c.overlap);
    const Real spring = Real(4 * modulus / 3) * contact_radius * c.overlap;
    const Real F_n = std::max(Real(0), spring * (1 + Real(loss) * c.approach_speed()));
    const Vec drag_force = -Real(drag) * c.tangential_velocity();
    const Real limit = std::min(Real(1), Real(friction) * F_n / (drag_force.norm() + Real(1e-30)));
    return F_n * c.normal + limit * drag_force;
  }
};

template <int Dim, class Real>
void bounce() {
  using namespace silt;
  using Vec = silt::Vec<Dim, Real>;
  const Vec up = Vec::Unit(Dim - 1);
  constexpr Real R = Real(0.01);     // [m]
  constexpr Real drop = Real(0.2);   // [m]
  const Hertz law{.modulus = 1e7, .loss = 0.2, .drag = 5, .friction = 0.5};

  dem::Grains<Dim, Real> ball;
  dem::add_grain(ball, Vec((R + drop) * up),
                 {.radius = R, .density = 2500, .shape = dem::Shape::sphere});
  ball[velocity][0] = Vec::Unit(0);

  Simulation simulation{ball, UniformGrid<Dim, Real>{},
                        Forces{Gravity<Dim, Real>{Vec(Real(-9.81) * up)},
                               dem::Contacts{law, dem::Plane<Dim, Real>{}}},
                        Leapfrog{}};
  // This law has no stiffness(), so no time step can be computed; it is set here.
  simulation.run({.until = 0.25, .output_every = 0.005, .time_step = 1e-5},
                 VtkSeries{Dim == 2 ? "bounce_2d" : "bounce_3d"});
  const auto after = simulation.snapshot();
  const Real v = after[velocity][0].dot(up);
  const Real height = after[position][0].dot(up) - R + v * v / Real(2 * 9.81);
  std::printf("%dD: thrown at 1 m/s from %.2f m, bounces to %.3f m, continues at %.3f m/s\n", Dim,
              double(drop), double(height), double(after[velocity][0][0]));
}

int main() {
  bounce<2, double>();
  bounce<3, float>();
}
