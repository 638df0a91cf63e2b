# SPDX-License-Identifier: MIT
# Defines Zoltan::Zoltan if MPI::MPI_CXX exists; Debian's Zoltan has no CMake files.

find_path(SILT_ZOLTAN_INCLUDE zoltan.h PATH_SUFFIXES trilinos zoltan)
find_library(SILT_ZOLTAN_LIBRARY NAMES trilinos_zoltan zoltan)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Zoltan REQUIRED_VARS SILT_ZOLTAN_INCLUDE SILT_ZOLTAN_LIBRARY)
if(Zoltan_FOUND AND TARGET MPI::MPI_CXX AND NOT TARGET Zoltan::Zoltan)
  add_library(Zoltan::Zoltan INTERFACE IMPORTED)
  target_include_directories(Zoltan::Zoltan SYSTEM INTERFACE ${SILT_ZOLTAN_INCLUDE})
  target_link_libraries(Zoltan::Zoltan INTERFACE ${SILT_ZOLTAN_LIBRARY} MPI::MPI_CXX)
endif()
