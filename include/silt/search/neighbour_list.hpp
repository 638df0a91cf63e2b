// SPDX-License-Identifier: MIT
// Neighbour list (Verlet list): neighbours within radius + skin, reused until a particle has moved
// by half the skin. Until then no pair can have come closer than the radius without being in the
// list.
//
// There are two kinds of rows: with every pair once, for for_each_candidate, and with every pair
// twice, for for_each_neighbour. A kind is built only if it is used: the first call uses the grid
// below the list, and the next update builds the rows, if they are bounded (list_grid.hpp).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/shared_array.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/search/ghosts.hpp>
#include <silt/search/last_positions.hpp>
#include <silt/search/list_grid.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/skin.hpp>
#include <silt/search/uniform_grid.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace silt {

/// A NeighbourSearch that is fast if particles move little between steps, as grains do. Inner is
/// the search that finds the pairs of its rows.
template <int Dim, class RealType = double, class Inner = UniformGrid<Dim, RealType>>
class NeighbourList {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< pairs closer than this are found [m]; 0: the interaction range
    /// Skin over radius [-]. A thicker skin means fewer rebuilds, but longer rows. If it is not
    /// given, it is tuned during the run.
    std::optional<Real> skin_fraction = {};
  };

  NeighbourList() = default;
  /// Throws if the radius or the skin is negative or not finite.
  explicit NeighbourList(Settings settings) : radius_(settings.radius) {
    require_not_negative("NeighbourList: radius", double(settings.radius));
    if (!settings.skin_fraction) return;
    require_not_negative("NeighbourList: skin_fraction", double(*settings.skin_fraction));
    state_.tuning = Skin(double(*settings.skin_fraction));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius [m] is not positive.
  void set_radius(Real radius) {
    require_positive("NeighbourList: radius", double(radius));
    radius_ = radius;
  }
  /// The candidates include all pairs closer than radius() plus this distance at the last update
  /// [m]: the skin minus twice the maximum displacement.
  Real margin() const noexcept {
    return std::max(Real(0), state_.list.skin - 2 * state_.displacement);
  }

  /// Sorts the owned particles by cell if the list must be rebuilt. Throws if there is no radius.
  template <class P>
  void sort(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    restore_ghosts(particles);
    if (is_valid_for(particles)) {
      // Much of the skin is left: skip the loop over the particles.
      if (state_.displacement + 2 * state_.last_displacement < state_.list.skin / 2) return;
      if (positions_.max_displacement_from(reference_, particles) <= state_.list.skin / 2) return;
      tune_skin();
      state_.list.built = false;
    }
    grid_.sort(particles, radius() * (1 + Real(state_.tuning.fraction())));
  }

  /// Reads the positions; rebuilds the list if particles were added, removed or reordered, if one
  /// has moved by more than half the skin, or if radii changed on which its candidates depend.
  /// Throws as make_ghosts() does, and if there is no radius.
  template <class P>
  void update(P& particles) {
    require_positive("NeighbourList: radius", double(radius()));
    image_ = NearestImage<Dim, Real>(particles.box());
    restore_ghosts(particles);
    ++state_.updates;
    const bool is_valid = is_valid_for(particles);
    if (const auto displacement = positions_.update_local(particles)) {
      // Its square may overflow; a checkpoint has finite numbers only.
      state_.last_displacement = std::min(*displacement, std::numeric_limits<Real>::max());
      state_.displacement += state_.last_displacement;
    }
    // The sum of the maximum displacements of all updates is an upper bound for the maximum
    // displacement, and cheaper.
    if (is_valid && state_.displacement > state_.list.skin / 2) {
      state_.displacement = positions_.max_displacement_from(reference_, particles);
    }
    if (is_valid && state_.displacement <= state_.list.skin / 2) {
      particles.copy_to_ghosts(position);
      positions_.update_ghosts(particles);
    } else {
      if (is_valid) tune_skin();
      build(particles);
    }
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) build_rows(pairs);
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius() * radius();
    const Vec x_i = positions_[i];
    const auto report = [&](Index j) {
      const Vec r_ij = image_(positions_[j] - x_i);
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach) f(j, r_ij, std::sqrt(r2));
    };
    if (!has_rows(Pairs::twice)) {
      grid_.for_each_neighbour(i, [&](Index j, const Vec&, Real) { report(j); });
      return;
    }
    // Branches on the distance would be mispredicted: collect first, without a branch.
    const auto row = rows(Pairs::twice)[grid_.distant_row_of(i)];
    std::array<std::uint32_t, 64> near;
    for (Index from = 0; from < row.size(); from += near.size()) {
      Index count = 0;
      for (const std::uint32_t j : row.subspan(from, std::min(near.size(), row.size() - from))) {
        near[count] = j;
        count += image_(positions_[j] - x_i).squaredNorm() < reach;
      }
      for (Index k = 0; k < count; ++k) report(near[k]);
    }
  }

  /// f(j) for the candidates j of the owned particle i. A pair of owned particles that was closer
  /// than radius() + margin() at the last update is reported at one of the two, a pair of an owned
  /// particle and a ghost at the owned one. Pairs farther apart may be reported as well. Of grains
  /// with radii of more than about 1:10, only pairs closer than R_i + R_j + radius() + margin() −
  /// 2 max R are certain to be reported, as by a LevelGrid.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    if (!has_rows(Pairs::once)) {
      // Through a reference: the loops of a grid are long, and are compiled for each type of f.
      const FunctionRef<void(Index)> call = f;
      grid_.for_each_candidate(i, call);
      return;
    }
    for (const std::uint32_t j : rows(Pairs::once)[grid_.row_of(i)]) f(Index{j});
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    const Real reach = radius() * radius();
    for (Index a = 0; a < state_.list.owned; ++a) {
      const auto report = [&](Index b) {
        if (grid_.is_second_image(a, b)) return;
        const Index i = std::min(a, b);
        const Index j = std::max(a, b);
        const Vec r_ij = image_(positions_[j] - positions_[i]);
        const Real r2 = r_ij.squaredNorm();
        if (r2 < reach) f(i, j, r_ij, std::sqrt(r2));
      };
      if (grid_.finds_only_contacts()) {
        grid_.for_each_distant_candidate(a, report);
      } else {
        for_each_candidate(a, report);
      }
    }
  }

  /// Keeps what the list was built from before the first rebuild in a step, for rolling back the
  /// step.
  void save() noexcept {
    saved_ = state_;
    saved_requested_ = requested_;
    positions_.save();
    keeps_previous_ = false;
    previous_reference_ = {};  // its memory may be that of positions
  }
  /// If the step has rebuilt the list, the next update first builds it as it was; until then, pairs
  /// cannot be found.
  void restore() noexcept {
    state_ = saved_;
    requested_ = saved_requested_;
    positions_.restore();
    if (keeps_previous_) {
      reference_.swap(previous_reference_);
      is_lost_ = true;
    }
    keeps_previous_ = false;
  }
  /// The same, but builds it at once, unless memory does not suffice or the particles have been
  /// reordered since.
  template <class P>
  void restore(P& particles) noexcept {
    restore();
    if (is_lost_) recover(particles);
  }

  /// Writes or reads, for a checkpoint (core/transfer.hpp), the positions from which the list was
  /// built and its age, so that it is rebuilt, and positions are wrapped, in the same steps as
  /// without a restart.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    bool is_of_these = state_.list.radius > 0 && is_built_from(particles);
    bool has_last = positions_.belong_to(particles);
    Buffer<Vec> reference, last;
    if (!Archive::reads && is_of_these) reference.assign(reference_.begin(), reference_.end());
    if (!Archive::reads && has_last) {
      const auto first = positions_.first(particles.local());
      last.assign(first.begin(), first.end());
    }
    bool built = state_.list.built && is_of_these;
    archive("built", built);
    archive("is_of_these", is_of_these);
    archive("reference", reference);
    archive("has_last", has_last);
    archive("last", last);
    archive("radius", state_.list.radius);
    archive("skin", state_.list.skin);
    archive("wanted_skin", state_.list.wanted_skin);
    archive.within("grid", [&] { grid_.transfer(archive); });
    archive("has_rows", state_.has_rows);
    archive("requested", requested_);
    archive.within("tuning", [&] { state_.tuning.transfer(archive); });
    archive("displacement", state_.displacement);
    archive("last_displacement", state_.last_displacement);
    archive("updates", state_.updates);
    archive("rebuilds", state_.rebuilds);
    if constexpr (Archive::reads) {
      image_ = NearestImage<Dim, Real>(particles.box());
      require_not_negative("NeighbourList: radius", double(state_.list.radius));
      require_not_negative("NeighbourList: skin", double(state_.list.wanted_skin));
      state_.list.built = built && is_of_these;
      if (is_of_these) {
        SharedArray<Vec> positions;
        positions.assign(reference.begin(), reference.end());
        repeat_build(particles, positions);
      }
      if (has_last) repeat_update(particles, last);
    }
  }

  /// The positions at the last update, with those of the halo and of ghosts [m], to be kept by
  /// others.
  const SharedArray<Vec>& last_positions() const noexcept { return positions_.shared(); }

  /// Number of times the list was built.
  std::uint64_t rebuilds() const noexcept { return state_.rebuilds; }
  /// Skin of the present list [m].
  Real skin() const noexcept { return state_.list.skin; }

 private:
  // What a list is built from, apart from the positions.
  struct Build {
    bool built = false;
    Real radius = 0;
    Real skin = 0;         // with which candidates are found [m]
    Real wanted_skin = 0;  // which decides how they are found, see ListGrid [m]
    std::uint64_t revision = 0;  // of the particles when it was built
    std::uint64_t owned_revision = 0;
    Index owned = 0;  // number of particles
  };

  // Changed by every update.
  struct State {
    Build list;
    Skin tuning;
    Real displacement = 0;     // upper bound of the displacement since the list was built
    Real last_displacement = 0;      // maximum displacement since the previous update
    Index updates = 0;  // since the list was built
    std::array<bool, 2> has_rows{};  // rows of each kind
    std::uint64_t rebuilds = 0;
  };

  const NeighbourRows& rows(Pairs pairs) const { return rows_[static_cast<Index>(pairs)]; }
  bool has_rows(Pairs pairs) const {
    if (is_lost_) refuse_lost();
    const auto kind = static_cast<Index>(pairs);
    // May be called by several threads.
    if (!state_.has_rows[kind]) {
      std::atomic_ref(requested_[kind]).store(true, std::memory_order_relaxed);
    }
    return state_.has_rows[kind];
  }
  [[noreturn, gnu::cold]] static void refuse_lost() {
    fail(
        "NeighbourList: a failed step has replaced the list; update it before pairs are looked "
        "for");
  }
  void build_rows(Pairs pairs) {
    const auto kind = static_cast<Index>(pairs);
    if (!requested_[kind] || state_.has_rows[kind]) return;
    state_.has_rows[kind] = grid_.build_rows(rows_[kind], pairs);
  }

  template <class P>
  void update_grid(P& particles) {
    state_.list.skin =
        grid_.update(particles, {.radius = state_.list.radius, .skin = state_.list.wanted_skin});
  }
  // Whether the list can be used for these particles.
  template <class P>
  bool is_valid_for(const P& particles) const {
    return state_.list.built && state_.list.radius == radius_ && positions_.belong_to(particles) &&
           is_built_from(particles);
  }
  // Whether the list was built from these particles in this order, with these radii.
  template <class P>
  bool is_built_from(const P& particles) const {
    return state_.list.owned_revision == particles.owned_revision() &&
           reference_.size() == particles.local() && grid_.has_radii_of(particles);
  }
  template <class P>
  void build(P& particles) {
    if (!keeps_previous_) {
      if (!grid_.has_radii_of(particles)) saved_.list.built = false;  // nor would it be found valid
      reference_.swap(previous_reference_);
      keeps_previous_ = true;
    }
    state_.list.built = false;
    is_lost_ = true;
    state_.has_rows = {};
    state_.list.radius = radius();
    state_.list.wanted_skin = std::min(radius() * Real(state_.tuning.fraction()),
                                       std::max(Real(0), depth_of_halo(particles) - radius()));
    check_periodic_sides(particles.box(),
                         {.radius = state_.list.radius, .skin = state_.list.wanted_skin});
    update_grid(particles);
    positions_.update_all(particles);
    reference_ = positions_.shared().first(particles.local());
    set_revisions(particles);
    state_.list.built = true;
    is_lost_ = false;
    state_.displacement = 0;
    state_.updates = 0;
    ++state_.rebuilds;
  }
  template <class P>
  void set_revisions(const P& particles) {
    state_.list.revision = particles.revision();
    state_.list.owned_revision = particles.owned_revision();
    state_.list.owned = particles.size();
  }

  // The ghosts are not those of the list after a step was rolled back or another search was
  // updated.
  template <class P>
  void restore_ghosts(P& particles) {
    if (!is_valid_for(particles)) return;
    if (is_lost_ || state_.list.revision != particles.revision()) repeat_all(particles);
  }
  template <class P>
  [[gnu::cold]] void recover(P& particles) noexcept {
    const bool is_of_these = state_.list.radius > 0 && positions_.belong_to(particles);
    try {
      if (is_of_these && is_built_from(particles)) repeat_all(particles);
    } catch (...) {  // the next update repeats it
    }
  }
  template <class P>
  [[gnu::cold]] void repeat_all(P& particles) {
    const auto first = positions_.first(particles.local());
    const Buffer<Vec> last(first.begin(), first.end());
    repeat_build(particles, SharedArray<Vec>(reference_));
    repeat_update(particles, last);
  }
  // Builds the list again from the positions at which it was built.
  template <class P>
  [[gnu::cold]] void repeat_build(P& particles, const SharedArray<Vec>& reference) {
    is_lost_ = true;
    at_positions(particles, reference, [&] { update_grid(particles); });
    reference_ = reference;
    set_revisions(particles);
    for (const Pairs pairs : {Pairs::twice, Pairs::once}) {
      const auto kind = static_cast<Index>(pairs);
      if (!state_.has_rows[kind]) continue;
      state_.has_rows[kind] = grid_.build_rows(rows_[kind], pairs);
    }
    is_lost_ = false;
  }
  // Repeats the last update at the positions of that time.
  template <class P>
  void repeat_update(P& particles, const Buffer<Vec>& last) {
    at_positions(particles, last, [&] {
      particles.copy_to_ghosts(position);
      positions_.update_all(particles);
    });
  }

  // A particle has moved by more than half the skin: adjust the skin.
  [[gnu::cold]] void tune_skin() {
    if (grid_.finds_only_contacts()) return;
    for (const Pairs pairs : {Pairs::once, Pairs::twice}) {
      if (!state_.has_rows[static_cast<Index>(pairs)]) continue;
      const auto particles = double(std::max<Index>(state_.list.owned, 1));
      state_.tuning.update({.dimension = Dim,
                            .entries = double(rows(pairs).entries()) / particles,
                            .updates = std::max<Index>(state_.updates, 1)});
      return;
    }
  }

  Real radius_ = 0;
  State state_;
  State saved_;
  ListGrid<Inner> grid_;
  std::array<NeighbourRows, 2> rows_;
  SharedArray<Vec> reference_;               // positions when the list was built, with the halo
  SharedArray<Vec> previous_reference_;      // those before the first rebuild in a step
  bool keeps_previous_ = false;              // the step has rebuilt the list
  bool is_lost_ = false;                     // grid and rows are not those of the list
  mutable std::array<bool, 2> requested_{};  // rows of each kind
  std::array<bool, 2> saved_requested_{};
  LastPositions<Dim, Real> positions_;  // at the last update
  // A particle may have crossed a periodic side since the list was built: distances are those of
  // the nearest images.
  NearestImage<Dim, Real> image_;
};

}  // namespace silt
