// SPDX-License-Identifier: MIT
// The weights by which grains and the fluid particles around them exchange volume and momentum.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/kernel.hpp>
#include <silt/search/extent.hpp>
#include <silt/search/points.hpp>
#include <silt/search/sorted_cells.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace silt::coupled {

/// W_ki = w(r_ki)/Σ_j w(r_kj) of grain k and fluid particle i closer than a reach: Σ_i W_ki = 1, so
/// that what a grain gives to the fluid arrives there to round-off, beside walls and at the
/// surface, too.
template <int Dim, class RealType>
class Weights {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Finds them. The reach is in [m]; the box is that of the fluid, of which sides may be periodic.
  template <class Fluid, class Grains>
  void find(const Fluid& fluid, const Grains& grains, const Box<Dim, Real>& box, Real reach) {
    find_points(fluid, box, reach);
    fluid_ = fluid.size();
    reach_ = reach;
    centres_.assign(grains.begin(), grains.end());
    rows_.assign(grains.size(), {});
    sums_.assign(grains.size(), 0);
    sets_.resize(row_sets(grains.size()));
    for (Set& set : sets_) {
      set.point.clear();
      set.weight.clear();
    }
    if (points_.empty()) return transpose();
    const Points<Dim, Real> x(points_);
    cells_.sort_and_copy(x, extent_of(x), reach);
    for_each_range<rows_together>(grains.size(), [&](Index first, Index last) {
      const Index number = first / rows_together;
      for (Index k = first; k < last; ++k) add_row(sets_[number], number, k, Vec(grains[k]), reach);
    });
    transpose();
  }

  /// The reach for a flow with this radius [spacings].
  static double reach_for(double radius) { return 2.0 / 3 * radius; }

  /// Number of grains.
  Index grains() const noexcept { return rows_.size(); }
  /// f(i, W) for the fluid particles around grain k.
  template <class F>
  void for_each_particle(Index k, F&& f) const {
    const Row row = rows_[k];
    const Set& set = sets_[row.set];
    for (Index n = row.first; n < row.end; ++n) f(Index(owners_[set.point[n]]), set.weight[n]);
  }
  /// f(i, W, x_i − x_k [m]) for the same, as they were when they were found.
  template <class F>
  void for_each_offset(Index k, F&& f) const {
    const Row row = rows_[k];
    const Set& set = sets_[row.set];
    for (Index n = row.first; n < row.end; ++n) {
      const Index point = set.point[n];
      f(Index(owners_[point]), set.weight[n], Vec(points_[point] - centres_[k]));
    }
  }
  /// f(i, dW_ki/dt [1/s]) for the same, where grain k moves with v_k [m/s], and particle i with
  /// u_i: Σ_i dW_ki/dt = 0.
  template <class Velocities, class F>
  void for_each_rate(Index k, const Vec& v_k, const Velocities& u, F&& f) const {
    const Row row = rows_[k];
    const Set& set = sets_[row.set];
    static thread_local Buffer<Real> rates;  // of w(r_ki)/Σ w alone; keeps its capacity
    rates.clear();
    Real sum = 0;
    for (Index n = row.first; n < row.end; ++n) {
      const Vec r = points_[set.point[n]] - centres_[k];
      const Real distance = r.norm();
      Real rate = 0;
      if (distance > 0) {
        const Real slope = mps::WendlandKernel::slope(distance / reach_) / reach_;
        rate = slope / distance * r.dot(u[owners_[set.point[n]]] - v_k) / sums_[k];
      }
      rates.push_back(rate);
      sum += rate;
    }
    for (Index n = row.first; n < row.end; ++n) {
      f(Index(owners_[set.point[n]]), rates[n - row.first] - set.weight[n] * sum);
    }
  }
  /// f(k, W) for the grains around fluid particle i.
  template <class F>
  void for_each_grain(Index i, F&& f) const {
    for (Index n = first_[i]; n < first_[i + 1]; ++n) f(Index(grain_[n]), weight_[n]);
  }
  /// Where grain k was when they were found [m].
  const Vec& centre(Index k) const { return centres_[k]; }
  /// Σ_j w(r_kj) around grain k [-].
  Real sum(Index k) const { return sums_[k]; }

