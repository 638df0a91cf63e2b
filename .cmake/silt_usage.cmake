# SPDX-License-Identifier: MIT
# What a user's program is compiled with beyond the headers is chosen when the user configures, with
# the user's compiler: CMakeLists.txt includes this file, and so does the installed siltConfig.cmake.

option(SILT_OPENMP "Run Silt's loops on threads with OpenMP if the compiler supports it" ON)
option(SILT_SAME_BITS
  "Compile with -ffp-contract=off, so that every compiler and processor computes the same bits" ON)

# silt_usage(TARGET): gives TARGET, which has the headers and Eigen, the options chosen above.
# Replaces what TARGET had, so that nothing of the machine that exported it is left; what is set here
# is not installed.
macro(silt_usage target)
  set(silt_libraries Eigen3::Eigen)
  set(silt_flags "")
  if(SILT_OPENMP)
    find_package(OpenMP QUIET COMPONENTS CXX)
    if(OpenMP_CXX_FOUND)
      list(APPEND silt_libraries $<BUILD_INTERFACE:OpenMP::OpenMP_CXX>)
    else()
      silt_say_once(STATUS NO_OPENMP "OpenMP was not found for ${CMAKE_CXX_COMPILER}, so programs \
run on one thread (clang on Debian needs the package libomp-dev; -DSILT_OPENMP=OFF hides this line)")
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

# Programs without optimisation run up to a hundred times slower, and nothing else would say why.
# The build type stays the user's: it is neither set nor changed here.
function(silt_warn_without_build_type)
  get_property(multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(multi_config OR CMAKE_BUILD_TYPE OR CMAKE_CXX_FLAGS MATCHES "-O([1-9sgz]|fast)")
    return()
  endif()
  silt_say_once(WARNING NO_BUILD_TYPE "No build type is set, so the compiler does not optimise, and \
programs that use Silt run up to 100 times slower. Type\n  cmake -DCMAKE_BUILD_TYPE=Release ${CMAKE_BINARY_DIR}")
endfunction()

# silt_say_once(KIND KEY TEXT): not again for the second find_package(silt) of a project.
function(silt_say_once kind key text)
  get_property(said GLOBAL PROPERTY SILT_SAID_${key})
  if(NOT said)
    set_property(GLOBAL PROPERTY SILT_SAID_${key} TRUE)
    message(${kind} "Silt: ${text}")
  endif()
endfunction()
