// SPDX-License-Identifier: MIT
// All walls of a simulation. The elements of all walls are numbered consecutively, in the order of
// the walls; contacts refer to an element by this index.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/tuples.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::dem {

/// Number of elements that all walls of a simulation may have: lists of contacts store the index of
/// an element in a few bits.
inline constexpr Index max_wall_elements = Index(1) << 28;

/// Times at which the poses (`positions`) and velocities (`velocities`) of walls are evaluated [s].
struct WallTimes {
  double positions = 0;
  double velocities = 0;
};

/// From one time to another.
struct TimeSpan {
  double from = 0;  ///< [s]
  double to = 0;    ///< [s]
};

namespace detail {

template <class W, int Dim, class Real>
NearestPoint<Dim, Real> nearest_on(const W& wall, [[maybe_unused]] Index element,
                                   const Vec<Dim, Real>& x) {
  if constexpr (CompositeWall<W, Dim, Real>) {
    return wall.nearest(element, x);
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

/// Number of the wall to which the element with this index belongs; first[w] is the index of the
/// first element of wall w.
template <std::size_t count>
Index wall_of(Index index, const std::array<Index, count>& first) noexcept {
  Index w = 0;
  while (w + 2 < count && index >= first[w + 1]) ++w;
  return w;
}

/// A wall at rest, the same at any time.
template <class W, int Dim, class Real>
class WallAtTime {
 public:
  WallAtTime(const W& wall, const WallTimes&) : wall_(wall) {}
  NearestPoint<Dim, Real> nearest(Index element, const Vec<Dim, Real>& x) const {
    return nearest_on<W, Dim, Real>(wall_, element, x);
  }
  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    detail::for_each_element_near<W, Dim, Real>(wall_, x, distance, f);
  }
  RigidVelocity<Dim, Real> velocity() const { return {}; }

 private:
  const W& wall_;
};

/// A moving wall at one time.
template <class W, class M, int Dim, class Real>
class WallAtTime<Moving<W, M>, Dim, Real> {
 public:
  WallAtTime(const Moving<W, M>& moving, const WallTimes& times)
      : wall_(moving.wall),
        pose_(moving.motion.pose_at(times.positions)),
        velocity_(moving.motion.velocity_at(times.velocities)) {}
  NearestPoint<Dim, Real> nearest(Index element, const Vec<Dim, Real>& x) const {
    auto at = nearest_on<W, Dim, Real>(wall_, element, pose_.X_of(x));
    at.normal = multiply(pose_.rotation, at.normal);
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

/// The walls of a set at one time, by the indices of their elements. Holds references to the set.
template <int Dim, class Real, class... Walls>
class WallsAtTime {
 public:
  /// Number of walls.
  static constexpr Index count = sizeof...(Walls);
  /// At least one wall moves.
  static constexpr bool move = (is_moving<Walls> || ...);

  /// Made by WallSet::at(); `first` has the index of the first element of each wall.
  WallsAtTime(const std::tuple<Walls...>& walls,
              const std::array<Index, sizeof...(Walls) + 1>& first,
              const std::array<bool, sizeof...(Walls) + 1>& present, const WallTimes& times)
      : walls_(std::apply([&](const Walls&... wall) { return Tuple(Then<Walls>(wall, times)...); },
                          walls)),
        first_(first),
        present_(present) {}

  /// The point of an element that is nearest to x [m].
  NearestPoint<Dim, Real> nearest(Index index, const Vec<Dim, Real>& x) const {
    NearestPoint<Dim, Real> nearest{};
    with(index, [&](const auto& wall, Index element) { nearest = wall.nearest(element, x); });
    return nearest;
  }

  /// Velocity of the wall to which an element belongs.
  RigidVelocity<Dim, Real> velocity(Index index) const {
    RigidVelocity<Dim, Real> velocity;
    with(index, [&](const auto& wall, Index) { velocity = wall.velocity(); });
    return velocity;
  }

  /// f(index) for each element of present walls closer to x than `distance` [m], and possibly for
  /// further ones.
  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    Index w = 0;
    const auto visit = [&](const auto& wall) {
      const bool is_present = present_[w];
      const Index first = first_[w++];
      if (!is_present) return;
      wall.for_each_element_near(x, distance, [&](Index element) { f(first + element); });
    };
    silt::detail::for_each_of(walls_, visit);
  }

  /// Number of the wall to which an element belongs.
  Index number_of(Index index) const noexcept { return detail::wall_of(index, first_); }

 private:
  template <class W>
  using Then = detail::WallAtTime<W, Dim, Real>;
  using Tuple = std::tuple<Then<Walls>...>;

  template <class F>
  void with(Index index, F&& f) const {
    Index w = 0;
    silt::detail::for_each_of(walls_, [&](const auto& wall) {
      const Index first = first_[w++];
      if (first <= index && index < first_[w]) f(wall, index - first);
    });
  }

  Tuple walls_;
  const std::array<Index, sizeof...(Walls) + 1>& first_;
  const std::array<bool, sizeof...(Walls) + 1>& present_;
};

/// Walls, numbered in the order given. All are present at first.
template <class... Walls>
class WallSet {
 public:
  /// At least one wall moves.
  static constexpr bool move = (is_moving<Walls> || ...);

  /// Throws if a wall is invalid, or if there are more than max_wall_elements.
  explicit WallSet(Walls... walls) : walls_(std::move(walls)...) {
    set_all_present();
    Index w = 0;
    for_each([&](auto& wall) {
      wall.check();
      auto& body = body_of(wall);
      materials_[w] = body.material;
      Index elements = 1;
      if constexpr (requires { body.element_count(); }) elements = body.element_count();
      first_[w + 1] = first_[w] + elements;
      ++w;
    });
    if (elements() > max_wall_elements) {
      fail({"dem::Contacts: the walls have ", elements(),
            " elements (faces, edges and corners), more than 2^28; use coarser meshes or fewer "
            "walls"});
    }
  }

  static constexpr Index size() { return sizeof...(Walls); }

  /// Throws if there is no wall with this number.
  static void check_number(Index number) {
    if (number < size()) return;
    fail({"dem::Contacts: there is no wall ", number, "; give a number below ", size()});
  }

  /// Their poses and velocities at the given times.
  template <int Dim, class Real>
  auto at(const WallTimes& times) const {
    return WallsAtTime<Dim, Real, Walls...>(walls_, first_, present_, times);
  }

  /// Whether a wall acts on grains. Throws if there is no wall with this number.
  bool is_present(Index number) const {
    check_number(number);
    return present_[number];
  }
  /// Lets a wall act on grains, or not. Throws if there is no wall with this number.
  void set_present(Index number, bool present) {
    check_number(number);
    if (present_[number] != present) ++revision_;
    present_[number] = present;
  }
  /// Lets all walls act on grains.
  void set_all_present() {
    for (Index w = 0; w < size(); ++w) set_present(w, true);
  }
  /// Increases whenever a wall comes or goes.
  std::uint64_t revision() const noexcept { return revision_; }

  /// Writes or reads which walls are present, for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    std::vector<std::uint8_t> present(present_.begin(), present_.begin() + size());
    archive("present", present);
    // A program may read the checkpoint of another number of walls: all of its own are present.
    if (present.size() != size()) present.assign(size(), 1);
    for (Index w = 0; w < size(); ++w) {
      if (present[w] > 1) {
        fail({"dem::Contacts: present = ", present[w], " of wall ", w,
              " is neither 0 nor 1; use an earlier checkpoint"});
      }
      set_present(w, present[w] == 1);
    }
  }

  /// Whether a grain at x [m] with this radius [m] would touch a wall, or be behind one, at a time
  /// [s].
  template <class Vec, class Real = typename Vec::Scalar>
  bool would_touch(const Vec& x, Real radius, double time) const {
    const auto walls = at<Vec::RowsAtCompileTime, Real>({.positions = time, .velocities = time});
    bool touches = false;
    walls.for_each_element_near(x, radius, [&](Index element) {
      touches = touches || walls.nearest(element, x).distance < radius;
    });
    return touches;
  }

  /// Throws if a present wall cannot be used in the box of grains with up to this radius [m]. Calls
  /// the optional check_in(box, max_radius) of walls at rest.
  template <int Dim, class Real>
  void check_in(const Box<Dim, Real>& box, Real max_radius) const {
    const auto check = [&](const auto& wall) {
      if constexpr (requires { wall.check_in(box, max_radius); }) wall.check_in(box, max_radius);
    };
    for_each_present(check);
  }

  /// Number of elements of a wall.
  Index elements_of(Index number) const noexcept { return first_[number + 1] - first_[number]; }
  /// The checksum() of a wall; 0 if it has none.
  std::uint64_t checksum(Index number) const {
    std::uint64_t sum = 0;
    Index w = 0;
    const auto visit = [&](const auto& wall) {
      if constexpr (requires { body_of(wall).checksum(); }) {
        if (w == number) sum = body_of(wall).checksum();
      }
      ++w;
    };
    silt::detail::for_each_of(walls_, visit);
    return sum;
  }
  /// Number of elements of all walls.
  Index elements() const noexcept { return first_[size()]; }
  /// Number of the wall to which an element belongs.
  Index number_of(Index index) const noexcept { return detail::wall_of(index, first_); }
  /// Material of a wall: an index in dem::Materials.
  std::uint32_t material(Index number) const noexcept { return materials_[number]; }

  /// Upper bound of the displacement of any present wall between two times [m], within the box.
  template <int Dim, class Real>
  Real max_displacement(const TimeSpan& span, const Box<Dim, Real>& box) const {
    return max_over_corners<Dim, Real>(box, [&](const auto& motion) {
      const Pose<Dim, Real> then = motion.pose_at(span.from);
      const Pose<Dim, Real> now = motion.pose_at(span.to);
      return [=](const Vec<Dim, Real>& x) { return Vec<Dim, Real>(x - then.x_of(now.X_of(x))); };
    });
  }
  /// The shortest period of present walls that vibrate [s]; infinite without.
  double shortest_period() const {
    double shortest = std::numeric_limits<double>::infinity();
    const auto visit = [&]<class W>(const W& wall) {
      if constexpr (requires { wall.motion.period(); }) {
        shortest = std::min(shortest, double(wall.motion.period()));
      }
    };
    for_each_present(visit);
    return shortest;
  }
  /// Upper bound of the speed of any present wall within the box [m/s].
  template <int Dim, class Real>
  Real max_speed(double time, const Box<Dim, Real>& box) const {
    return max_over_corners<Dim, Real>(box, [&](const auto& motion) {
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
    silt::detail::for_each_of(walls_, f);
  }
  template <class F>
  void for_each_present(F&& f) const {
    Index w = 0;
    const auto visit = [&](const auto& wall) {
      if (present_[w++]) f(wall);
    };
    silt::detail::for_each_of(walls_, visit);
  }

  // Maximum norm, within the box, of the vector fields field_of(motion). The fields are linear in
  // x, so the maximum is at a corner.
  template <int Dim, class Real, class FieldOf>
  Real max_over_corners(const Box<Dim, Real>& box, FieldOf&& field_of) const {
    Real largest = 0;
    const auto visit = [&]<class W>(const W& wall) {
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
    for_each_present(visit);
    return largest;
  }

  std::tuple<Walls...> walls_;
  std::array<Index, sizeof...(Walls) + 1> first_{};
  std::array<std::uint32_t, sizeof...(Walls) + 1> materials_{};
  std::array<bool, sizeof...(Walls) + 1> present_{};
  std::uint64_t revision_ = 0;
};

}  // namespace silt::dem
