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
#include <silt/core/transfer.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/search/last_positions.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/skin.hpp>
#include <silt/search/uniform_grid.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
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
    radius_ = radius;
  }
  /// How much farther than radius() the candidates reached at the last update: the skin, without
  /// what two particles have used up of it [m].
  Real margin() const noexcept { return std::max(Real(0), list_.skin - 2 * now_.moved); }

  /// Puts the owned particles in cell order if the list will have to be rebuilt.
  template <class P>
  void sort(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    bring_back_ghosts(particles);
    if (fits(particles)) {
      // While much of the skin is left nobody need be asked.
      if (now_.moved + 2 * now_.pace < list_.skin / 2) return;
      if (positions_.farthest_from(list_.reference, particles) <= list_.skin / 2) return;
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
    bring_back_ghosts(particles);
    ++now_.updates;
    const bool fitting = fits(particles);
    if (const auto farthest = positions_.take_owned(particles)) {
      now_.pace = *farthest;
      now_.moved += now_.pace;
      now_.travelled += double(now_.pace);
    }
    // The sum of the farthest moves is never less than the farthest of the sums, and nearly free.
    if (fitting && now_.moved > list_.skin / 2) {
      now_.moved = positions_.farthest_from(list_.reference, particles);
    }
    if (fitting && now_.moved <= list_.skin / 2) {
      particles.refresh_ghosts(position);
      positions_.take_ghosts(particles);
    } else {
      if (fitting) outgrow();
      build(particles);
      positions_.take_all(particles);
    }
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
    saved_asked_ = asked_;
    positions_.save();
    keeps_last_ = false;
  }
  void restore() noexcept {
    now_ = saved_;
    asked_ = saved_asked_;
    positions_.restore();
    if (keeps_last_) std::swap(list_, last_);
    keeps_last_ = false;
  }

  /// For a checkpoint, see core/transfer.hpp: what the list was built from, and its age, so that it
  /// is rebuilt, and positions are wrapped, in the same steps as ever.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    bool is_of_these = list_.radius > 0 && is_of(particles);
    bool has_last = positions_.are_of(particles);
    std::vector<Vec> reference, last;
    if (!Archive::reads && is_of_these) reference = list_.reference;
    if (!Archive::reads && has_last) {
      const auto known = positions_.first(particles.size());
      last.assign(known.begin(), known.end());
    }
    archive("built", list_.built);
    archive("is_of_these", is_of_these);
    archive("reference", reference);
    archive("has_last", has_last);
    archive("last", last);
    archive("radius", list_.radius);
    archive("skin", list_.skin);
    archive("has_rows", now_.has_rows);
    archive("asked", asked_);
    archive.within("tuning", [&] { now_.tuning.transfer(archive); });
    archive("moved", now_.moved);
    archive("pace", now_.pace);
    archive("updates", now_.updates);
    archive("rebuilds", now_.rebuilds);
    if constexpr (Archive::reads) {
      journey_ = Journey();
      if (is_of_these) {
        build_again(particles, reference);
      } else {
        list_.built = false;
      }
      if (has_last) take_again(particles, last);
    }
  }

  /// Times the list was built.
  std::uint64_t rebuilds() const noexcept { return now_.rebuilds; }
  /// Skin of the list as it was built last [m].
  Real skin() const noexcept { return list_.skin; }

 private:
  // What a rebuild replaces.
  struct List {
    bool built = false;
    Real radius = 0;
    Real skin = 0;
    std::uint64_t revision = 0;  // of the particles it was built from
    std::uint64_t owned_revision = 0;
    Inner grid;
    std::vector<Vec> reference;  // positions it was built from
    std::array<NeighbourRows, 2> rows;
  };

  // What every update changes.
  struct State {
    Skin tuning;
    Real moved = 0;     // at most, from where the list was built
    Real pace = 0;      // of the farthest since the update before
    Index updates = 0;  // of the list as it is
    std::array<bool, 2> has_rows{};  // it, of each kind
    double travelled = 0;  // the sum of paces [m]
    std::uint64_t rebuilds = 0;
  };

  const NeighbourRows& rows(Pairs pairs) const { return list_.rows[static_cast<Index>(pairs)]; }
  bool has_rows(Pairs pairs) const {
    const auto kind = static_cast<Index>(pairs);
    // Several threads may ask.
    if (!now_.has_rows[kind]) std::atomic_ref(asked_[kind]).store(true, std::memory_order_relaxed);
    return now_.has_rows[kind];
  }
  void build_rows(Pairs pairs) {
    const auto kind = static_cast<Index>(pairs);
    if (!asked_[kind] || now_.has_rows[kind]) return;
    list_.grid.build_rows(list_.rows[kind], pairs);
    now_.has_rows[kind] = true;
  }

  // Whether the list can be used for these particles.
  template <class P>
  bool fits(const P& particles) const {
    return list_.built && list_.radius == radius_ && positions_.are_of(particles) &&
           is_of(particles);
  }
  // Whether it is, or was, a list of these particles in their places.
  template <class P>
  bool is_of(const P& particles) const {
    return list_.owned_revision == particles.owned_revision() &&
           list_.reference.size() == particles.size();
  }
  template <class P>
  void build(P& particles) {
    if (!keeps_last_) {
      std::swap(list_, last_);
      keeps_last_ = true;
    }
    list_.built = false;
    now_.has_rows = {};
    list_.radius = radius();
    list_.skin = radius() * Real(now_.tuning.fraction());
    list_.grid.set_radius(list_.radius + list_.skin);
    list_.grid.update(particles);
    const auto x = particles[position];
    list_.reference.assign(x.begin(), x.end());
    note_revisions(particles);
    list_.built = true;
    now_.moved = 0;
    now_.updates = 0;
    ++now_.rebuilds;
  }
  template <class P>
  void note_revisions(const P& particles) {
    list_.revision = particles.revision();
    list_.owned_revision = particles.owned_revision();
  }

  // Ghosts that are not the list's are those of a step that was undone, or of another search.
  template <class P>
  void bring_back_ghosts(P& particles) {
    if (!fits(particles) || list_.revision == particles.revision()) return;
    const auto known = positions_.first(particles.size());
    const std::vector<Vec> last(known.begin(), known.end());
    build_again(particles, std::vector<Vec>(list_.reference));
    take_again(particles, last);
  }
  // The list as it was, of these positions.
  template <class P>
  void build_again(P& particles, const std::vector<Vec>& reference) {
    list_.grid.set_radius(list_.radius + list_.skin);
    at_positions(particles, reference, [&] { list_.grid.update(particles); });
    list_.reference = reference;
    note_revisions(particles);
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) {
      const auto kind = static_cast<Index>(pairs);
      if (now_.has_rows[kind]) list_.grid.build_rows(list_.rows[kind], pairs);
    }
  }
  // Last updated at these.
  template <class P>
  void take_again(P& particles, const std::vector<Vec>& last) {
    at_positions(particles, last, [&] {
      particles.refresh_ghosts(position);
      positions_.take_all(particles);
    });
  }

  // Somebody has moved too far: what that teaches about the skin.
  void outgrow() {
    for (const Pairs pairs : {Pairs::once, Pairs::twice}) {
      if (!now_.has_rows[static_cast<Index>(pairs)]) continue;
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
  std::array<bool, 2> saved_asked_{};
  LastPositions<Dim, Real> positions_;  // at the last update
};

}  // namespace silt
