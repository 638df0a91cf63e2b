# SPDX-License-Identifier: MIT
# The component mpi: silt::mpi, for programs on several processes. Needs MPI and Zoltan, for which
# Debian has no CMake files.

# silt_find_mpi(RESULT): creates the target silt::mpi.
function(silt_find_mpi result)
  if(NOT TARGET silt::mpi)
    set(${result} FALSE PARENT_SCOPE)
    find_path(SILT_ZOLTAN_INCLUDE zoltan.h PATH_SUFFIXES trilinos zoltan)
    find_library(SILT_ZOLTAN_LIBRARY NAMES trilinos_zoltan zoltan)
    find_package(MPI QUIET COMPONENTS CXX)
    if(NOT MPI_CXX_FOUND OR NOT SILT_ZOLTAN_INCLUDE OR NOT SILT_ZOLTAN_LIBRARY)
      return()
    endif()
    add_library(silt_mpi INTERFACE IMPORTED GLOBAL)
    add_library(silt::mpi ALIAS silt_mpi)
    target_include_directories(silt_mpi SYSTEM INTERFACE ${SILT_ZOLTAN_INCLUDE})
    target_link_libraries(silt_mpi INTERFACE silt::silt ${SILT_ZOLTAN_LIBRARY} MPI::MPI_CXX)
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()
