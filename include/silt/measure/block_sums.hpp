// SPDX-License-Identifier: MIT
// Averages over time, and how well they are known: samples that follow one another closely tell
// the same, so the standard error comes from the spread among blocks of them
// [FlyvbjergPetersen1989].
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace silt {

struct Estimate {
  double value = 0;
  double standard_error = std::numeric_limits<double>::infinity();  ///< infinite: not known yet
};

/// Sums of samples, each a row of so many numbers. The samples lie in 16 to 32 blocks of equal
/// length: when there are 32, each two become one, and blocks are twice as long from then on.
class BlockSums {
 public:
  /// Throws if a sample has no numbers.
  explicit BlockSums(Index numbers) : current_(numbers, 0.0) {
    if (numbers == 0) fail("BlockSums: a sample of 0 numbers has no average; give at least 1");
  }

  /// Throws if the sample has another number of numbers.
  void add(std::span<const double> sample) {
    if (sample.size() != current_.size()) {
      fail("BlockSums: a sample has " + std::to_string(sample.size()) + " numbers, not " +
           std::to_string(current_.size()) + "; give all of them");
    }
    for (Index k = 0; k < sample.size(); ++k) current_[k] += sample[k];
    ++samples_;
    if (++in_current_ == block_length_) close_block();
  }

  /// For a checkpoint.
  template <class Archive>
  void transfer(Archive& archive) {
    Index blocks = blocks_.size();
    archive("blocks", blocks);
    blocks_.resize(blocks);
    for (auto& block : blocks_) archive("block", block);
    archive("current", current_);
    archive("in_current", in_current_);
    archive("block_length", block_length_);
    archive("samples", samples_);
  }

  Index samples() const noexcept { return samples_; }
  /// Whole blocks.
  Index blocks() const noexcept { return blocks_.size(); }

  /// f(means) of all samples; means is a span of the numbers' averages. Its standard error is that
  /// of f over the blocks; those where f is not finite are left out.
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

  /// Average of one of the numbers.
  Estimate mean(Index number) const {
    return estimate([=](std::span<const double> means) { return means[number]; });
  }

 private:
  static constexpr Index most_blocks = 32;

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
    if (blocks_.size() < most_blocks) return;
    for (Index k = 0; k < most_blocks / 2; ++k) {
      blocks_[k] = blocks_[2 * k];
      add_to(blocks_[k], blocks_[2 * k + 1]);
    }
    blocks_.resize(most_blocks / 2);
    block_length_ *= 2;
  }

  std::vector<std::vector<double>> blocks_;
  std::vector<double> current_;
  Index in_current_ = 0;
  Index block_length_ = 1;
  Index samples_ = 0;
};

}  // namespace silt
