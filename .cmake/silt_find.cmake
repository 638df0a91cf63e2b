# SPDX-License-Identifier: MIT
# The only way in which Silt's CMake files look for packages. Included by CMakeLists.txt and by the
# installed siltConfig.cmake.
#
# A package may be absent, but also half there: the programs of MPI without its headers, headers
# without their library, CMake files that raise an error. Then find_package ends the configuration of
# a project that could go on without the package, or finds what does not compile. Therefore a program
# is first built with the package in a project of its own, whose failure ends nothing.

set_property(GLOBAL PROPERTY SILT_FIND_FOLDER "${CMAKE_CURRENT_LIST_DIR}")

# silt_package(NAME [FIND …] TARGETS … [HEADER …] [USES …] [NEEDS …] WITHOUT …)
#
#   silt_package(MPI FIND COMPONENTS CXX TARGETS MPI::MPI_CXX HEADER mpi.h USES "MPI_Finalize()"
#     WITHOUT "Programs on several processes need it (Debian: libopenmpi-dev)")
#
# Describes a package: further arguments of find_package, the targets that it defines, a header and a
# statement that compile and link with them, the packages that must be found before, and what to tell
# users who do not have it.
function(silt_package name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "HEADER;USES;WITHOUT" "FIND;TARGETS;NEEDS")
  foreach(part IN ITEMS FIND TARGETS HEADER USES NEEDS WITHOUT)
    set_property(GLOBAL PROPERTY SILT_${name}_${part} "${arg_${part}}")
  endforeach()
endfunction()

# silt_find(NAME … [QUIET | REQUIRED]): calls find_package for those packages that work, unless their
# targets exist, and sets NAME_FOUND for all. Of each of the others it prints a line, with REQUIRED as
# an error. With QUIET the lines are only in silt_not_found.
macro(silt_find)
  silt_try(${ARGN})
  get_property(silt_folder GLOBAL PROPERTY SILT_FIND_FOLDER)
  list(PREPEND CMAKE_MODULE_PATH "${silt_folder}")
  foreach(silt_name IN LISTS silt_usable)
    get_property(silt_arguments GLOBAL PROPERTY SILT_${silt_name}_FIND)
    find_package(${silt_name} ${silt_arguments} QUIET)
  endforeach()
  list(POP_FRONT CMAKE_MODULE_PATH)
  silt_report(${ARGN})
endmacro()

# Sets NAME_FOUND and silt_not_found, and prints.
function(silt_report)
  cmake_parse_arguments(PARSE_ARGV 0 arg "QUIET;REQUIRED" "" "")
  set(lines "")
  foreach(name IN LISTS arg_UNPARSED_ARGUMENTS)
    foreach(part IN ITEMS FIND NEEDS STATE WITHOUT)
      get_property(${part} GLOBAL PROPERTY SILT_${name}_${part})
    endforeach()
    silt_have_targets(found ${name})
    set(${name}_FOUND ${found} PARENT_SCOPE)
    silt_have_targets(have_needs ${NEEDS})
    if(found OR NOT have_needs)  # the line about what it needs says enough
      continue()
    endif()

    string(REGEX MATCH "^[0-9.]+" version "${FIND}")
    string(JOIN " " line ${name} ${version} "${STATE}. ${WITHOUT}")
    string(APPEND lines "${line}. ")
    if(arg_REQUIRED)
      message(FATAL_ERROR "Silt: ${line}")
    elseif(NOT arg_QUIET)
      silt_message_once(STATUS ${name} "${line}")
    endif()
  endforeach()
  string(STRIP "${lines}" lines)
  set(silt_not_found "${lines}" PARENT_SCOPE)
endfunction()

# Whether all targets of these packages exist.
function(silt_have_targets result)
  set(${result} TRUE PARENT_SCOPE)
  foreach(name IN LISTS ARGN)
    get_property(targets GLOBAL PROPERTY SILT_${name}_TARGETS)
    foreach(target IN LISTS targets)
      if(NOT TARGET ${target})
        set(${result} FALSE PARENT_SCOPE)
      endif()
    endforeach()
  endforeach()
endfunction()

