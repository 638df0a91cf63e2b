// SPDX-License-Identifier: MIT
// An elastic material and the two contact moduli used by Hertz and Mindlin.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>

#include <string>

namespace silt::dem {

/// An isotropic elastic material.
struct Elastic {
  double young_modulus = 0;  ///< E [Pa], above 0; for a rigid wall e.g. 1e30
  double poisson_ratio = 0;  ///< ν [-] in (−1, ½]

  /// Throws if a value is out of range; the message begins with `whose`.
  void check(const std::string& whose) const {
    check_magnitude(whose + ": young_modulus", young_modulus);
    require_between(whose + ": poisson_ratio", poisson_ratio, {-1 + 1e-6, 0.5});
  }

  /// E* of two grains of this material, 1/E* = 2 (1 − ν²)/E [Pa].
  double contact_modulus() const { return young_modulus / (2 * (1 - squared(poisson_ratio))); }

  /// G* of two grains of this material, 1/G* = 2 (2 − ν)/G with G = E/(2 (1 + ν)) [Pa].
  double contact_shear_modulus() const {
    return young_modulus / (4 * (1 + poisson_ratio) * (2 - poisson_ratio));
  }

  /// The material for which a contact of two equal grains has the moduli of a contact between a and
  /// b: 1/E* = (1 − ν_a²)/E_a + (1 − ν_b²)/E_b and 1/G* = (2 − ν_a)/G_a + (2 − ν_b)/G_b. It exists
  /// and is unique, since E*/G* = 2 (2 − ν)/(1 − ν) lies between the ratios of a and b.
  static Elastic mix(const Elastic& a, const Elastic& b) {
    const double E = in_series(a.contact_modulus(), b.contact_modulus());
    const double G = in_series(a.contact_shear_modulus(), b.contact_shear_modulus());
    const double nu = (E / G - 4) / (E / G - 2);
    return {.young_modulus = 2 * (1 - squared(nu)) * E, .poisson_ratio = nu};
  }
};

}  // namespace silt::dem
