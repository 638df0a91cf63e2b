# SPDX-License-Identifier: MIT
# The component mpi: silt::mpi, for programs on several processes. Needs MPI, Zoltan and hypre; for
# the last two Debian has no CMake files.

# silt_find_mpi(RESULT): creates the target silt::mpi. Called by find_package(silt COMPONENTS mpi), and
# by programs that use the library with add_subdirectory or FetchContent.
function(silt_find_mpi result)
  if(NOT TARGET silt::mpi)
    set(${result} FALSE PARENT_SCOPE)
    find_path(SILT_ZOLTAN_INCLUDE zoltan.h PATH_SUFFIXES trilinos zoltan)
    find_library(SILT_ZOLTAN_LIBRARY NAMES trilinos_zoltan zoltan)
    find_path(SILT_HYPRE_INCLUDE HYPRE.h PATH_SUFFIXES hypre)
    find_library(SILT_HYPRE_LIBRARY HYPRE)
    find_package(MPI QUIET COMPONENTS CXX)
    if(NOT MPI_CXX_FOUND OR NOT SILT_ZOLTAN_INCLUDE OR NOT SILT_ZOLTAN_LIBRARY
        OR NOT SILT_HYPRE_INCLUDE OR NOT SILT_HYPRE_LIBRARY)
      return()
    endif()
    add_library(silt_mpi INTERFACE IMPORTED GLOBAL)
    add_library(silt::mpi ALIAS silt_mpi)
    target_include_directories(silt_mpi SYSTEM INTERFACE
      ${SILT_ZOLTAN_INCLUDE} ${SILT_HYPRE_INCLUDE})
    target_link_libraries(silt_mpi INTERFACE silt::silt
      ${SILT_ZOLTAN_LIBRARY} ${SILT_HYPRE_LIBRARY} MPI::MPI_CXX)
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()
