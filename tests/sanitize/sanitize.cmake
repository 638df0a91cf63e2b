# SPDX-License-Identifier: MIT
# Included by tests/CMakeLists.txt if the flags have a sanitizer: planted faults, which it must find.

add_executable(planted_fault sanitize/planted_fault.cpp)
target_link_libraries(planted_fault PRIVATE silt_program)

function(silt_must_find fault report)
  add_test(NAME sanitizer.finds.${fault} COMMAND planted_fault ${fault})
  set_tests_properties(sanitizer.finds.${fault} PROPERTIES
    PASS_REGULAR_EXPRESSION "${report}" ENVIRONMENT OMP_NUM_THREADS=2)
endfunction()

if(sanitizers MATCHES "address")
  silt_must_find(read_beyond_the_end "AddressSanitizer: heap-buffer-overflow")
  silt_must_find(read_freed_memory "AddressSanitizer: heap-use-after-free")
  silt_must_find(lose_memory "LeakSanitizer: detected memory leaks")
endif()
if(sanitizers MATCHES "undefined")
  silt_must_find(overflow "signed integer overflow")
  silt_must_find(load_neither_true_nor_false "not a valid value for type 'bool'")
endif()
if(sanitizers MATCHES "float-cast-overflow")
  silt_must_find(convert_beyond_the_range "outside the range of representable values")
endif()
if(sanitizers MATCHES "thread")
  silt_must_find(add_from_two_threads "ThreadSanitizer: data race")
endif()
