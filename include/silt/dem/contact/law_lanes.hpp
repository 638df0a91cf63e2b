// SPDX-License-Identifier: MIT
// Input and output of a law for eight contacts at once. The loops over `lane` are vectorised,
// including the law's code; see core/lane.hpp.
#pragma once

#include <silt/core/lane.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_row.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_history.hpp>

#include <algorithm>
#include <type_traits>

namespace silt::dem::detail {

/// One array per quantity of the contacts, by lane.
template <int Dim, class RealType, int history_words, bool has_couple>
struct LawLanes {
  using Real = RealType;
  static constexpr int dimension = Dim;
  static constexpr int words = history_words;
  using Row = ContactRow<has_couple>;
  static constexpr int spin_words = angular_size<Dim>;

  // Input.
  alignas(64) Real velocity[Dim][lanes];
  alignas(64) Real relative_spin[has_couple ? spin_words : 1][lanes];
  // Input and output.
  alignas(64) Real history[std::max(history_words, 1)][lanes];
  // By ContactRow: F and the couple are output, all else is input.
  alignas(64) Real row[Row::words][lanes];

  /// Evaluates a law for one lane. Scalar is Real or Lane<Real>.
  template <class Scalar, class Law>
  void evaluate(const Law& law, const ContactTimes<Real>& times, int lane) {
    const auto contact = this->contact<Scalar>(lane, times);
    if constexpr (history_words == 0) {
      if constexpr (requires { law.components(contact); }) {
        keep(lane, contact, law.components(contact));
      } else {
        keep(lane, contact, Vec<Dim, Scalar>(law.force(contact)));
      }
    } else {
      auto own = history_of<Law, Scalar>(lane);
      if constexpr (requires { law.components(contact, own); }) {
        keep(lane, contact, law.components(contact, own));
      } else {
        keep(lane, contact, Vec<Dim, Scalar>(law.force(contact, own)));
      }
      keep_history<Law>(lane, own);
    }
  }

 private:
  template <class Scalar>
  Contact<Dim, Scalar> contact(int lane, const ContactTimes<Real>& times) const {
    Contact<Dim, Scalar> contact;
    for (int k = 0; k < Dim; ++k) {
      contact.normal[k] = row[Row::n + k][lane];
      contact.relative_velocity[k] = velocity[k][lane];
    }
    if constexpr (has_couple) {
      for (int k = 0; k < spin_words; ++k) {
        component(contact.relative_spin, k) = relative_spin[k][lane];
      }
    }
    contact.overlap = row[Row::overlap][lane];
    contact.effective_mass = row[Row::mass][lane];
    contact.effective_radius = row[Row::radius][lane];
    contact.time_step = times.time_step;
    contact.first_time_step = times.first_time_step;
    return contact;
  }

  template <class Law, class Scalar>
  typename LawHistory<Law, Dim, Scalar>::type history_of(int lane) const {
    if constexpr (std::is_same_v<Scalar, Real>) {
      Real numbers[history_words];
      for (int k = 0; k < history_words; ++k) numbers[k] = history[k][lane];
      return LawHistory<Law, Dim, Real>::from(numbers);
    } else {
      typename LawHistory<Law, Dim, Scalar>::type own;
      auto* const numbers = reinterpret_cast<Scalar*>(&own);
      for (int k = 0; k < history_words; ++k) numbers[k] = history[k][lane];
      return own;
    }
  }
  template <class Law, class History>
  void keep_history(int lane, const History& own) {
    if constexpr (std::is_same_v<History, typename LawHistory<Law, Dim, Real>::type>) {
      Real numbers[history_words];
      LawHistory<Law, Dim, Real>::put(own, numbers);
      for (int k = 0; k < history_words; ++k) history[k][lane] = numbers[k];
    } else {
      const auto* const numbers = reinterpret_cast<const Lane<Real>*>(&own);
      for (int k = 0; k < history_words; ++k) history[k][lane] = numbers[k];
    }
  }

  template <class C, class Answer>
  void keep(int lane, const C& contact, const Answer& answer) {
    const auto force = force_of(answer, contact.normal);
    for (int k = 0; k < Dim; ++k) row[Row::F + k][lane] = force[k];
    if constexpr (has_couple) {
      const auto couple = couple_of(answer);
      for (int k = 0; k < spin_words; ++k) row[Row::couple + k][lane] = component(couple, k);
    }
  }
};

}  // namespace silt::dem::detail
