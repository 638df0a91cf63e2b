// SPDX-License-Identifier: MIT
// What every contact law must hold to, ours or a user's, tried on the law itself: in the plane and
// in space, in double and in float, one contact at a time and eight.
//
//   const auto verdict = silt::dem::conformance_of(law);
//   if (!verdict.passes()) std::puts(verdict.text().c_str());
#pragma once

#include <silt/dem/contact.hpp>
#include <silt/dem/conformance_report.hpp>
#include <silt/dem/law_on_trial.hpp>
#include <silt/dem/conformance_checks.hpp>

#include <utility>

namespace silt::dem {

/// Tries a law in the plane and in space, as far as it is written for them. Throws if a number of
/// the trial is out of range, and what the law's check() throws.
template <class Law>
ConformanceReport conformance_of(const Law& law, const ConformanceConditions& trial = {}) {
  if constexpr (requires { law.check(); }) law.check();
  ConformanceReport conformance;
  const auto in_dimension = [&]<int Dim>() {
    if constexpr (ContactLaw<Law, Dim, double>) {
      for (auto& finding : ConformanceChecks<Dim>(on_trial<Dim>(law), trial).findings()) {
        conformance.findings.push_back(std::move(finding));
      }
    }
  };
  in_dimension.template operator()<2>();
  in_dimension.template operator()<3>();
  return conformance;
}

}  // namespace silt::dem
