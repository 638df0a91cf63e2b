// SPDX-License-Identifier: MIT
// The faces of walls near each particle, and what they hide.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/mirrors.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

namespace silt::mps {

/// The faces of walls around each particle.
template <int Dim>
class FacesNearParticles {
 public:
  using Vec = silt::Vec<Dim>;

  /// For the faces of this surface.
  explicit FacesNearParticles(std::shared_ptr<Faces<Dim>> faces) : faces_(std::move(faces)) {}
  FacesNearParticles(FacesNearParticles&&) noexcept = default;
  FacesNearParticles& operator=(FacesNearParticles&&) noexcept = default;
  /// Shares the faces, unless they move: two flows would move them.
  FacesNearParticles(const FacesNearParticles& other)
      : faces_(other.faces_),
        reach_(other.reach_),
        positions_(other.positions_),
        around_(other.around_),
        has_faces_(other.has_faces_),
        sides_(other.sides_),
        sees_all_(other.sees_all_) {
    if (!faces_->move()) return;
    faces_ = std::make_shared<Faces<Dim>>(*other.faces_);
    for (MirrorsAround<Dim>& around : around_) around.refer_to(*faces_);
  }
  FacesNearParticles& operator=(const FacesNearParticles& other) {
    return *this = FacesNearParticles(other);
  }
  ~FacesNearParticles() = default;

  /// To be placed before find().
  Faces<Dim>& moving_faces() noexcept { return *faces_; }

  /// The faces closer than reach [m] to each of the first particles, their number `owned`, of those at
  /// these positions, and whether they hide some of the others.
  template <class Positions>
  void find(const Positions& x, Index owned, double reach) {
    reach_ = reach;
    positions_.resize(x.size());
    for_each(x.size(), [&](Index j) { positions_[j] = x[j].template cast<double>(); });
    around_.resize(owned);
    has_faces_.resize(owned);
    find_faces();
    find_those_that_see_all();
  }

  const Faces<Dim>& faces() const noexcept { return *faces_; }
  double reach() const { return reach_; }  ///< [m]
  Index size() const { return around_.size(); }
  /// The faces around particle i.
  const MirrorsAround<Dim>& operator[](Index i) const { return around_[i]; }
  const Vec& position(Index j) const { return positions_[j]; }  ///< when they were found [m]
  /// Whether there are any near particle i; of most particles, nothing else is read.
  bool has_faces(Index i) const { return has_faces_[i] != 0; }
  /// Whether no face hides a neighbour of particle i.
  bool sees_all(Index i) const { return sees_all_[i] != 0; }

 private:
  // Particles that follow each other in memory are mostly close to each other.
  void find_faces() {
    constexpr Index together = 16;
    for_each_range<together>(around_.size(), [&](Index first, Index last) {
      const Index size = last - first;
      run_in_space<Dim>([&] {
        MirrorsAround<Dim>::find_all(*faces_, std::span<const Vec>(positions_).subspan(first, size),
                                     reach_, std::span(around_).subspan(first, size));
      });
      for (Index i = first; i < last; ++i) has_faces_[i] = !around_[i].empty();
    });
  }

  // A face hides nothing if all particles near it are on one side of its plane: both ends of a line
  // through it are near.
  void find_those_that_see_all() {
    sides_.assign(faces_->elements().size(), 0);
    const auto add = [&](const Vec& x, std::uint32_t k) {
      const std::uint8_t side = (*faces_)[k].height(x) > 0 ? 1 : 2;
      const std::atomic_ref sides(sides_[k]);
      if ((sides.load(std::memory_order_relaxed) & side) == 0) {
        sides.fetch_or(side, std::memory_order_relaxed);
      }
    };
    for_each(around_.size(), [&](Index i) {
      if (!has_faces(i)) return;
      for (const std::uint32_t k : around_[i].faces()) add(positions_[i], k);
    });
    for_each(positions_.size() - around_.size(), [&](Index k) {
      const Vec& ghost = positions_[around_.size() + k];
      faces_->for_each_near(ghost, reach_, [&](std::uint32_t face) { add(ghost, face); });
    });
    sees_all_.resize(around_.size());
    for_each(around_.size(), [&](Index i) {
      constexpr std::uint8_t both = 3;
      const auto may_hide = [&](std::uint32_t k) { return sides_[k] == both; };
      sees_all_[i] = !has_faces(i) || std::ranges::none_of(around_[i].faces(), may_hide);
    });
  }

  std::shared_ptr<Faces<Dim>> faces_;        // which around_ refers to
  double reach_ = 0;                         // [m]
  Buffer<Vec> positions_;
  Buffer<MirrorsAround<Dim>> around_;
  Buffer<std::uint8_t> has_faces_;  // each particle
  Buffer<std::uint8_t> sides_;     // of each face that have particles near it, as bits
  Buffer<std::uint8_t> sees_all_;  // of each particle
};

}  // namespace silt::mps
