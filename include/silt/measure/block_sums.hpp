// SPDX-License-Identifier: MIT
// Averages over time with standard errors. Successive samples are correlated, so the standard error
// is computed from the variance of block averages [FlyvbjergPetersen1989].
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace silt {

/// An average over time with its standard error, from averages of blocks [FlyvbjergPetersen1989].
struct Estimate {
  double value = 0;  ///< [unit of the samples]
  /// [unit of the samples]; infinite: not known yet.
  double standard_error = std::numeric_limits<double>::infinity();
};

/// Sums of samples, each of which consists of a fixed number of values. The samples are collected
/// in 16 to 32 blocks of equal length: when there are 32, adjacent blocks are merged, which doubles
/// the length of a block.
class BlockSums {
 public:
  /// Throws unless the number of values is from 1 to 1e8.
  explicit BlockSums(Index numbers) {
    require_between("BlockSums: number of values", double(numbers), {1, 1e8});
    current_.assign(numbers, 0.0);
  }

  /// Throws if the sample has another number of values.
  void add(std::span<const double> sample) {
    if (sample.size() != current_.size()) {
      fail({"BlockSums: a sample has ", sample.size(), " values, not ", current_.size(),
            "; give all of them"});
    }
    for (Index k = 0; k < sample.size(); ++k) current_[k] += sample[k];
    ++samples_;
    if (++in_current_ == block_length_) close_block();
  }

  /// Writes or reads the sums for a checkpoint, see core/transfer.hpp. Throws if the number of
  /// values of a sample is different.
  template <class Archive>
  void transfer(Archive& archive) {
    const Index numbers = current_.size();
    std::vector<double> blocks;
    for (const auto& block : blocks_) blocks.insert(blocks.end(), block.begin(), block.end());
    archive("blocks", blocks);
    archive("current", current_);
    archive("in_current", in_current_);
    archive("block_length", block_length_);
    archive("samples", samples_);
    if constexpr (Archive::reads) {
      if (current_.size() != numbers || blocks.size() % numbers != 0) {
        fail({"BlockSums: the data read have samples of ", current_.size(), " values, not ",
              numbers, "; use the same number as when writing"});
      }
      if (in_current_ >= block_length_) {
        fail({"BlockSums: in_current = ", in_current_,
              " is not below block_length = ", block_length_, "; use an earlier checkpoint"});
      }
      blocks_.clear();
      for (auto at = blocks.begin(); at != blocks.end(); at += std::ptrdiff_t(numbers)) {
        blocks_.emplace_back(at, at + std::ptrdiff_t(numbers));
      }
    }
  }

  /// Number of samples so far.
  Index samples() const noexcept { return samples_; }
  /// Number of complete blocks.
  Index blocks() const noexcept { return blocks_.size(); }

  /// f(means), where means is a span of the averages over all samples. The standard error is that
  /// of f over the blocks, without blocks in which f is not finite.
  template <class F>
  Estimate estimate(F&& f) const {
    std::vector<double> means = current_;
    for (const auto& block : blocks_) add_to(means, block);
    Estimate estimate{.value = f(divided(means, samples_))};
    double sum = 0;
    double squares = 0;
    Index count = 0;
    for (const auto& block : blocks_) {
      means = block;
      const double off = f(divided(means, block_length_)) - estimate.value;
      if (!is_finite(off)) continue;
      sum += off;
      squares += squared(off);
      ++count;
    }
    if (count < 2) return estimate;
    const double n = double(count);
    const double variance = std::fmax(0.0, squares - sum * sum / n) / (n - 1);
    estimate.standard_error = std::sqrt(variance / n);
    return estimate;
  }

  /// Average of one of the values.
  Estimate mean(Index number) const {
    return estimate([=](std::span<const double> means) { return means[number]; });
  }

 private:
  static constexpr Index max_blocks = 32;

  static void add_to(std::vector<double>& sums, const std::vector<double>& more) {
    for (Index k = 0; k < sums.size(); ++k) sums[k] += more[k];
  }
  static std::span<const double> divided(std::vector<double>& sums, Index count) {
    for (double& sum : sums) sum /= double(count);
    return sums;
  }

  void close_block() {
    blocks_.push_back(current_);
    current_.assign(current_.size(), 0.0);
    in_current_ = 0;
    if (blocks_.size() < max_blocks) return;
    for (Index k = 0; k < max_blocks / 2; ++k) {
      blocks_[k] = blocks_[2 * k];
      add_to(blocks_[k], blocks_[2 * k + 1]);
    }
    blocks_.resize(max_blocks / 2);
    block_length_ *= 2;
  }

  std::vector<std::vector<double>> blocks_;
  std::vector<double> current_;
  Index in_current_ = 0;
  Index block_length_ = 1;
  Index samples_ = 0;
};

}  // namespace silt
