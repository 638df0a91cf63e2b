// SPDX-License-Identifier: MIT
// Loads the data of several grains into SIMD registers, one register per number.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_DEM_CONTACT_GRAIN_ROWS
#define SILT_DEM_CONTACT_GRAIN_ROWS

#include <silt/core/particles.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace silt::dem::detail {

/// Contacts are evaluated eight at a time.
inline constexpr int lanes = 8;
/// Lists of contacts contain the indices of grains times this number, the length of their first
/// row, because address computations then need no shift.
inline constexpr std::uint32_t index_scale = 8;

/// The rows of grains, see dem/setup/grains.hpp: {x y z R vx vy vz m} and {wx wy wz I}; in 2D
/// {x y R m vx vy w I}.
template <int Dim, class RealType>
class GrainRows {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Refers to the grains; invalid once they move in memory. `scaled_indices` are indices times
  /// index_scale.
  template <class P>
  explicit GrainRows(const P& grains)
      : rows_(grains.storage(position).rows()), spins_(grains.storage(spin).rows()) {}
  GrainRows(const Real* rows, const Real* spins) : rows_(rows), spins_(spins) {}

  // Of one grain.
  Vec position_of(Index i) const { return Eigen::Map<const Vec>(rows_ + row_length * i); }
  Real radius_of(Index i) const { return rows_[row_length * i + Dim]; }
  Vec velocity_of(Index i) const { return Eigen::Map<const Vec>(rows_ + row_length * i + 4); }
  AngularVec<Dim, Real> spin_of(Index i) const {
    if constexpr (Dim == 2) {
      return rows_[row_length * i + 6];
    } else {
      return Eigen::Map<const Vec>(spins_ + 4 * i);
    }
  }

 protected:
  static constexpr Index row_length = 8;

  const Real* rows_;
  const Real* spins_;
};

}  // namespace silt::dem::detail

#define SILT_KERNELS <silt/dem/contact/grain_rows.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::dem::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// The rows of several grains in registers, one register per number.
template <int Dim, class RealType>
class GrainPacks : public GrainRows<Dim, RealType> {
  using Rows = GrainRows<Dim, RealType>;

 public:
  using Real = RealType;

  /// Number of grains per register.
  static constexpr int N = std::min(lanes, simd::lanes<Real>);
  using Pack = simd::Pack<Real, N>;
  struct Position {
    Pack x[Dim];  ///< [m]
    Pack R;       ///< [m]
    Pack m;       ///< [kg]; in 2D only
  };
  struct Motion {
    Pack v[Dim];                ///< [m/s]
    Pack w[angular_size<Dim>];  ///< [1/s]
    Pack m;                     ///< [kg]; in 3D only
  };

  explicit GrainPacks(const Rows& rows) : Rows(rows) {}

  /// `scaled_indices` are indices times index_scale.
  [[gnu::always_inline]] void load(const std::uint32_t* scaled_indices, Position& grains) const {
    Pack four[4];
    simd::columns_from<Real, N>([=, this](int lane) { return this->rows_ + scaled_indices[lane]; },
                                four);
    // One by one: std::copy_n copies in halves of a pack, whose use as a whole would have to wait.
    for (int k = 0; k < Dim; ++k) grains.x[k] = four[k];
    grains.R = four[Dim];
    grains.m = four[3];
  }
  [[gnu::always_inline]] void load(const std::uint32_t* scaled_indices, Motion& grains) const {
    Pack four[4];
    simd::columns_from<Real, N>(
        [=, this](int lane) { return this->rows_ + scaled_indices[lane] + 4; }, four);
    for (int k = 0; k < Dim; ++k) grains.v[k] = four[k];
    if constexpr (Dim == 2) {
      grains.w[0] = four[2];
    } else {
      grains.m = four[3];
      // In bytes, as a division by two would need an instruction of its own.
      constexpr Index stride = 4 * sizeof(Real) / index_scale;
      const auto* const spins = reinterpret_cast<const std::byte*>(this->spins_);
      simd::columns_from<Real, N>(
          [=](int lane) {
            return reinterpret_cast<const Real*>(spins + Index{scaled_indices[lane]} * stride);
          },
          four);
      for (int k = 0; k < 3; ++k) grains.w[k] = four[k];
    }
  }

  /// m of grains loaded by both.
  static const Pack& mass_of(const Position& at, const Motion& motion) {
    return Dim == 2 ? at.m : motion.m;
  }
};

}  // namespace silt::dem::detail::SILT_INSTRUCTION_SET

#endif
