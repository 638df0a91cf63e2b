// SPDX-License-Identifier: MIT
// The first and last steps of a contact that begins and ends with a force, at different overlaps.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/dashpot.hpp>

#include <cmath>
#include <limits>

namespace silt::dem {

/// The parts of the forces at the beginning and at the end of a contact that do not act in this
/// step, for second order in the time step; see share_of_step().
template <class C>
struct SharesOfStep {
  typename C::Real of_beginning;  ///< 0 but in the first two steps [-]
  typename C::Real of_end;        ///< 0 but in the last two [-]
  C contact;                      ///< with the overlap by which CentredDashpot weights its force
};

/// How many steps a contact has had, up to two; a history.
template <class Real>
struct StepsOfContact {
  Real number = 0;  ///< [-]

  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number);
  }

  /// For the next step of a contact that begins at δ = 0 and ends at this gap [m]. One that exists
  /// at time 0 has begun before.
  template <class C>
  SharesOfStep<C> next(const C& contact, const Real& gap) {
    using std::abs;
    const Real moved = Real(abs(contact.approach_speed())) * contact.kick();
    const Real change = larger(moved, Real(std::numeric_limits<float>::min()));
    const Real overlap = larger(Real(0), Real(contact.overlap));
    const Real left = larger(Real(0), Real(contact.overlap + gap));
    const Real before = choose(contact.first_time_step > 0, Real(2), number);
    const bool begins = before < 2;
    SharesOfStep<C> shares{.of_beginning = Real(0), .of_end = Real(0), .contact = contact};
    shares.of_beginning = choose(begins, Real(1 - share_of_step(overlap, change)), Real(0));
    shares.of_end = choose(begins, Real(0), Real(1 - share_of_step(left, change)));
    shares.contact.overlap = choose(begins, overlap, left);
    number = smaller(Real(2), Real(before + 1));
    return shares;
  }
};

}  // namespace silt::dem
