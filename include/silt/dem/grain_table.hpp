// SPDX-License-Identifier: MIT
// Grains from a table, such as read_csv gives: x, y[, z], radius, density or mass, and whatever else
// grains carry (velocity_x, …, spin, material).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/field_numbers.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>

#include <algorithm>
#include <concepts>
#include <string>
#include <vector>

namespace silt::dem {

/// Columns of numbers by names. refuse(row, column, why) throws an error that says where in which
/// file the number stands.
template <class T>
concept NamedColumns = requires(const T table, Index row, const std::string name) {
  { table.rows() } -> std::convertible_to<Index>;
  { table.names() } -> std::convertible_to<std::vector<std::string>>;
  { table[name][row] } -> std::convertible_to<double>;
  table.refuse(row, name, name);
};

namespace detail {
/// Names of all numbers of the fields that a table may set.
template <class P>
std::vector<std::string> settable_names(const P& grains) {
  std::vector<std::string> names;
  grains.for_each_field([&]<class F>(auto, F) {
    if constexpr (role_of<F>() != Role::derived && has_numbers<F, P::dimension, typename P::Real>) {
      for (const auto& name : number_names<F, P::dimension, typename P::Real>()) {
        names.push_back(name);
      }
    }
  });
  return names;
}

template <class T>
bool has_column(const T& table, const std::string& name) {
  const auto& names = table.names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <class T>
void check_columns(const T& table, const std::vector<std::string>& known) {
  for (const std::string& name : table.names()) {
    if (name == "density" || std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string all;
    for (const std::string& each : known) all += each + ", ";
    fail("dem::grains_from: the column " + name + " is none of " + all +
         "density; correct its name, or leave it out");
  }
  if (has_column(table, "density") && has_column(table, "mass")) {
    fail("dem::grains_from: the table has both density and mass; leave one of them out");
  }
}
}  // namespace detail

/// The grains of a table's rows, in their order. What it has no column for is that of `otherwise`,
/// or 0; a mass given without inertia makes the inertia that belongs to it. Throws silt::Error,
/// naming the place in the file, if a number is out of range, and for a column that nobody knows.
template <int Dim, class Real = double, Field... Further, NamedColumns T>
Grains<Dim, Real, Further...> grains_from(const T& table, const Grain& otherwise = {}) {
  Grains<Dim, Real, Further...> grains;
  detail::check_columns(table, detail::settable_names(grains));
  const auto value = [&](Index row, const std::string& name, double without) {
    if (!detail::has_column(table, name)) return without;
    const double number = table[name][row];
    if (!(number > 0)) table.refuse(row, name, "must be above 0");
    return number;
  };
  const bool by_mass = detail::has_column(table, "mass");
  grains.reserve(table.rows());
  for (Index row = 0; row < table.rows(); ++row) {
    Vec<Dim, Real> x;
    static constexpr const char* axes[] = {"x", "y", "z"};
    for (int k = 0; k < Dim; ++k) x[k] = Real(table[axes[k]][row]);
    Grain grain = otherwise;
    grain.radius = value(row, "radius", otherwise.radius);
    grain.density = by_mass ? 1 : value(row, "density", otherwise.density);
    const Index i = add_grain(grains, x, grain);
    if (!by_mass) continue;
    const Real m = Real(value(row, "mass", 0));
    grains[inertia][i] *= m / grains[mass][i];
    grains[mass][i] = m;
  }
  grains.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() != Role::derived && has_numbers<F, Dim, Real>) {
      const auto names = number_names<F, Dim, Real>();
      for (Index k = 0; k < names.size(); ++k) {
        if (!detail::has_column(table, names[k])) continue;
        const auto& column = table[names[k]];
        auto values = grains[field];
        for (Index row = 0; row < values.size(); ++row) {
          using Value = typename decltype(values)::value_type;
          if (!holds_number<Value>(column[row])) {
            table.refuse(row, names[k], "must be a whole number that fits");
          }
          set_number(values[row], k, column[row]);
        }
      }
    }
  });
  return grains;
}

}  // namespace silt::dem
