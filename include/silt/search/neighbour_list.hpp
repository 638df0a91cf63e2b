// SPDX-License-Identifier: MIT
// A list of neighbours within radius + skin, reused until some particle has moved half the skin:
// until then no pair can have come closer than the radius unseen.
//
// Its rows hold every pair once, for for_each_candidate, or twice, for for_each_neighbour. Only
// those are built that were asked for: the first question is answered by the grid below the list,
// and from the next update on there are rows for it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/ghosts.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/skin.hpp>
#include <silt/search/uniform_grid.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

template <int Dim, class RealType = double, class Inner = UniformGrid<Dim, RealType>>
class NeighbourList {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< as of UniformGrid [m]
    /// Skin over radius [-]: thicker, and the list is rebuilt less often, but its rows are longer.
    /// Without one it tunes itself.
    std::optional<Real> skin_fraction = {};
  };

  NeighbourList() = default;
  /// Throws if the radius or the skin is negative or not finite.
  explicit NeighbourList(Settings settings) : radius_(settings.radius) {
    require_not_negative("NeighbourList: radius", double(settings.radius));
    if (!settings.skin_fraction) return;
    require_not_negative("NeighbourList: skin_fraction", double(*settings.skin_fraction));
    now_.tuning = Skin(double(*settings.skin_fraction));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius is not positive.
  void set_radius(Real radius) {
    require_positive("NeighbourList: radius", double(radius));
    if (radius != radius_) list_.built = false;
    radius_ = radius;
  }
  /// How much farther than radius() the candidates reached at the last update: the skin, without
  /// what two particles have used up of it [m].
  Real margin() const noexcept { return std::max(Real(0), list_.skin - 2 * now_.moved); }

  /// Puts the owned particles in cell order if the list will have to be rebuilt.
  template <class P>
  void sort(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    if (fits(particles)) {
      // While much of the skin is left nobody need be asked.
      if (now_.moved + 2 * now_.pace < list_.skin / 2) return;
      if (farthest_move(particles) <= list_.skin / 2) return;
      outgrow();
      list_.built = false;
    }
    list_.grid.set_radius(radius() * (1 + Real(now_.tuning.fraction())));
    if constexpr (requires { list_.grid.sort(particles); }) list_.grid.sort(particles);
  }

  /// Takes the positions; rebuilds the list if particles came, went, were reordered or moved far.
  template <class P>
  void update(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    ++now_.updates;
    const bool fitting = fits(particles);
    const auto before = set_aside_positions();
    if (knows(particles)) take_owned(particles, before);
    // The sum of the farthest moves is never less than the farthest of the sums, and nearly free.
    if (fitting && now_.moved > list_.skin / 2) now_.moved = farthest_move(particles);
    if (fitting && now_.moved <= list_.skin / 2) {
      particles.refresh_ghosts(position);
      const auto x = particles.with_ghosts(position);
      std::copy(x.begin() + std::ptrdiff_t(particles.size()), x.end(),
                positions_.begin() + std::ptrdiff_t(particles.size()));
    } else {
      if (fitting) outgrow();
      build(particles);
      const auto x = particles.with_ghosts(position);
      positions_.assign(x.begin(), x.end());
    }
    now_.revision = particles.revision();
    now_.total = particles.total();
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) build_rows(pairs);
  }

  /// Grows at every update by what the farthest particle moved since the one before.
  Travel travel() const noexcept { return {journey_.number(), now_.travelled}; }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius() * radius();
    const Vec x_i = positions_[i];
    const auto meet = [&](Index j) {
      const Vec r_ij = positions_[j] - x_i;
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach) f(j, r_ij, std::sqrt(r2));
    };
    if (!has_rows(Pairs::twice)) {
      list_.grid.for_each_neighbour(i, [&](Index j, const Vec&, Real) { meet(j); });
      return;
    }
    // Who has come within the radius cannot be predicted: noted without a branch, then met.
    const auto row = rows(Pairs::twice)[list_.grid.slot_of(i)];
    std::array<std::uint32_t, 64> noted;
    for (Index from = 0; from < row.size(); from += noted.size()) {
      Index count = 0;
      for (const std::uint32_t j : row.subspan(from, std::min(noted.size(), row.size() - from))) {
        noted[count] = j;
        count += (positions_[j] - x_i).squaredNorm() < reach;
      }
      for (Index k = 0; k < count; ++k) meet(noted[k]);
    }
  }

  /// f(j) for some j of owned i: every pair of owned particles that was closer than radius() +
  /// margin() at the last update is met from one of the two, every owned one and ghost from the
  /// owned one. Others may come as well.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    if (!has_rows(Pairs::once)) {
      list_.grid.for_each_candidate(i, f);
      return;
    }
    for (const std::uint32_t j : rows(Pairs::once)[list_.grid.slot_of(i)]) f(Index{j});
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    const Real reach = radius() * radius();
    for (Index a = 0; a < list_.reference.size(); ++a) {
      for_each_candidate(a, [&](Index b) {
        if (list_.grid.is_second_image(a, b)) return;
        const Index i = std::min(a, b);
        const Index j = std::max(a, b);
        const Vec r_ij = positions_[j] - positions_[i];
        const Real r2 = r_ij.squaredNorm();
        if (r2 < reach) f(i, j, r_ij, std::sqrt(r2));
      });
    }
  }

  /// The list before the first rebuild of a step is kept, so that undoing the step brings it back.
  void save() noexcept {
    saved_ = now_;
    keeps_last_ = keeps_positions_ = false;
  }
  void restore() noexcept {
    now_ = saved_;
    if (keeps_positions_) positions_.swap(last_positions_);
    keeps_positions_ = false;
    if (!keeps_last_) return;
    std::swap(list_, last_);
    // Ghosts went with the old list; without them it fits the particles again.
    if (list_.has_ghosts || last_.has_ghosts) list_.built = false;
    keeps_last_ = false;
  }

  /// For a checkpoint, see core/transfer.hpp: what the list was built from, and its age, so that it
  /// is rebuilt, and positions are wrapped, in the same steps as ever.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    std::vector<Vec> reference, last;
    if (!Archive::reads && fits(particles)) {
      reference = list_.reference;
      last.assign(positions_.begin(), positions_.begin() + std::ptrdiff_t(particles.size()));
    }
    archive("reference", reference);
    archive("last", last);
    archive("skin", list_.skin);
    archive("has_rows", list_.has_rows);
    archive("asked", asked_);
    archive("rebuilds", rebuilds_);
    archive.within("tuning", [&] { now_.tuning.transfer(archive); });
    archive("moved", now_.moved);
    archive("pace", now_.pace);
    archive("updates", now_.updates);
    if constexpr (Archive::reads) {
      journey_ = Journey();
      list_.built = false;
      if (!reference.empty() && reference.size() == particles.size()) {
        build_again(particles, reference, last);
      }
    }
  }

  /// Times the list was built.
  std::uint64_t rebuilds() const noexcept { return rebuilds_; }
  /// Skin of the list as it was built last [m].
  Real skin() const noexcept { return list_.skin; }

 private:
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  // What a rebuild replaces.
  struct List {
    bool built = false;
    bool has_ghosts = false;
    Real skin = 0;
    std::uint64_t revision = 0;
    Inner grid;
    std::vector<Vec> reference;  // positions it was built from
    std::array<NeighbourRows, 2> rows;
    std::array<bool, 2> has_rows{};
  };

  // What every update changes.
  struct State {
    Skin tuning;
    Real moved = 0;     // at most, from where the list was built
    Real pace = 0;      // of the farthest since the update before
    Index updates = 0;  // of the list as it is
    double travelled = 0;  // the sum of paces [m]
    std::uint64_t revision = 0;  // of the particles at the last update
    Index total = 0;             // of them then
  };

  const NeighbourRows& rows(Pairs pairs) const { return list_.rows[static_cast<Index>(pairs)]; }
  bool has_rows(Pairs pairs) const {
    const auto kind = static_cast<Index>(pairs);
    // Several threads may ask.
    if (!list_.has_rows[kind]) std::atomic_ref(asked_[kind]).store(true, std::memory_order_relaxed);
    return list_.has_rows[kind];
  }
  void build_rows(Pairs pairs) {
    const auto kind = static_cast<Index>(pairs);
    if (!asked_[kind] || list_.has_rows[kind]) return;
    list_.grid.build_rows(list_.rows[kind], pairs);
    list_.has_rows[kind] = true;
  }

  // Whether these are the particles of the list, in their places.
  template <class P>
  bool fits(const P& particles) const {
    return list_.built && knows(particles) && particles.revision() == list_.revision &&
           particles.size() == list_.reference.size();
  }
  // Whether the positions of the last update are theirs, place by place.
  template <class P>
  bool knows(const P& particles) const {
    return particles.revision() == now_.revision && particles.total() == now_.total;
  }

  // How far the farthest has moved from where the list was built.
  template <class P>
  Real farthest_move(const P& particles) {
    const auto* const x = lanes_of(particles[position].data());
    const auto* const reference = lanes_of(list_.reference.data());
    return farthest(particles.size(), [=](Index i) { return (x[i] - reference[i]).squaredNorm(); });
  }

  // The positions of the last update; new ones do not write over them while a step may be undone.
  std::span<const Vec> set_aside_positions() {
    if (keeps_positions_) return positions_;
    positions_.swap(last_positions_);
    positions_.resize(last_positions_.size());
    keeps_positions_ = true;
    return last_positions_;
  }

  // Takes the positions of the owned particles, and notes how far they moved.
  template <class P>
  void take_owned(const P& particles, std::span<const Vec> before) {
    const auto* const x = lanes_of(particles[position].data());
    const auto* const last = lanes_of(before.data());
    auto* const taken = lanes_of(positions_.data());
    now_.pace = farthest(particles.size(), [=](Index i) {
      const auto moved = (x[i] - last[i]).squaredNorm();
      taken[i] = x[i];
      return moved;
    });
    now_.moved += now_.pace;
    now_.travelled += double(now_.pace);
  }

  // √ of the largest of squared(i); infinity if one is no number, and the rebuild names it.
  template <class Squared>
  Real farthest(Index n, Squared&& squared) {
    // Of numbers that are not negative the larger has the larger bits, and what is no number has
    // the largest: unlike the larger of two Reals, that is found for many at once.
    constexpr Bits without_sign = ~Bits(0) / 2;
    farthest_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) {
      Bits most = 0;
      SILT_EACH_LANE_ALONE
      for (Index i = chunk.first; i < chunk.last; ++i) {
        most = std::max(most, std::bit_cast<Bits>(Real(squared(i))) & without_sign);
      }
      farthest_[chunk.number] = most;
    });
    if (farthest_.empty()) return 0;
    const auto most = std::bit_cast<Real>(*std::max_element(farthest_.begin(), farthest_.end()));
    return most >= 0 ? std::sqrt(most) : std::numeric_limits<Real>::infinity();
  }

  template <class P>
  void build(P& particles) {
    // One without a skin is rebuilt at every move, so that there is nothing to bring back.
    if (!keeps_last_ && list_.skin > 0) {
      std::swap(list_, last_);
      keeps_last_ = true;
    }
    list_.built = false;
    list_.has_rows = {};
    list_.skin = radius() * Real(now_.tuning.fraction());
    list_.grid.set_radius(radius() + list_.skin);
    list_.grid.update(particles);
    const auto x = particles[position];
    list_.reference.assign(x.begin(), x.end());
    list_.has_ghosts = particles.total() > particles.size();
    list_.revision = particles.revision();
    list_.built = true;
    now_.moved = 0;
    now_.updates = 0;
    ++rebuilds_;
  }

  // The list as it was, of these positions, and last updated at those.
  template <class P>
  void build_again(P& particles, const std::vector<Vec>& reference, const std::vector<Vec>& last) {
    list_.grid.set_radius(radius() + list_.skin);
    at_positions(particles, reference, [&] { list_.grid.update(particles); });
    list_.reference = reference;
    list_.has_ghosts = particles.total() > particles.size();
    list_.revision = now_.revision = particles.revision();
    list_.built = true;
    now_.total = particles.total();
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) {
      const auto kind = static_cast<Index>(pairs);
      if (list_.has_rows[kind]) list_.grid.build_rows(list_.rows[kind], pairs);
    }
    at_positions(particles, last, [&] {
      particles.refresh_ghosts(position);
      const auto x = particles.with_ghosts(position);
      positions_.assign(x.begin(), x.end());
    });
  }

  // Somebody has moved too far: what that teaches about the skin.
  void outgrow() {
    for (const Pairs pairs : {Pairs::once, Pairs::twice}) {
      if (!list_.has_rows[static_cast<Index>(pairs)]) continue;
      const auto particles = double(std::max<Index>(list_.reference.size(), 1));
      now_.tuning.learn({.dimension = Dim,
                         .entries = double(rows(pairs).entries()) / particles,
                         .updates = std::max<Index>(now_.updates, 1)});
      return;
    }
  }

  Journey journey_;
  Real radius_ = 0;
  State now_;
  State saved_;
  List list_;
  List last_;
  bool keeps_last_ = false;
  mutable std::array<bool, 2> asked_{};  // for rows of each kind
  std::uint64_t rebuilds_ = 0;
  std::vector<Vec> positions_;  // with ghosts, at the last update
  std::vector<Vec> last_positions_;  // at the last update before the step
  bool keeps_positions_ = true;
  std::vector<Bits> farthest_;  // squared, by chunk
};

}  // namespace silt
