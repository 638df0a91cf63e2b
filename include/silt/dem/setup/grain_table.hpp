// SPDX-License-Identifier: MIT
// Grains from a table, e.g. from read_csv: x, y[, z], radius, density or mass, and any other field
// of grains (velocity_x, …, spin, material).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/field_numbers.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <concepts>
#include <string>
#include <vector>

namespace silt::dem {

/// A table of named columns of numbers. reject(row, column, reason) throws an error that names the
/// file and the location of the number.
template <class T>
concept NamedColumns = requires(const T table, Index row, const std::string name) {
  { table.rows() } -> std::convertible_to<Index>;
  { table.names() } -> std::convertible_to<std::vector<std::string>>;
  { table[name][row] } -> std::convertible_to<double>;
  table.reject(row, name, name);
};

namespace detail {
template <class T>
bool has_column(const T& table, const std::string& name) {
  const auto& names = table.names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <class T, class P>
void check_columns(const T& table, const P& grains) {
  std::vector<std::string> known;
  std::string all;
  silt::detail::for_each_number(grains, [&](const std::string& name, Index, auto) {
    known.push_back(name);
    all += name + ", ";
  });
  for (const std::string& name : table.names()) {
    if (name == "density" || std::find(known.begin(), known.end(), name) != known.end()) continue;
    fail({"dem::grains_from: unknown column ", name, "; known are ", all,
          "density; correct its name, or remove it"});
  }
  if (has_column(table, "density") && has_column(table, "mass")) {
    fail("dem::grains_from: the table has both density and mass; remove one of them");
  }
}
}  // namespace detail

/// One grain per row of the table, in the same order. Values without a column are taken from
/// `defaults`, or are 0; if there is a mass but no inertia, the inertia follows from the mass.
/// Throws silt::Error, naming the location in the file, if a number is out of range, and if a
/// column is unknown.
template <int Dim, class Real = double, Field... Further, NamedColumns T>
Grains<Dim, Real, Further...> grains_from(const T& table, const Grain& defaults = {}) {
  Grains<Dim, Real, Further...> grains;
  detail::check_columns(table, grains);
  const auto value = [&](Index row, const std::string& name, double fallback) {
    if (!detail::has_column(table, name)) return fallback;
    const double number = table[name][row];
    if (!is_finite(number) || !(number > 0)) {
      table.reject(row, name, "must be above 0 and finite");
    }
    return number;
  };
  const bool by_mass = detail::has_column(table, "mass");
  grains.reserve(table.rows());
  for (Index row = 0; row < table.rows(); ++row) {
    Vec<Dim, Real> x;
    static constexpr const char* axes[] = {"x", "y", "z"};
    for (int k = 0; k < Dim; ++k) {
      const double coordinate = table[axes[k]][row];
      if (!is_finite(coordinate)) table.reject(row, axes[k], "must be finite");
      x[k] = Real(coordinate);
    }
    Grain grain = defaults;
    grain.radius = value(row, "radius", defaults.radius);
    grain.density = by_mass ? 1 : value(row, "density", defaults.density);
    const Index i = add_grain(grains, x, grain);
    if (!by_mass) continue;
    const Real m = Real(value(row, "mass", 0));
    const Real I = grains[inertia][i] * (m / grains[mass][i]);
    const bool has_inertia = detail::has_column(table, "inertia");
    if (!is_positive_normal(m) || !(has_inertia || is_positive_normal(I))) {
      table.reject(row, "mass", "is too small or too large in the precision of the grains");
    }
    grains[inertia][i] = I;
    grains[mass][i] = m;
  }
  silt::detail::for_each_number(grains, [&]<class F>(const std::string& name, Index k, F field) {
    if (!detail::has_column(table, name)) return;
    const auto& column = table[name];
    const auto values = grains[field];
    using Value = typename decltype(values)::value_type;
    constexpr bool is_positive =
        std::same_as<F, mass_t> || std::same_as<F, inertia_t> || std::same_as<F, radius_t>;
    for (Index row = 0; row < values.size(); ++row) {
      if (!is_finite(column[row])) table.reject(row, name, "must be finite");
      if (!silt::detail::holds_number<Value>(column[row])) {
        table.reject(row, name, "must be an integer in the range of the field");
      }
      silt::detail::set_number(values[row], k, column[row]);
      // Steps throw unless the state is finite.
      if constexpr (is_positive ||
                    (role_of<F>() == Role::state && requires { is_finite(values[row]); })) {
        const auto& stored = values[row];
        bool is_possible = is_finite(stored);
        if constexpr (is_positive) is_possible = is_possible && stored > 0;
        if (!is_possible) {
          table.reject(row, name, is_positive ? "must be above 0 and finite" : "must be finite");
        }
      }
    }
  });
  return grains;
}

}  // namespace silt::dem
