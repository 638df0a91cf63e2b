// SPDX-License-Identifier: MIT
// All walls of a simulation. Their parts are numbered through, in the order of the walls: the place
// of a part is what contacts know it by.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall.hpp>
#include <silt/dem/wall_motion.hpp>

#include <array>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

namespace silt::dem {

/// When walls are looked at [s].
struct WallTimes {
  double positions = 0;
  double velocities = 0;
};

struct TimeSpan {
  double from = 0;  ///< [s]
  double to = 0;    ///< [s]
};

namespace detail {

template <class W, int Dim, class Real>
NearestPoint<Dim, Real> nearest_on(const W& wall, [[maybe_unused]] Index part,
                                   const Vec<Dim, Real>& x) {
  if constexpr (CompositeWall<W, Dim, Real>) {
    return wall.nearest(part, x);
  } else {
    return wall.nearest(x);
  }
}

template <class W, int Dim, class Real, class F>
void for_each_element_near(const W& wall, const Vec<Dim, Real>& x, Real distance, F&& f) {
  if constexpr (CompositeWall<W, Dim, Real>) {
    wall.for_each_element_near(x, distance, f);
  } else {
    if (wall.nearest(x).distance < distance) f(Index(0));
  }
}

/// A wall at rest, as it is at any time.
template <class W, int Dim, class Real>
class WallThen {
 public:
  WallThen(const W& wall, const WallTimes&) : wall_(wall) {}
  NearestPoint<Dim, Real> nearest(Index part, const Vec<Dim, Real>& x) const {
    return nearest_on<W, Dim, Real>(wall_, part, x);
  }
  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    detail::for_each_element_near<W, Dim, Real>(wall_, x, distance, f);
  }
  RigidVelocity<Dim, Real> velocity() const { return {}; }

 private:
  const W& wall_;
};

/// A wall that moves, at one time.
template <class W, class M, int Dim, class Real>
class WallThen<Moving<W, M>, Dim, Real> {
 public:
  WallThen(const Moving<W, M>& moving, const WallTimes& times)
      : wall_(moving.wall),
        pose_(moving.motion.pose_at(times.positions)),
        velocity_(moving.motion.velocity_at(times.velocities)) {}
  NearestPoint<Dim, Real> nearest(Index part, const Vec<Dim, Real>& x) const {
    auto at = nearest_on<W, Dim, Real>(wall_, part, pose_.X_of(x));
    at.normal = Vec<Dim, Real>(pose_.rotation * at.normal);
    return at;
  }
  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    detail::for_each_element_near<W, Dim, Real>(wall_, pose_.X_of(x), distance, f);
  }
  const RigidVelocity<Dim, Real>& velocity() const { return velocity_; }

 private:
  const W& wall_;
  Pose<Dim, Real> pose_;
  RigidVelocity<Dim, Real> velocity_;
};

}  // namespace detail

/// The walls of a set at one time, to be asked by the places of their parts. It refers to the set.
template <int Dim, class Real, class... Walls>
class WallsThen {
 public:
  /// One of them does.
  static constexpr bool move = (is_moving<Walls> || ...);

  WallsThen(const std::tuple<Walls...>& walls, const std::array<Index, sizeof...(Walls) + 1>& first,
            const WallTimes& times)
      : walls_(std::apply([&](const Walls&... wall) { return Tuple(Then<Walls>(wall, times)...); },
                          walls)),
        first_(first) {}

  /// Of the part at this place.
  NearestPoint<Dim, Real> nearest(Index place, const Vec<Dim, Real>& x) const {
    NearestPoint<Dim, Real> nearest{};
    with(place, [&](const auto& wall, Index part) { nearest = wall.nearest(part, x); });
    return nearest;
  }

  /// Of the wall of the part at this place.
  RigidVelocity<Dim, Real> velocity(Index place) const {
    RigidVelocity<Dim, Real> velocity;
    with(place, [&](const auto& wall, Index) { velocity = wall.velocity(); });
    return velocity;
  }

