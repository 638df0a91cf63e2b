// SPDX-License-Identifier: MIT
// The parts of space that processes own, by recursive bisection (Zoltan).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/world.hpp>

#include <zoltan.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace silt::mpi {

/// Cuts space so that every process has as much work as the others. Copies share the cuts.
template <int Dim>
class Cuts {
 public:
  /// Nothing is cut yet. Throws if Zoltan fails.
  explicit Cuts(const World& world) : world_(&world) {
    float version = 0;
    check(Zoltan_Initialize(0, nullptr, &version), "Zoltan_Initialize");
    auto* const made = Zoltan_Create(world.communicator());
    if (made == nullptr) fail("mpi: Zoltan_Create failed");
    zoltan_ = std::shared_ptr<Zoltan_Struct>(made, [](Zoltan_Struct* each) { Zoltan_Destroy(&each); });
    const auto set = [&](const char* name, const char* value) {
      check(Zoltan_Set_Param(zoltan_.get(), name, value), name);
    };
    set("DEBUG_LEVEL", "0");
    set("LB_METHOD", "RCB");
    set("KEEP_CUTS", "1");
    set("RETURN_LISTS", "NONE");
    set("NUM_GID_ENTRIES", "2");
    set("NUM_LID_ENTRIES", "1");
    set("OBJ_WEIGHT_DIM", "1");
    // Without a communicator for each half: Open MPI 4.1.4 fails now and then in MPI_Comm_split.
    set("TFLOPS_SPECIAL", "1");
  }

  /// Whether space has been cut.
  bool are_made() const noexcept { return are_made_; }

  /// Makes them for the points of all processes, each with some work. To be called by all.
  void make(std::span<const Vec<Dim>> points, std::span<const double> work) {
    points_ = points;
    work_ = work;
    auto* const z = zoltan_.get();
    Zoltan_Set_Num_Geom_Fn(z, [](void*, int* error) { return *error = ZOLTAN_OK, Dim; }, this);
    Zoltan_Set_Num_Obj_Fn(
        z,
        [](void* self, int* error) {
          *error = ZOLTAN_OK;
          return int(static_cast<Cuts*>(self)->points_.size());
        },
        this);
    Zoltan_Set_Obj_List_Fn(
        z,
        [](void* self, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int, float* weights,
           int* error) {
          const Cuts& own = *static_cast<Cuts*>(self);
          for (Index i = 0; i < own.points_.size(); ++i) {
            global[2 * i] = static_cast<ZOLTAN_ID_TYPE>(own.world_->rank());
            global[2 * i + 1] = local[i] = static_cast<ZOLTAN_ID_TYPE>(i);
            weights[i] = float(own.work_[i]);
          }
          *error = ZOLTAN_OK;
        },
        this);
    Zoltan_Set_Geom_Multi_Fn(
        z,
        [](void* self, int, int, int count, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int,
           double* coordinates, int* error) {
          const Cuts& own = *static_cast<Cuts*>(self);
          for (int k = 0; k < count; ++k) {
            for (int axis = 0; axis < Dim; ++axis) {
              coordinates[k * Dim + axis] = own.points_[local[k]][axis];
            }
          }
          *error = ZOLTAN_OK;
        },
        this);
    int changes, global_entries, local_entries, imports, exports;
    ZOLTAN_ID_PTR import_global, import_local, export_global, export_local;
    int *import_process, *import_part, *export_process, *export_part;
    check(Zoltan_LB_Partition(z, &changes, &global_entries, &local_entries, &imports,
                              &import_global, &import_local, &import_process, &import_part,
                              &exports, &export_global, &export_local, &export_process,
                              &export_part),
          "Zoltan_LB_Partition");
    points_ = {};
    work_ = {};
    are_made_ = true;
  }

  /// The process that owns this point [m].
  int owner_of(const Vec<Dim>& point) const {
    double x[3] = {};
    for (int axis = 0; axis < Dim; ++axis) x[axis] = point[axis];
    int process = 0;
    check(Zoltan_LB_Point_Assign(zoltan_.get(), x, &process), "Zoltan_LB_Point_Assign");
    return process;
  }
  /// Adds the processes that own a part of this box [m].
  void add_owners_of(const Vec<Dim>& lower, const Vec<Dim>& upper, std::vector<int>& processes) {
    found_.resize(Index(world_->size()));
    int count = 0;
    check(Zoltan_LB_Box_Assign(zoltan_.get(), lower[0], lower[1], Dim == 3 ? lower[Dim - 1] : 0,
                               upper[0], upper[1], Dim == 3 ? upper[Dim - 1] : 0, found_.data(),
                               &count),
          "Zoltan_LB_Box_Assign");
    processes.insert(processes.end(), found_.begin(), found_.begin() + count);
  }

 private:
  static void check(int code, const char* call) {
    if (code == ZOLTAN_OK || code == ZOLTAN_WARN) return;
    fail(std::string("mpi: ") + call + " failed with code " + std::to_string(code) +
         "; end the job and start it again");
  }

  const World* world_;
  std::shared_ptr<Zoltan_Struct> zoltan_;
  bool are_made_ = false;
  std::span<const Vec<Dim>> points_;
  std::span<const double> work_;
  std::vector<int> found_;
};

}  // namespace silt::mpi
