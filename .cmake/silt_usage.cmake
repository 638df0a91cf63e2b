# SPDX-License-Identifier: MIT
# Compile options of the user's program, chosen when the user configures, for the user's compiler.
# Included by CMakeLists.txt and by the installed siltConfig.cmake, after silt_find.cmake.

option(SILT_OPENMP "Run Silt's loops on threads with OpenMP if the compiler supports it" ON)
option(SILT_SAME_BITS
  "Compile with -ffp-contract=off, for the same bits with every compiler and processor" ON)

silt_package(Eigen3 FIND 3.4 NO_MODULE TARGETS Eigen3::Eigen HEADER Eigen/Core
  WITHOUT "All of Silt needs it (Debian: libeigen3-dev)")
silt_package(OpenMP FIND COMPONENTS CXX TARGETS OpenMP::OpenMP_CXX
  WITHOUT "Programs run on one thread (clang on Debian needs the package libomp-dev; -DSILT_OPENMP=OFF \
hides this message)")
if(SILT_OPENMP)
  silt_try(Eigen3 OpenMP)  # both in one project
endif()

# silt_usage(TARGET): sets the options chosen above on TARGET, which has the headers and Eigen. They
# replace those of TARGET, so that none from the exporting machine remain, and are not installed.
macro(silt_usage target)
  set(silt_libraries Eigen3::Eigen)
  set(silt_flags "")
  if(SILT_OPENMP)
    silt_find(OpenMP)
    if(OpenMP_FOUND)
      list(APPEND silt_libraries $<BUILD_INTERFACE:OpenMP::OpenMP_CXX>)
    endif()
  endif()
  if(SILT_SAME_BITS)
    set(silt_flags $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-ffp-contract=off>)
    set(silt_flags $<BUILD_INTERFACE:${silt_flags}>)
  endif()
  set_target_properties(${target} PROPERTIES
    INTERFACE_LINK_LIBRARIES "${silt_libraries}" INTERFACE_COMPILE_OPTIONS "${silt_flags}")
  unset(silt_libraries)
  unset(silt_flags)
endmacro()

# Without optimisation, programs run up to a hundred times slower. The build type is the user's
# choice: it is not set here.
function(silt_warn_without_build_type)
  get_property(multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(multi_config OR CMAKE_BUILD_TYPE OR CMAKE_CXX_FLAGS MATCHES "-O([1-9sgz]|fast)")
    return()
  endif()
  silt_message_once(WARNING NO_BUILD_TYPE "No build type is set, so the compiler does not optimise, \
and programs that use Silt run up to 100 times slower. \
Type\n  cmake -DCMAKE_BUILD_TYPE=Release ${CMAKE_BINARY_DIR}")
endfunction()