  /// f(place) for each part that is nearer to x than this [m], and maybe for others.
  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    Index w = 0;
    const auto ask = [&](const auto& wall) {
      const Index first = first_[w++];
      wall.for_each_element_near(x, distance, [&](Index part) { f(first + part); });
    };
    std::apply([&](const auto&... wall) { (ask(wall), ...); }, walls_);
  }

 private:
  template <class W>
  using Then = detail::WallThen<W, Dim, Real>;
  using Tuple = std::tuple<Then<Walls>...>;

  template <class F>
  void with(Index place, F&& f) const {
    Index w = 0;
    const auto is_it = [&](const auto& wall) {
      const Index first = first_[w++];
      if (place >= first_[w]) return false;
      f(wall, place - first);
      return true;
    };
    std::apply([&](const auto&... wall) { static_cast<void>((is_it(wall) || ...)); }, walls_);
  }

  Tuple walls_;
  const std::array<Index, sizeof...(Walls) + 1>& first_;
};

/// Walls by their numbers, in the order given.
template <class... Walls>
class WallSet {
 public:
  /// One of them does.
  static constexpr bool move = (is_moving<Walls> || ...);

  /// Throws if a wall is out of range.
  explicit WallSet(Walls... walls) : walls_(std::move(walls)...) {
    Index w = 0;
    for_each([&](auto& wall) {
      wall.check();
      auto& body = body_of(wall);
      materials_[w] = body.material;
      Index parts = 1;
      if constexpr (requires { body.element_count(); }) parts = body.element_count();
      first_[w + 1] = first_[w] + parts;
      ++w;
    });
  }

  static constexpr Index size() { return sizeof...(Walls); }

  /// Where they are and how they move at given times.
  template <int Dim, class Real>
  auto at(const WallTimes& times) const {
    return WallsThen<Dim, Real, Walls...>(walls_, first_, times);
  }

  /// Number of the wall that has the part at this place.
  Index number_of(Index place) const noexcept {
    Index w = 0;
    while (w + 1 < size() && place >= first_[w + 1]) ++w;
    return w;
  }
  /// Of the wall with this number: its place in dem::Materials.
  std::uint32_t material(Index number) const noexcept { return materials_[number]; }

  /// How far a wall goes from one time to another [m], as seen from within the box, at most.
  template <int Dim, class Real>
  Real farthest_move(const TimeSpan& span, const Box<Dim, Real>& box) const {
    return largest_in<Dim, Real>(box, [&](const auto& motion) {
      const Pose<Dim, Real> then = motion.pose_at(span.from);
      const Pose<Dim, Real> now = motion.pose_at(span.to);
      return [=](const Vec<Dim, Real>& x) { return Vec<Dim, Real>(x - then.x_of(now.X_of(x))); };
    });
  }
  /// How fast a wall moves [m/s] within the box, at most.
  template <int Dim, class Real>
  Real fastest(double time, const Box<Dim, Real>& box) const {
    return largest_in<Dim, Real>(box, [&](const auto& motion) {
      return [v = motion.velocity_at(time)](const Vec<Dim, Real>& x) { return v.at(x); };
    });
  }

 private:
  template <class W>
  static auto& body_of(W& wall) {
    if constexpr (is_moving<std::remove_cv_t<W>>) {
      return wall.wall;
    } else {
      return wall;
    }
  }
  template <class F>
  void for_each(F&& f) {
    std::apply([&](auto&... wall) { (f(wall), ...); }, walls_);
  }

  // The longest of the vectors that field_of(motion) gives within the box. What is linear in x is
  // longest in a corner.
  template <int Dim, class Real, class FieldOf>
  Real largest_in(const Box<Dim, Real>& box, FieldOf&& field_of) const {
    Real largest = 0;
    const auto ask = [&]<class W>(const W& wall) {
      if constexpr (is_moving<W>) {
        const auto field = field_of(wall.motion);
        for (unsigned corner = 0; corner < 1u << Dim; ++corner) {
          Vec<Dim, Real> x;
          for (int k = 0; k < Dim; ++k) x[k] = (corner >> k & 1) != 0 ? box.upper[k] : box.lower[k];
          const Real length = field(x).norm();
          if (!(length <= largest)) largest = length;  // a NaN stays
        }
      }
    };
    std::apply([&](const auto&... wall) { (ask(wall), ...); }, walls_);
    return largest;
  }

  std::tuple<Walls...> walls_;
  std::array<Index, sizeof...(Walls) + 1> first_{};
  std::array<std::uint32_t, sizeof...(Walls) + 1> materials_{};
};

}  // namespace silt::dem
