# SPDX-License-Identifier: MIT
# silt_add_mpi_test(NAME PROCESSES PROGRAM ...): a test with so many processes on any number of cores.
# More of them than cores must not spin while they wait. MPI itself leaks memory.
function(silt_add_mpi_test name processes program)
  add_test(NAME ${name} COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${processes}
    $<TARGET_FILE:${program}> ${ARGN})
  silt_is_mpi_test(${name} ${processes})
endfunction()
function(silt_is_mpi_test name processes)
  set_tests_properties(${name} PROPERTIES LABELS mpi TIMEOUT 600 PROCESSORS ${processes} ENVIRONMENT
    "OMP_NUM_THREADS=1;OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;\
OMPI_MCA_mpi_yield_when_idle=1;OMPI_MCA_rmaps_base_oversubscribe=1;\
OMPI_MCA_btl_vader_single_copy_mechanism=none;ASAN_OPTIONS=detect_leaks=0")
  if(NOT MPIEXEC_EXECUTABLE)
    set_tests_properties(${name} PROPERTIES DISABLED TRUE)
    silt_message_once(STATUS MPIEXEC
      "mpiexec was not found. Tests of several processes need it (Debian: openmpi-bin)")
  endif()
endfunction()
