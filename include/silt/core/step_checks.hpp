// SPDX-License-Identifier: MIT
// Checks of the time step, and of the particles after a step: are all values finite, and all
// positions within the box?
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace silt::detail {

/// The time of a run that is left [s].
struct TimeLeft {
  double now;
  double until;
};
/// Throws if so many intervals [s] are left that a run would never end; remedy() says what to do.
template <class F>
void require_feasible(std::string_view name, double interval, std::string_view intervals,
                      const TimeLeft& left, F&& remedy) {
  constexpr double most = 1e12;
  const double duration = left.until - left.now;
  if (!(duration > most * interval)) return;
  fail({name, " = ", interval, " s: ", duration / interval, " ", intervals,
        " are ahead, more than ", most, ", until = ", left.until, " s; ", remedy()});
}

/// What to do about a time step that an interaction chose too short; `interaction` and `particles`
/// as in LimitsTimeStep.
template <class I, class P>
[[gnu::cold]] std::string remedy_for_time_step(const I& interaction, const P& particles) {
  std::string limit;
  if constexpr (LimitsTimeStep<I, P>) limit = interaction.limit_of_time_step(particles);
  return (limit.empty() ? "" : limit + "; or ") + "pass a longer one: run({.time_step = …})";
}

/// The time step [s] after one of dt failed because it was not stable. The limit is known only when a
/// step has found its contacts.
inline double shorter_time_step(double dt, const Error& error) {
  return 0.9 * std::min(dt, error.stable_time_step().value());
}

/// Throws if the compiler may reorder sums; see core/types.hpp.
inline void require_ordered_sums() {
  constexpr double big = 0x1.8p52;  // no sum with it has a fractional part
  const volatile double quarter = 0.25;
  if ((quarter + big) - big == 0) return;
  fail(
      "Simulation: compiled with -funsafe-math-optimizations or -fassociative-math; use -O3 "
      "-fno-math-errno instead");
}

/// f(values, name) for the fields of this role whose values can be tested.
template <Role role, class P, class F>
void for_each_testable_field(const P& particles, F&& f) {
  particles.for_each_field([&]<class Tag>(auto values, Tag) {
    using Value = typename decltype(values)::value_type;
    if constexpr (role_of<Tag>() == role && requires(Value v) { is_finite(v); }) {
      f(values, name_of<Tag>());
    }
  });
}

/// A value that is not finite.
struct NotFinite {
  Index particle;
  std::string_view field;
  std::string value;
};
template <class P>
std::optional<NotFinite> find_not_finite(const P& particles) {
  std::optional<NotFinite> found;
  for_each_testable_field<Role::state>(particles, [&](auto values, std::string_view name) {
    if (found) return;
    const Index i = first_where(values.size(), [&](Index k) { return !is_finite(values[k]); });
    if (i != no_index) found = {i, name, to_text(values[i])};
  });
  return found;
}

/// Called after rolling back a step whose result is not finite. Throws if the cause is a value that
/// was not finite before; `where` has the step and its time.
template <class P>
void check_finite_before_step(const P& particles, Where where) {
  const auto broken = find_not_finite(particles);
  if (!broken) return;
  where.particle = broken->particle;
  where.id = particles.id(broken->particle);
  fail({"Simulation: before the step, ", broken->field, " = ", broken->value,
        " is not finite; set it to a finite value"},
       where);
}

/// Reports a derived field that is not finite, if there is one, because it is the cause; the force
/// rather than others, such as the torque, which follow from it.
template <class P>
[[noreturn, gnu::cold]] void fail_after_step(const P& particles, NotFinite broken) {
  const Index i = broken.particle;
  bool is_derived = false;
  for_each_testable_field<Role::derived>(particles, [&](auto values, std::string_view name) {
    if (is_finite(values[i]) || (is_derived && name != name_of<force_t>())) return;
    broken = {i, name, to_text(values[i])};
    is_derived = true;
  });
  fail({"Simulation: after the step, ", broken.field, " = ", broken.value,
        " is not finite; reduce the time step or check the forces"},
       {.particle = i, .id = particles.id(i)});
}

/// Whether a position x [m] is known to a hundredth of this size [m], or is not finite.
template <class Real, int Dim>
bool has_digits(const Vec<Dim, Real>& x, Real size) {
  const Real distance = max_norm(x);
  return 100 * std::numeric_limits<Real>::epsilon() * distance <= size || !is_finite(distance);
}

/// Throws if a particle is so far from the origin that its position is not known to a hundredth of
/// its size, size_of(i) [m]: with float, at 80 000 sizes. `owner` and `size` are named.
template <class P, class F>
void check_digits_of_positions(std::string_view owner, const P& particles, std::string_view size,
                               F&& size_of) {
  using Real = typename P::Real;
  const auto x = particles[position];
  const Index far = first_where(particles.size(), [&](Index i) {
    return !has_digits<Real, P::dimension>(x[i], Real(size_of(i)));
  });
  if (far == no_index) return;
  fail({owner, ": x = ", to_text(typename P::Vec(x[far])), " m is known to ",
        std::numeric_limits<Real>::epsilon() * max_norm(x[far]),
        " m only, more than a hundredth of the ", size, " ", size_of(far),
        " m; move the origin to the particles, or use double"},
       {.particle = far, .id = particles.id(far)});
}

/// Throws if a particle is outside a box that must not be left.
template <class P>
void check_escaped(const P& particles) {
  const auto& box = particles.box();
  if (box.on_escape != OnEscape::refuse) return;
  const auto x = particles[position];
  const Index escaped = first_where(x.size(), [&](Index i) { return !box.contains(x[i]); });
  if (escaped == no_index) return;
  fail({"Simulation: a particle left the box at x = ", to_text(x[escaped]),
        " m; enlarge the box, close the gap, or set Box::on_escape to OnEscape::remove"},
       {.particle = escaped, .id = particles.id(escaped)});
}

}  // namespace silt::detail
