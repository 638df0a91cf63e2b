# SPDX-License-Identifier: MIT
# Defines HYPRE::HYPRE if MPI::MPI_CXX exists; Debian's hypre has no CMake files.

find_path(SILT_HYPRE_INCLUDE HYPRE.h PATH_SUFFIXES hypre)
find_library(SILT_HYPRE_LIBRARY HYPRE)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(HYPRE REQUIRED_VARS SILT_HYPRE_INCLUDE SILT_HYPRE_LIBRARY)
if(HYPRE_FOUND AND TARGET MPI::MPI_CXX AND NOT TARGET HYPRE::HYPRE)
  add_library(HYPRE::HYPRE INTERFACE IMPORTED)
  target_include_directories(HYPRE::HYPRE SYSTEM INTERFACE ${SILT_HYPRE_INCLUDE})
  target_link_libraries(HYPRE::HYPRE INTERFACE ${SILT_HYPRE_LIBRARY} MPI::MPI_CXX)
endif()
