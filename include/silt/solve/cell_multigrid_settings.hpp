// SPDX-License-Identifier: MIT
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// Settings of CellMultigrid.
struct CellMultigridSettings {
  /// Most cells that are solved for directly.
  static constexpr int max_direct = 64;
  /// Least mass of a cell over the sum of its conductances, on the finest level.
  static constexpr float min_mass = 1e-6f;

  double cell_size = 2;  ///< edge of the finest cells, in particle spacings [-]
  /// Rows with a smaller diagonal, relative to that of a full neighbourhood, are not part of
  /// V [-].
  double min_diagonal = 0.2;
  int sweeps = 2;                 ///< before and after each correction
  Index max_coarsest_cells = 16;  ///< coarsening stops at this number of cells, at most 64

  /// Throws if one is out of range.
  void check() const {
    require_between("CellMultigrid: cell_size", cell_size, {1, 16});
    require_between("CellMultigrid: min_diagonal", min_diagonal, {0, 1});
    require_between("CellMultigrid: sweeps", sweeps, {1, 16});
    require_between("CellMultigrid: max_coarsest_cells", double(max_coarsest_cells),
                    {1, double(max_direct)});
  }
};

}  // namespace silt