# Sets silt_usable to those of the packages for which find_package may be called: those that work, and those
# that are not found, because this project may know more than the other one. Each is tried once in a
# configuration: together with the others and, if one of them fails, by itself.
function(silt_try)
  cmake_parse_arguments(PARSE_ARGV 0 arg "QUIET;REQUIRED" "" "")
  set(needed "")
  set(untried "")
  foreach(name IN LISTS arg_UNPARSED_ARGUMENTS)
    silt_have_targets(exist ${name})
    get_property(state GLOBAL PROPERTY SILT_${name}_STATE)
    if(NOT exist)
      list(APPEND needed ${name})
      if(NOT state)
        list(APPEND untried ${name})
      endif()
    endif()
  endforeach()

  set(all TRUE)
  list(LENGTH untried number)
  if(number GREATER 0)
    list(JOIN untried _ folder)
    silt_try_together(all ${folder} ${untried})
  endif()
  if(NOT all)
    silt_try_together(possible nothing)
    if(NOT possible)  # the compiler or its flags are at fault: nothing can be tried
      set(all TRUE)
    endif()
  endif()
  foreach(name IN LISTS untried)
    set(works ${all})
    if(NOT all AND number GREATER 1)
      get_property(needs GLOBAL PROPERTY SILT_${name}_NEEDS)
      silt_try_together(works ${name} ${needs} ${name})
    endif()
    set(state "was not found")
    if(NOT works)
      set(state "does not work, see ${CMAKE_BINARY_DIR}/silt_packages/${name}/log.txt")
    endif()
    set_property(GLOBAL PROPERTY SILT_${name}_STATE "${state}")
  endforeach()

  set(usable "")
  foreach(name IN LISTS needed)
    get_property(state GLOBAL PROPERTY SILT_${name}_STATE)
    if(NOT state MATCHES "^does not work")
      list(APPEND usable ${name})
    endif()
  endforeach()
  set(silt_usable "${usable}" PARENT_SCOPE)
endfunction()