  /// ∫ w over all of space, over reach^Dim [-].
  static double integral() { return (Dim == 2 ? 2 : 4) * std::numbers::pi * radial_moment(Dim - 1); }
  /// Standard deviation of w along an axis, over the reach [-].
  static double width() { return std::sqrt(radial_moment(Dim + 1) / radial_moment(Dim - 1) / Dim); }

 private:
  struct Row {
    std::uint32_t set = 0, first = 0, end = 0;
  };
  struct Set {
    Buffer<std::uint32_t> point;
    Buffer<Real> weight;
  };

  // ∫ w q^power dq
  static double radial_moment(int power) {
    constexpr int parts = 1000;
    double sum = 0;
    for (int n = 0; n < parts; ++n) {
      const double q = (n + 0.5) / parts;
      sum += mps::WendlandKernel::weight(q) * std::pow(q, power) / parts;
    }
    return sum;
  }
  // With copies beyond periodic sides.
  template <class Fluid>
  void find_points(const Fluid& fluid, const Box<Dim, Real>& box, Real reach) {
    points_.assign(fluid.begin(), fluid.end());
    owners_.resize(points_.size());
    for (Index i = 0; i < points_.size(); ++i) owners_[i] = std::uint32_t(i);
    for (int axis = 0; axis < Dim; ++axis) {
      if (!box.periodic[std::size_t(axis)]) continue;
      const Real side = box.upper[axis] - box.lower[axis];
      const Index before = points_.size();
      for (Index i = 0; i < before; ++i) {
        for (const Real shift : {side, -side}) {
          Vec x = points_[i];
          x[axis] += shift;
          if (x[axis] < box.lower[axis] - reach || x[axis] > box.upper[axis] + reach) continue;
          points_.push_back(x);
          owners_.push_back(std::uint32_t(owners_[i]));
        }
      }
    }
  }
  void add_row(Set& set, Index number, Index k, const Vec& x, Real reach) {
    const auto begin = std::uint32_t(set.point.size());
    Real sum = 0;
    cells_.for_each_around(x, reach, cells_.size(), [&](Index slot) {
      const Real q = (cells_.at(slot) - x).norm() / reach;
      if (!(q < 1)) return;
      const Real w = mps::WendlandKernel::weight(q);
      set.point.push_back(cells_.item_of()[slot]);
      set.weight.push_back(w);
      sum += w;
    });
    const auto end = std::uint32_t(set.point.size());
    for (std::uint32_t n = begin; n < end; ++n) set.weight[n] /= sum;
    sums_[k] = sum;
    rows_[k] = {std::uint32_t(number), begin, end};
  }
  // The grains of each particle in ascending order, whatever the number of blocks.
  void transpose() {
    const auto blocks = Index(threads_for(rows_.size()));
    next_.assign(blocks * fluid_, 0);
    const auto for_each_pair = [&](auto&& f) {
      for_each_task(blocks, [&](Index block) {
        const Index end = rows_.size() * (block + 1) / blocks;
        std::uint32_t* const next = next_.data() + block * fluid_;
        for (Index k = rows_.size() * block / blocks; k < end; ++k) {
          for_each_particle(k, [&](Index i, Real weight) { f(next[i]++, k, weight); });
        }
      });
    };
    for_each_pair([](std::uint32_t, Index, Real) {});
    first_.resize(fluid_ + 1);
    std::uint32_t pairs = 0;
    for (Index i = 0; i < fluid_; ++i) {
      first_[i] = pairs;
      for (Index block = 0; block < blocks; ++block) {
        pairs += std::exchange(next_[block * fluid_ + i], pairs);
      }
    }
    first_[fluid_] = pairs;
    grain_.resize(pairs);
    weight_.resize(pairs);
    for_each_pair([&](std::uint32_t place, Index k, Real weight) {
      grain_[place] = std::uint32_t(k);
      weight_[place] = weight;
    });
  }

  Buffer<Vec> points_;
  Buffer<std::uint32_t> owners_;  // of these
  SortedCells<Dim, Real> cells_;
  Index fluid_ = 0;
  Real reach_ = 1;       // [m]
  Buffer<Vec> centres_;  // of the grains [m]
  Buffer<Row> rows_;
  Buffer<Real> sums_;
  Buffer<Set> sets_;
  Buffer<std::uint32_t> first_;  // of each fluid particle
  Buffer<std::uint32_t> next_;   // of each, by block of grains
  Buffer<std::uint32_t> grain_;
  Buffer<Real> weight_;
};

}  // namespace silt::coupled
