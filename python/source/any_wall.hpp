// SPDX-License-Identifier: MIT
// One type for the walls at rest of a simulation of grains, whose number and shapes Python chooses.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/plane.hpp>
#include <silt/dem/wall/polyline.hpp>
#include <silt/dem/wall/round_walls.hpp>
#include <silt/dem/wall/wall.hpp>
#include <silt/dem/wall/wall_set.hpp>

#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

namespace silt::python {

/// In the place of a wall that is not given: it has no element.
template <int Dim>
struct NoWall {
  void check() const {}
  Index element_count() const { return 0; }
  dem::NearestPoint<Dim, double> nearest(Index, const Vec<Dim>&) const {
    return dem::no_nearest_point<Dim, double>();
  }
  template <class F>
  void for_each_element_near(const Vec<Dim>&, double, F&&) const {}
};

template <int Dim>
struct WallShapes {
  using Type = std::variant<NoWall<2>, dem::Plane<2>, dem::BoxWall<2>, dem::Circle<>,
                            dem::Segment<>, dem::Polyline<>>;
};
template <>
struct WallShapes<3> {
  using Type =
      std::variant<NoWall<3>, dem::Plane<3>, dem::BoxWall<3>, dem::Cylinder<>, dem::MeshWall<>>;
};

/// A composite wall of any shape.
template <int Dim>
struct AnyWall {
  typename WallShapes<Dim>::Type shape;
  std::uint32_t material = 0;  ///< index in dem::Materials

  void check() {
    std::visit([](auto& wall) { wall.check(); }, shape);
  }
  void check_in(const Box<Dim>& box, double max_radius) const {
    visit([&](const auto& wall) {
      if constexpr (requires { wall.check_in(box, max_radius); }) wall.check_in(box, max_radius);
    });
  }
  /// Distinguishes walls of different shapes, too.
  std::uint64_t checksum() const {
    PointChecksum all;
    all.add(shape.index());
    visit([&](const auto& wall) {
      if constexpr (requires { wall.checksum(); }) all.add(wall.checksum());
    });
    return all.sum();
  }

  Index element_count() const {
    return visit([](const auto& wall) -> Index {
      if constexpr (requires { wall.element_count(); }) return wall.element_count();
      return 1;
    });
  }
  dem::NearestPoint<Dim, double> nearest(Index element, const Vec<Dim>& x) const {
    return visit([&]<class W>(const W& wall) {
      return dem::detail::nearest_on<W, Dim, double>(wall, element, x);
    });
  }
  template <class F>
  void for_each_element_near(const Vec<Dim>& x, double distance, F&& f) const {
    visit([&]<class W>(const W& wall) {
      dem::detail::for_each_element_near<W, Dim, double>(wall, x, distance, f);
    });
  }

 private:
  template <class F>
  decltype(auto) visit(F&& f) const {
    return std::visit(std::forward<F>(f), shape);
  }
};

}  // namespace silt::python
