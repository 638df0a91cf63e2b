// SPDX-License-Identifier: MIT
// The derivatives of equations by the positions of particles, and the shortest moves that solve the
// linear equations that they make.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace silt::mps::detail {

/// J: the derivatives of r_i, one equation of each particle i, or none, by the positions of the
/// particles. Filled by many threads: each row by one.
template <int Dim>
class Slopes {
 public:
  using Vec = silt::Vec<Dim>;

  /// No equation has a derivative yet. Row i has room for room(i) others.
  template <class F>
  void clear(Index size, F&& room) {
    own_.assign(size, Vec(Vec::Zero()));
    is_active_.assign(size, 0);
    row_ends_.resize(size + 1);
    row_ends_[0] = 0;
    for (Index i = 0; i < size; ++i) row_ends_[i + 1] = row_ends_[i] + room(i);
    rows_.resize(row_ends_[size]);
  }
  /// Particle i has an equation, with this derivative by its own position.
  void set_own(Index i, const Vec& own) {
    is_active_[i] = 1;
    own_[i] = own;
  }
  /// The derivative of number k in row i: by the position of j.
  void set(Index i, std::uint32_t k, std::uint32_t j, const Vec& value) {
    rows_[row_ends_[i] + k] = {j, value.template cast<float>()};
  }
  bool is_active(Index i) const { return is_active_[i] != 0; }  ///< whether i has an equation
  /// After all are set. Rows without an equation are not read.
  void end() { find_columns(); }

  /// s − Jᵀ (J Jᵀ + ε D)⁻¹ (r + J s), with the diagonal D: of the moves that solve r + J x = 0,
  /// those that differ least from the wishes s. By conjugate gradients.
  void find_moves(const Buffer<double>& residuals, const Buffer<Vec>& wishes, int most_iterations,
                  Buffer<Vec>& moves) const {
    const Index size = own_.size();
    moves.resize(size);
    constexpr double damping = 1e-3;  // ε
    Buffer<double> y(size, 0.0), rest(size), diagonal(size, 1.0), search(size), product(size);
    for_each(size, [&](Index i) {
      rest[i] = is_active_[i] ? -(residuals[i] + times(i, wishes)) : 0;
      if (is_active_[i]) diagonal[i] = std::max(squared_norm(i), 1e-300);
    });
    const auto dot = [&](const auto& a, const auto& b) {
      return ordered_sum(size, 0.0, [&](Index i) { return a[i] * b[i]; });
    };
    const auto scaled = [&](const auto& a) {
      return ordered_sum(size, 0.0, [&](Index i) { return a[i] * a[i] / diagonal[i]; });
    };
    double rho = scaled(rest);
    const double aim = 1e-6 * rho;
    for_each(size, [&](Index i) { search[i] = rest[i] / diagonal[i]; });
    for (int k = 0; k < most_iterations && rho > aim && rho > 0; ++k) {
      find_transposed(search, moves);
      for_each(size, [&](Index i) {
        product[i] = is_active_[i] ? times(i, moves) + damping * diagonal[i] * search[i] : 0;
      });
      const double alpha = rho / dot(search, product);
      for_each(size, [&](Index i) {
        y[i] += alpha * search[i];
        rest[i] -= alpha * product[i];
      });
      const double next = scaled(rest);
      const double beta = next / rho;
      rho = next;
      for_each(size, [&](Index i) { search[i] = rest[i] / diagonal[i] + beta * search[i]; });
    }
    find_transposed(y, moves);
    for_each(size, [&](Index i) { moves[i] += wishes[i]; });
  }

 private:
  // ∂r_i/∂x_j, with j in the row of i, and i in the column of j. In single precision: the sums wait
  // for memory, and both have the same values.
  struct Slope {
    std::uint32_t index;
    silt::Vec<Dim, float> value;

    Vec as_double() const { return value.template cast<double>(); }
  };

  void find_columns() {
    const Index size = own_.size();
    column_ends_.assign(size + 1, 0);
    for (Index i = 0; i < size; ++i) {
      if (!is_active_[i]) continue;
      for (std::size_t k = row_ends_[i]; k < row_ends_[i + 1]; ++k)
        ++column_ends_[rows_[k].index + 1];
    }
    for (Index j = 0; j < size; ++j) column_ends_[j + 1] += column_ends_[j];
    columns_.resize(column_ends_[size]);
    Buffer<std::size_t> next(column_ends_.begin(), column_ends_.end());
    for (Index i = 0; i < size; ++i) {
      if (!is_active_[i]) continue;
      for (std::size_t k = row_ends_[i]; k < row_ends_[i + 1]; ++k)
        columns_[next[rows_[k].index]++] = {std::uint32_t(i), rows_[k].value};
    }
  }
  // (J v)_i
  double times(Index i, const Buffer<Vec>& v) const {
    double sum = own_[i].dot(v[i]);
    for (std::size_t k = row_ends_[i]; k < row_ends_[i + 1]; ++k)
      sum += rows_[k].as_double().dot(v[rows_[k].index]);
    return sum;
  }
  double squared_norm(Index i) const {
    double sum = own_[i].squaredNorm();
    for (std::size_t k = row_ends_[i]; k < row_ends_[i + 1]; ++k)
      sum += rows_[k].as_double().squaredNorm();
    return sum;
  }
  // Jᵀ y
  void find_transposed(const Buffer<double>& y, Buffer<Vec>& found) const {
    for_each(own_.size(), [&](Index j) {
      Vec sum = y[j] * own_[j];
      for (std::size_t k = column_ends_[j]; k < column_ends_[j + 1]; ++k)
        sum += y[columns_[k].index] * columns_[k].as_double();
      found[j] = sum;
    });
  }

  Buffer<Vec> own_;
  Buffer<std::uint8_t> is_active_;
  Buffer<std::size_t> row_ends_, column_ends_;
  Buffer<Slope> rows_, columns_;
};

}  // namespace silt::mps::detail
