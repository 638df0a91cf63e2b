// SPDX-License-Identifier: MIT
// A list of neighbours within radius + skin, reused until some particle has moved half the skin:
// until then no pair can have come closer than the radius unseen.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/ghosts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>
#include <silt/search/uniform_grid.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace silt {

template <int Dim, class RealType = double, class Inner = UniformGrid<Dim, RealType>>
class NeighbourList {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;          ///< as of UniformGrid [m]
    Real skin_fraction = Real(0.2);  ///< skin over radius [-]; larger: fewer rebuilds, longer rows
  };

  NeighbourList() = default;
  /// Throws if the radius or the skin is negative or not finite.
  explicit NeighbourList(Settings settings) : settings_(settings) {
    require_not_negative("NeighbourList: radius", double(settings.radius));
    require_not_negative("NeighbourList: skin_fraction", double(settings.skin_fraction));
  }

  Real radius() const noexcept { return settings_.radius; }
  /// Throws if the radius is not positive.
  void set_radius(Real radius) {
    require_positive("NeighbourList: radius", double(radius));
    if (radius != settings_.radius) built_ = false;
    settings_.radius = radius;
  }

  /// Takes the positions; rebuilds the list if particles came, went, were reordered or moved far.
  template <class P>
  void update(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    if (is_valid(particles)) {
      particles.refresh_ghosts(position);
    } else {
      build(particles);
    }
    const auto x = particles.with_ghosts(position);
    positions_.assign(x.begin(), x.end());
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius() * radius();
    const Vec x_i = positions_[i];
    for (const Index j : rows_[i]) {
      const Vec r_ij = positions_[j] - x_i;
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach) f(j, r_ij, std::sqrt(r2));
    }
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    const Index owned = rows_.size();
    for (Index i = 0; i < owned; ++i) {
      for_each_neighbour(i, [&](Index j, const Vec& r_ij, Real r) {
        if ((j < owned ? j : ghost_owners_[j - owned]) > i) f(i, j, r_ij, r);
      });
    }
  }

  /// The list before the first rebuild of a step is kept, so that undoing the step brings it back.
  void save() noexcept { keeps_last_ = false; }
  void restore() noexcept {
    if (!keeps_last_) return;
    std::swap(rows_, last_rows_);
    std::swap(reference_, last_reference_);
    // Ghosts went with the old list; without them it fits the particles again.
    if (!ghost_owners_.empty() || last_had_ghosts_) built_ = false;
    keeps_last_ = false;
  }

  /// Times the list was built.
  std::uint64_t rebuilds() const noexcept { return rebuilds_; }

 private:
  template <class P>
  bool is_valid(const P& particles) const {
    if (!built_ || particles.revision() != revision_ || particles.size() != reference_.size() ||
        particles.total() != positions_.size()) {
      return false;
    }
    const auto x = particles[position];
    const Real allowed = squared(settings_.skin_fraction * radius() / 2);
    // "not within" rather than "beyond": a NaN counts as moved, and the rebuild names it.
    return first_where(x.size(), [&](Index i) {
             return !((x[i] - reference_[i]).squaredNorm() <= allowed);
           }) == nowhere;
  }

  template <class P>
  void build(P& particles) {
    if (!keeps_last_) {
      std::swap(rows_, last_rows_);
      std::swap(reference_, last_reference_);
      last_had_ghosts_ = !ghost_owners_.empty();
      keeps_last_ = true;
    }
    built_ = false;
    inner_.set_radius(radius() * (1 + settings_.skin_fraction));
    inner_.update(particles);
    const Index n = particles.size();
    rows_.build(n, [&](Index i, auto&& add) {
      inner_.for_each_neighbour(i, [&](Index j, const Vec&, Real) { add(j); });
    });
    const auto x = particles[position];
    reference_.assign(x.begin(), x.end());
    ghost_owners_.resize(particles.total() - n);
    for (Index g = 0; g < ghost_owners_.size(); ++g) ghost_owners_[g] = particles.owner(n + g);
    revision_ = particles.revision();
    built_ = true;
    ++rebuilds_;
  }

  Settings settings_;
  Inner inner_;
  bool built_ = false;
  std::uint64_t revision_ = 0;
  std::uint64_t rebuilds_ = 0;
  std::vector<Vec> reference_;  // positions the list was built from
  std::vector<Vec> positions_;
  Rows<Index> rows_;
  std::vector<Index> ghost_owners_;
  Rows<Index> last_rows_;
  std::vector<Vec> last_reference_;
  bool last_had_ghosts_ = false;
  bool keeps_last_ = false;
};

}  // namespace silt
