// expect: (static assertion failed|static_assert failed).*or its motion is not a
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

using namespace silt;

struct PoseAlone {
  dem::Pose<2, double> pose_at(double t) const { return {.shift = {0, t}}; }
#ifdef SILT_VALID
  dem::RigidVelocity<2, double> velocity_at(double) const { return {.linear = {0, 1}}; }
#endif
};

int main() {
  dem::Grains<2> grains;
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
  Simulation sim{grains, UniformGrid<2>{},
                 dem::Contacts{law, dem::Moving{dem::Plane<2>{}, PoseAlone{}}}, Leapfrog{}};
}
