# SPDX-License-Identifier: MIT
# The component mpi: silt::mpi, for programs on several processes. Included by CMakeLists.txt and by the
# installed siltConfig.cmake, after silt_find.cmake.

silt_package(MPI FIND COMPONENTS CXX TARGETS MPI::MPI_CXX HEADER mpi.h USES "MPI_Finalize()"
  WITHOUT "Programs on several processes need it (Debian: libopenmpi-dev)")
silt_package(Zoltan TARGETS Zoltan::Zoltan HEADER zoltan.h USES "Zoltan_Destroy(nullptr)" NEEDS MPI
  WITHOUT "Programs on several processes need it (Debian: libtrilinos-zoltan-dev)")
silt_package(HYPRE TARGETS HYPRE::HYPRE HEADER HYPRE_utilities.h USES "HYPRE_ClearAllErrors()" NEEDS MPI
  WITHOUT "Programs on several processes need it (Debian: libhypre-dev)")

# silt_find_mpi(RESULT): creates the target silt::mpi, or sets silt_not_found. Called by
# find_package(silt COMPONENTS mpi), and by programs that use the library with add_subdirectory or
# FetchContent.
function(silt_find_mpi result)
  if(NOT TARGET silt::mpi)
    silt_find(MPI Zoltan HYPRE)
    if(NOT (MPI_FOUND AND Zoltan_FOUND AND HYPRE_FOUND))
      set(${result} FALSE PARENT_SCOPE)
      set(silt_not_found "${silt_not_found}" PARENT_SCOPE)
      return()
    endif()
    add_library(silt_mpi INTERFACE IMPORTED GLOBAL)
    add_library(silt::mpi ALIAS silt_mpi)
    target_link_libraries(silt_mpi INTERFACE silt::silt Zoltan::Zoltan HYPRE::HYPRE MPI::MPI_CXX)
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()
