// SPDX-License-Identifier: MIT
// Checks of properties that every contact law must have, for laws of Silt and of users: in 2D and
// 3D, in double and float, evaluated one contact at a time and eight at once.
//
//   const auto report = silt::dem::conformance_of(law);
//   if (!report.passes()) std::puts(report.text().c_str());
#pragma once

#include <silt/dem/conformance/checks.hpp>
#include <silt/dem/conformance/law_adapter.hpp>
#include <silt/dem/law/contact.hpp>

#include <utility>

namespace silt::dem {

/// Checks a law in 2D and 3D, if it supports them. Throws if a condition is out of range or the
/// law's own check() throws.
template <class Law>
ConformanceReport conformance_of(const Law& law, const ConformanceConditions& conditions = {}) {
  if constexpr (requires { law.check(); }) law.check();
  ConformanceReport report;
  const auto in_dimension = [&]<int Dim>() {
    if constexpr (ContactLaw<Law, Dim, double>) {
      const detail::LawAdapter<Dim> adapter(law);
      for (auto& check : detail::ConformanceChecks<Dim>(adapter, conditions).run()) {
        report.checks.push_back(std::move(check));
      }
    }
  };
  in_dimension.template operator()<2>();
  in_dimension.template operator()<3>();
  return report;
}

}  // namespace silt::dem
