# SPDX-License-Identifier: MIT
# Included by tests/CMakeLists.txt: fuzz targets, which are functions of arbitrary bytes. Silt may
# refuse any input by silt::Error, and by nothing else.
#
# A target is a program that passes its corpus, and a number of random changes of it, to the
# function (replay.cpp). With clang, the slow tests also link it with libFuzzer, whose changes are
# guided by the branches that they reach, and with the sanitizers.

set(fuzz_folder ${CMAKE_CURRENT_SOURCE_DIR}/fuzz)
find_program(SILT_FUZZ_COMPILER NAMES clang++-19 clang++ NO_CACHE)
set(links_fuzzer FALSE)
if(SILT_SLOW_TESTS AND SILT_FUZZ_COMPILER)
  set(program ${CMAKE_CURRENT_BINARY_DIR}/links_fuzzer)
  file(CONFIGURE OUTPUT ${program}.cpp
    CONTENT "extern \"C\" int LLVMFuzzerTestOneInput(const char*, unsigned long) { return 0; }\n")
  execute_process(COMMAND ${SILT_FUZZ_COMPILER} -fsanitize=fuzzer,address,undefined ${program}.cpp
    -o ${program} RESULT_VARIABLE code OUTPUT_QUIET ERROR_QUIET)
  if(code EQUAL 0)
    set(links_fuzzer TRUE)
  else()
    message(STATUS "${SILT_FUZZ_COMPILER} has no libFuzzer: fuzz.*_libfuzzer are skipped")
  endif()
endif()
# In a file that is passed as @file: a list within a list cannot be joined.
set(fuzz_flags ${CMAKE_CURRENT_BINARY_DIR}/libfuzzer.flags)
set(includes "$<TARGET_PROPERTY:silt,INTERFACE_INCLUDE_DIRECTORIES>")
string(JOIN "\n" flags -std=c++20 -O1 -g1 -ffp-contract=off -fno-sanitize-recover=all
  -fsanitize=fuzzer,address,undefined,float-cast-overflow "-I\"$<JOIN:${includes},\"\n-I\">\""
  "-I\"${CMAKE_CURRENT_SOURCE_DIR}\"" "-I\"${PROJECT_SOURCE_DIR}/examples\"")
file(GENERATE OUTPUT ${fuzz_flags} CONTENT "${flags}\n")

# silt_add_fuzz_target(NAME INPUTS): so many random changes without --all, none if 0; with it,
# 100 000, and 20 s of libFuzzer.
function(silt_add_fuzz_target name inputs)
  if(inputs EQUAL 0 AND NOT SILT_SLOW_TESTS)
    return()
  endif()
  set(program fuzz_${name})
  set(corpus ${fuzz_folder}/corpus/${name})
  set(options ${quick_options})
  if(SILT_SLOW_TESTS)
    set(options "")
  endif()
  silt_add_test(${program} "${options}" fuzz/${name}.cpp fuzz/replay.cpp)
  if(inputs GREATER 0)
    add_test(NAME fuzz.${name} COMMAND ${program} ${corpus} ${inputs})
    set_tests_properties(fuzz.${name} PROPERTIES LABELS trust ${environment})
  endif()
  add_test(NAME fuzz.${name}_many COMMAND ${program} ${corpus} 100000)
  set_tests_properties(fuzz.${name}_many PROPERTIES
    LABELS "trust;slow" TIMEOUT 7200 COST 80 ${environment})

  if(links_fuzzer)
    set(binary ${CMAKE_CURRENT_BINARY_DIR}/libfuzzer_${name})
    set(found ${CMAKE_CURRENT_BINARY_DIR}/libfuzzer_${name}_found)
    file(MAKE_DIRECTORY ${found})
    add_test(NAME fuzz.${name}_libfuzzer_build COMMAND ${SILT_FUZZ_COMPILER} @${fuzz_flags}
      ${fuzz_folder}/${name}.cpp $<TARGET_LINKER_FILE:GTest::gtest> -o ${binary})
    add_test(NAME fuzz.${name}_libfuzzer COMMAND ${binary} -max_total_time=20 -timeout=60
      -artifact_prefix=${found}/failed_ -print_final_stats=1 ${found} ${corpus})
    set_tests_properties(fuzz.${name}_libfuzzer_build PROPERTIES
      LABELS "trust;slow" FIXTURES_SETUP libfuzzer_${name} TIMEOUT 1800 COST 200)
    set_tests_properties(fuzz.${name}_libfuzzer PROPERTIES
      LABELS "trust;slow" FIXTURES_REQUIRED libfuzzer_${name} TIMEOUT 1800 COST 20
      ${environment})
  endif()
endfunction()

silt_add_fuzz_target(stl 20000)
silt_add_fuzz_target(csv 20000)
silt_add_fuzz_target(checkpoint 0)
silt_add_fuzz_target(grains 0)
silt_add_fuzz_target(flow 0)

if(CLI11_FOUND AND nlohmann_json_FOUND)
  silt_add_fuzz_target(options 0)
  if(TARGET fuzz_options)
    target_link_libraries(fuzz_options PRIVATE CLI11::CLI11 nlohmann_json::nlohmann_json)
  endif()
else()
  message(STATUS "The fuzz target of options is skipped: CLI11 or nlohmann_json is not usable")
endif()