# silt_try_together(RESULT FOLDER NAME …): whether a project that looks for these packages can be
# configured, and a program be built with those that are found, by the compiler and with the settings of
# this project. That project is kept, so that the next configuration only brings it up to date.
function(silt_try_together result folder)
  set(kept SILT_FOUND_${folder})
  set(folder "${CMAKE_BINARY_DIR}/silt_packages/${folder}")
  if(NOT DEFINED ${kept})
    file(REMOVE_RECURSE "${folder}")
  endif()

  set(searches "")
  foreach(name IN LISTS ARGN)
    foreach(part IN ITEMS FIND TARGETS HEADER USES)
      get_property(${part} GLOBAL PROPERTY SILT_${name}_${part})
    endforeach()
    list(JOIN FIND " " find)
    list(JOIN TARGETS " AND TARGET " targets)
    list(JOIN TARGETS " " libraries)
    string(APPEND searches "find_package(${name} ${find} QUIET)
if(${name}_FOUND AND TARGET ${targets})
  list(APPEND found ${name})\n")
    if(HEADER)
      set(include "#if !__has_include(<${HEADER}>)\n#error\n#endif")
      if(USES)
        set(include "#include <${HEADER}>")
      endif()
      file(CONFIGURE OUTPUT "${folder}/${name}.cpp" @ONLY CONTENT
        "${include}\nvoid with_${name}() { ${USES}; }\n")
      string(APPEND searches "  target_sources(trial PRIVATE ${name}.cpp)
  target_link_libraries(trial PRIVATE ${libraries})\n")
    endif()
    string(APPEND searches "endif()\n")
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/main.cpp" @ONLY CONTENT "int main() {}\n")
  get_property(modules GLOBAL PROPERTY SILT_FIND_FOLDER)
  file(CONFIGURE OUTPUT "${folder}/CMakeLists.txt" @ONLY CONTENT [[
cmake_minimum_required(VERSION 3.24)
include(settings.cmake)
set(CMAKE_PLATFORM_INFO_INITIALIZED TRUE)  # what is known of the compiler has been copied
project(trial LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
add_executable(trial main.cpp)
target_compile_options(trial PRIVATE -w -DOMPI_SKIP_MPICXX)  # MPI's own C++ takes long to compile
list(PREPEND CMAKE_MODULE_PATH "@modules@")
set(found "")
@searches@
# What need not be searched for again.
set(results "set(found \"${found}\")\n")
get_cmake_property(names CACHE_VARIABLES)
list(REMOVE_ITEM names ${settings})
list(FILTER names EXCLUDE REGEX "^(CMAKE|trial)_")
foreach(name IN LISTS names)
  get_property(type CACHE ${name} PROPERTY TYPE)
  string(APPEND results "set(${name} [==[$CACHE{${name}}]==] CACHE ${type} [==[]==])\n")
endforeach()
file(WRITE ${CMAKE_BINARY_DIR}/results.cmake "${results}")
]])
  silt_write_settings("${folder}" ${ARGN})
  file(COPY "${CMAKE_BINARY_DIR}/CMakeFiles/${CMAKE_VERSION}" DESTINATION "${folder}/build/CMakeFiles")

  set(configure -G "${CMAKE_GENERATOR}" -S . -B build)
  set(build --build build --parallel 4)
  set(steps configure build)
  if(DEFINED ${kept} AND "${${kept}}" STREQUAL "${ARGN}")
    set(steps build)  # which configures again if a file has changed
  endif()
  set(log "")
  foreach(step IN LISTS steps)
    execute_process(COMMAND "${CMAKE_COMMAND}" ${${step}} WORKING_DIRECTORY "${folder}"
      OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE code)
    string(APPEND log "${output}")
    file(WRITE "${folder}/log.txt" "${log}")
    if(NOT code EQUAL 0)
      unset(${kept} CACHE)
      set(${result} FALSE PARENT_SCOPE)
      return()
    endif()
  endforeach()
  include("${folder}/build/results.cmake")
  set(${kept} "${found}" CACHE INTERNAL "Packages with which programs were built")
  set(${result} TRUE PARENT_SCOPE)
endfunction()

# silt_write_settings(FOLDER NAME …): writes the settings of this project, without those that are results
# of the other one; of the variables that are not in the cache, those that guide the search for these
# packages.
function(silt_write_settings folder)
  list(JOIN ARGN "|" packages)
  string(TOUPPER "${packages}" in_capitals)
  set(guides "^CMAKE_((PREFIX|MODULE|INCLUDE|LIBRARY|PROGRAM|FIND_ROOT)_PATH$|DISABLE_FIND_PACKAGE_)")
  if(packages)
    string(APPEND guides "|^(SILT_)?(${packages}|${in_capitals})_")
  endif()
  set(others "^CMAKE_CXX_(CLANG_TIDY|CPPCHECK|CPPLINT|INCLUDE_WHAT_YOU_USE)$|^CMAKE_PROJECT_|_FOUND$")
  set(results "")
  if(EXISTS "${folder}/build/results.cmake")
    file(READ "${folder}/build/results.cmake" results)
  endif()
  set(lines "")
  set(settings "")
  get_cmake_property(names VARIABLES)
  list(REMOVE_DUPLICATES names)
  foreach(name IN LISTS names)
    get_property(type CACHE ${name} PROPERTY TYPE)
    set(line "set(${name} [==[${${name}}]==] CACHE ")
    string(FIND "${results}" "${line}" at)
    if(at EQUAL -1 AND NOT name MATCHES "${others}" AND NOT type MATCHES "INTERNAL|STATIC"
        AND (name MATCHES "${guides}" OR (type AND NOT name MATCHES "^SILT_")))
      list(APPEND settings ${name})
      string(APPEND lines "${line}STRING [==[]==] FORCE)\n")
    endif()
  endforeach()
  file(WRITE "${folder}/settings.new" "${lines}set(settings ${settings})\n")
  file(COPY_FILE "${folder}/settings.new" "${folder}/settings.cmake" ONLY_IF_DIFFERENT)
endfunction()

# silt_message_once(KIND KEY TEXT): prints TEXT only once, even if find_package(silt) is called twice,
# and not for find_package(silt QUIET).
function(silt_message_once kind key text)
  get_property(printed GLOBAL PROPERTY SILT_PRINTED_${key})
  if(NOT printed AND NOT silt_FIND_QUIETLY)
    set_property(GLOBAL PROPERTY SILT_PRINTED_${key} TRUE)
    message(${kind} "Silt: ${text}")
  endif()
endfunction()
