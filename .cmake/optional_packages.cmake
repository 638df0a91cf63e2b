# SPDX-License-Identifier: MIT
# Optional packages may be missing, incomplete or broken: targets that need them are skipped, and
# the configuration continues. Included by CMakeLists.txt for the tests, examples and benchmarks.

# silt_find_optional(RESULT PACKAGE TARGET SOURCE [COMPONENTS …] [INCLUDES …] [LIBRARIES …])
#
#   silt_find_optional(found CLI11 CLI11::CLI11 "#include <CLI/CLI.hpp>\nint main() {}")
#
# Sets RESULT to TRUE and calls find_package if the program SOURCE can be built with the package's
# TARGET and the additional INCLUDES and LIBRARIES. find_package alone is not sufficient: a package
# with broken CMake files would abort the configuration, and a package may be found although its
# headers are missing. Therefore a separate project is configured and built first.
function(silt_find_optional result package target source)
  cmake_parse_arguments(PARSE_ARGV 4 arg "" "" "COMPONENTS;INCLUDES;LIBRARIES")
  set(${result} FALSE PARENT_SCOPE)
  set(find ${package} QUIET)
  if(arg_COMPONENTS)
    list(APPEND find COMPONENTS ${arg_COMPONENTS})
  endif()

  # Success is cached. Failure is kept for this configuration only, because the package may be
  # installed or repaired before the next one.
  get_property(failed GLOBAL PROPERTY SILT_${package}_FAILED)
  if(failed)
    return()
  endif()
  if(NOT SILT_${package}_WORKS)
    list(JOIN find " " find_text)
    list(JOIN arg_INCLUDES "\" \"" includes)
    list(JOIN arg_LIBRARIES "\" \"" libraries)
    silt_try_project(works ${PROJECT_BINARY_DIR}/optional/${package} "${source}" "\
find_package(${find_text})
add_executable(trial trial.cpp)
target_include_directories(trial PRIVATE \"${includes}\")
target_link_libraries(trial PRIVATE ${target} \"${libraries}\")")
    if(NOT works)
      message(STATUS "${package} was not found or does not work; \
see ${PROJECT_BINARY_DIR}/optional/${package}/log.txt")
      set_property(GLOBAL PROPERTY SILT_${package}_FAILED TRUE)
      return()
    endif()
    set(SILT_${package}_WORKS TRUE CACHE INTERNAL "A program with ${package} was built")
  endif()

  find_package(${find})
  if(TARGET ${target})
    set(${result} TRUE PARENT_SCOPE)
  else()
    unset(SILT_${package}_WORKS CACHE)
  endif()
endfunction()

# silt_try_project(RESULT FOLDER SOURCE LINES): whether a project with these LINES, and SOURCE as
# trial.cpp, can be built with the compiler, flags and search paths of this project.
function(silt_try_project result folder source lines)
  file(REMOVE_RECURSE ${folder})
  set(settings "")
  get_cmake_property(names CACHE_VARIABLES)
  foreach(name IN LISTS names)
    get_property(type CACHE ${name} PROPERTY TYPE)
    if(NOT type MATCHES "INTERNAL|STATIC" AND NOT name MATCHES "^(SILT_.*|CMAKE_CXX_CLANG_TIDY)$")
      string(APPEND settings "set(${name} [==[${${name}}]==] CACHE STRING [==[]==])\n")
    endif()
  endforeach()
  file(WRITE ${folder}/settings.cmake "${settings}")
  file(WRITE ${folder}/trial.cpp "${source}\n")
  file(WRITE ${folder}/CMakeLists.txt "cmake_minimum_required(VERSION 3.24)
project(trial LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
${lines}
")

  set(${result} FALSE PARENT_SCOPE)
  set(log "")
  foreach(arguments IN ITEMS "-C;settings.cmake;-G;${CMAKE_GENERATOR};-S;.;-B;build" "--build;build")
    execute_process(COMMAND ${CMAKE_COMMAND} ${arguments} WORKING_DIRECTORY ${folder}
      OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE code)
    string(APPEND log "${output}")
    file(WRITE ${folder}/log.txt "${log}")
    if(NOT code EQUAL 0)
      return()
    endif()
  endforeach()
  set(${result} TRUE PARENT_SCOPE)
endfunction()

# silt_find_hypre(RESULT): creates the target silt_hypre; Debian's hypre has no CMake files.
function(silt_find_hypre result)
  if(NOT TARGET silt_hypre)
    find_path(SILT_HYPRE_INCLUDE HYPRE.h PATH_SUFFIXES hypre)
    find_library(SILT_HYPRE_LIBRARY HYPRE)
    set(${result} FALSE PARENT_SCOPE)
    if(NOT SILT_HYPRE_INCLUDE OR NOT SILT_HYPRE_LIBRARY)
      return()
    endif()
    silt_find_optional(found MPI MPI::MPI_CXX
      "#include <HYPRE_utilities.h>\n#include <mpi.h>\nint main() { return HYPRE_GetError() + MPI_Finalize(); }"
      COMPONENTS CXX INCLUDES ${SILT_HYPRE_INCLUDE} LIBRARIES ${SILT_HYPRE_LIBRARY})
    if(NOT found)
      return()
    endif()
    add_library(silt_hypre INTERFACE)
    target_include_directories(silt_hypre SYSTEM INTERFACE ${SILT_HYPRE_INCLUDE})
    target_link_libraries(silt_hypre INTERFACE ${SILT_HYPRE_LIBRARY} MPI::MPI_CXX)
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()
