// SPDX-License-Identifier: MIT
// A loop over the elements of a tuple. std::apply would compile six functions for each loop.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

namespace silt::detail {

template <class Tuple, class F, std::size_t... k>
void for_each_of([[maybe_unused]] Tuple& tuple, [[maybe_unused]] F& f,
                 std::index_sequence<k...>) {
  (static_cast<void>(f(std::get<k>(tuple))), ...);
}

/// f(element) for each element, in order.
template <class Tuple, class F>
void for_each_of(Tuple& tuple, F&& f) {
  for_each_of(tuple, f, std::make_index_sequence<std::tuple_size_v<Tuple>>());
}

/// f(Tag{}) for each type of a tuple of empty types, without making the tuple.
template <class F, class... Tags>
void for_each_tag(std::type_identity<std::tuple<Tags...>>, F&& f) {
  (static_cast<void>(f(Tags{})), ...);
}

}  // namespace silt::detail
