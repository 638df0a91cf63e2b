// SPDX-License-Identifier: MIT
// Fields: named quantities per particle. A field is a tag type; its base class defines the type of
// its value for one particle. A user-defined field takes one line:
//   inline constexpr struct temperature_t : silt::scalar_field {} temperature{};
#pragma once

#include <silt/core/types.hpp>

#include <concepts>
#include <string_view>

namespace silt {

/// Base of all fields.
struct any_field {};

/// One Real per particle.
struct scalar_field : any_field {
  template <int Dim, class Real>
  using value = Real;
};

/// One Vec<Dim, Real> per particle.
struct vector_field : any_field {
  template <int Dim, class Real>
  using value = Vec<Dim, Real>;
};

/// One AngularVec<Dim, Real> per particle: a number in 2D, a vector in 3D.
struct spin_field : any_field {
  template <int Dim, class Real>
  using value = AngularVec<Dim, Real>;
};

/// One T per particle, for any dimension and precision.
template <class T>
struct field_of : any_field {
  template <int Dim, class Real>
  using value = T;
};

/// A tag type for a quantity of every particle.
template <class F>
concept Field = std::derived_from<F, any_field>;

/// The type of the value of F for one particle.
template <Field F, int Dim, class Real>
using value_of = typename F::template value<Dim, Real>;

namespace detail {
template <Field F>
constexpr std::string_view find_name() {
  std::string_view name = __PRETTY_FUNCTION__;
  name = name.substr(name.find("F = ") + 4);
  name = name.substr(0, name.find_first_of(";]"));
  if (const auto scope = name.rfind("::"); scope != name.npos) name = name.substr(scope + 2);
  if (name.ends_with("_t")) name.remove_suffix(2);
  return name;
}
template <Field F>
inline constexpr std::string_view name = find_name<F>();
}  // namespace detail

/// Name of the field in files and error messages: "temperature" for temperature_t.
template <Field F>
constexpr std::string_view name_of() {
  return detail::name<F>;
}

/// How a step changes a field, so that only `state` fields are saved for rolling back a failed
/// step. A `constant` field is never changed by a step; a `derived` field is recomputed in every
/// step, and its values after a failed step are unspecified.
enum class Role { state, constant, derived };

/// F::role, or Role::state for a field without it.
template <Field F>
constexpr Role role_of() {
  if constexpr (requires { F::role; }) {
    return F::role;
  } else {
    return Role::state;
  }
}

/// Second base of a field that no step changes: its `role`.
struct constant_field {
  static constexpr Role role = Role::constant;
};
/// Second base of a field that every step computes anew: its `role`.
struct derived_field {
  static constexpr Role role = Role::derived;
};

inline constexpr struct position_t : vector_field {
} position{};  ///< centre x [m]
inline constexpr struct velocity_t : vector_field {
} velocity{};  ///< u or v [m/s]
inline constexpr struct spin_t : spin_field {
} spin{};  ///< angular velocity [rad/s]
inline constexpr struct angle_t : spin_field {
} angle{};  ///< rotation: integral of the spin over time [rad]
inline constexpr struct force_t : vector_field, derived_field {
} force{};  ///< sum of the forces of this step [N]
inline constexpr struct torque_t : spin_field, derived_field {
} torque{};  ///< sum of the torques of this step [N m]
inline constexpr struct mass_t : scalar_field, constant_field {
} mass{};  ///< m [kg]
inline constexpr struct radius_t : scalar_field, constant_field {
} radius{};  ///< R [m]
inline constexpr struct inertia_t : scalar_field, constant_field {
} inertia{};  ///< I [kg m²]

}  // namespace silt
