// SPDX-License-Identifier: MIT
// The cells of a lattice that the water of a pool takes: whole ones inside, and at walls as many of
// the cut ones as their volume asks for.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/filling/pool.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace silt::mps::detail {

/// Where the particles of a pool begin.
template <int Dim>
struct CellsOfPool {
  using Cell = Eigen::Matrix<int, Dim, 1>;

  bool is_lattice = false;  ///< whether the room consists of whole cells
  Vec<Dim> origin;          ///< a corner of the lattice [m]
  std::vector<Cell> cells;  ///< x varies fastest, the height slowest
  std::vector<Vec<Dim>>
      points;  ///< in the cells: their centres, or in the middle of the part in the room [m]
};

/// As many cells as the volume of the room has, but one at least. Of cells that walls cut, those
/// are taken with which the error of the volume around them stays below a half.
template <int Dim>
CellsOfPool<Dim> cells_of(const PoolRoom<Dim>& room) {
  using Cell = typename CellsOfPool<Dim>::Cell;
  constexpr int up = Dim - 1;
  const double l0 = room.spacing();
  const auto& extent = room.extent();

  // A lattice that begins at the lower walls if it fits, otherwise at the surface, in the middle.
  CellsOfPool<Dim> found;
  Cell size;
  for (int k = 0; k < Dim; ++k) {
    const double length = extent.upper[k] - extent.lower[k];
    const double whole = std::round(length / l0);
    const bool fits = whole > 0 && std::abs(length - whole * l0) <= 1e-9 * length;
    size[k] = int(fits ? whole : std::ceil(length / l0)) + 2;
    if (fits) {
      found.origin[k] = extent.lower[k];
    } else if (k == up && std::isfinite(room.level())) {
      found.origin[k] = room.level() - (size[k] - 2) * l0;
    } else {
      found.origin[k] = (extent.lower[k] + extent.upper[k]) / 2 - std::round(length / l0) / 2 * l0;
    }
  }
  // With a cell beyond each side.
  Index all = 1;
  for (int k = 0; k < Dim; ++k) all *= Index(size[k]);
  const auto cell_of = [&](Index i) {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      cell[k] = int(i % Index(size[k])) - 1;
      i /= Index(size[k]);
    }
    return cell;
  };
  const auto centre_of = [&](const Cell& cell) -> Vec<Dim> {
    return found.origin + l0 * (cell.template cast<double>().array() + 0.5).matrix();
  };
  Buffer<double> shares(all, 0.0);
  Buffer<Vec<Dim>> centres(all, Vec<Dim>(Vec<Dim>::Zero()));
  Buffer<std::uint8_t> is_cut(all, 0);  // a wall is in it
  for_each(all, [&](Index i) {
    const Vec<Dim> centre = centre_of(cell_of(i));
    centres[i] = centre;
    if (!room.is_near_face(centre, l0 / 2 * std::sqrt(double(Dim)))) {
      shares[i] = room.is_wet(centre) ? 1 : 0;
      return;
    }
    is_cut[i] = room.is_near_face(centre, l0 / 2 * (1 - 1e-6)) ? 1 : 0;
    constexpr int along = Dim == 2 ? 8 : 4;
    constexpr int points = Dim == 2 ? along * along : along * along * along;
    std::array<Vec<Dim>, points> wet;
    std::size_t number = 0;
    Vec<Dim> sum = Vec<Dim>::Zero();
    for (int p = 0; p < points; ++p) {
      Vec<Dim> x = centre;
      for (int k = 0, rest = p; k < Dim; ++k, rest /= along) {
        x[k] += ((rest % along + 0.5) / along - 0.5) * l0;
      }
      if (!room.is_wet(x)) continue;
      sum += x;
      wet[number++] = x;
    }
    shares[i] = double(number) / points;
    if (number == 0 || number == points) return;
    const Vec<Dim> middle = sum / double(number);
    centres[i] = middle;
    const double off_faces = 0.01 * l0;
    if (room.is_wet(middle) && !room.is_near_face(middle, off_faces)) return;
    // Around a corner of an obstacle, the middle of the part in the room may be in the obstacle.
    double least = std::numeric_limits<double>::infinity();
    for (const Vec<Dim>& x : std::span(wet).first(number)) {
      const double distance = (x - middle).norm();
      if (!(distance < least) || room.is_near_face(x, off_faces)) continue;
      least = distance;
      centres[i] = x;
    }
  });

  const auto add = [&](Index i) {
    found.cells.push_back(cell_of(i));
    found.points.push_back(centres[i]);
  };
  const double volume = room.volume() / std::pow(l0, Dim);
  const auto number = Index(std::max(1.0, std::round(volume)));
  double whole = 0, cut = 0;
  bool has_cut = false;
  for (Index i = 0; i < all; ++i) {
    (shares[i] < 1 ? cut : whole) += shares[i];
    has_cut = has_cut || (shares[i] > 0 && is_cut[i] != 0);
  }
  if (cut == 0 && !has_cut && std::abs(volume - whole) <= 1e-6 * std::max(1.0, whole)) {
    found.is_lattice = true;
    for (Index i = 0; i < all; ++i) {
      if (shares[i] > 0) add(i);
    }
    return found;
  }

  // Each cell that is cut passes its error on to those that follow beside it.
  const double scale = cut > 0 ? std::max(0.0, (volume - whole) / cut) : 0;
  Buffer<double> error(all, 0.0);
  Buffer<std::uint8_t> is_taken(all, 0);
  std::vector<Index> following;
  double rest = 0;
  Index taken = 0;
  for (Index i = 0; i < all; ++i) {
    if (shares[i] == 0) continue;
    if (shares[i] == 1) {
      is_taken[i] = 1;
      ++taken;
      continue;
    }
    double share = scale * shares[i] + error[i];
    if (std::abs(rest) > 0) share += std::exchange(rest, 0);
    is_taken[i] = share >= 0.5 ? 1 : 0;
    taken += is_taken[i];
    const double passed = share - is_taken[i];
    const Cell cell = cell_of(i);
    following.clear();
    Index around = 1;
    for (int k = 0; k < Dim; ++k) around *= 3;
    for (Index n = around / 2 + 1; n < around; ++n) {
      Cell other = cell;
      Index number_of_offset = n;
      for (int k = 0; k < Dim; ++k, number_of_offset /= 3)
        other[k] += int(number_of_offset % 3) - 1;
      Index j = 0;
      bool is_inside = true;
      for (int k = Dim; k-- > 0;) {
        is_inside = is_inside && other[k] >= -1 && other[k] < size[k] - 1;
        j = j * Index(size[k]) + Index(other[k] + 1);
      }
      if (is_inside && shares[j] > 0 && shares[j] < 1) following.push_back(j);
    }
    for (const Index j : following) error[j] += passed / double(following.size());
    if (following.empty()) rest = passed;
  }
  // The number, to the last particle.
  while (taken != number) {
    const bool adds = taken < number;
    Index best = no_index;
    for (Index i = 0; i < all; ++i) {
      if (shares[i] == 0 || (is_taken[i] != 0) == adds) continue;
      if (best == no_index || (adds ? shares[i] > shares[best] : shares[i] < shares[best]))
        best = i;
    }
    if (best == no_index) break;
    is_taken[best] = adds ? 1 : 0;
    adds ? ++taken : --taken;
  }
  for (Index i = 0; i < all; ++i) {
    if (is_taken[i] != 0) add(i);
  }
  return found;
}

}  // namespace silt::mps::detail
