# v2vouch_add_room(NAME [SOURCES file...] [PUBLIC lib...] [PRIVATE lib...])
# One folder, one static library `v2vouch::NAME` (header-only where SOURCES is empty).
function(v2vouch_add_room name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target "v2vouch_${name}")
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    target_link_libraries(${target} PUBLIC v2vouch_options ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  else()
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE v2vouch_options ${ARG_PUBLIC})
  endif()
  add_library(v2vouch::${name} ALIAS ${target})
endfunction()

# v2vouch_add_program(NAME SOURCES file... LINK lib...)
function(v2vouch_add_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE v2vouch_options ${ARG_LINK})
endfunction()

# v2vouch_add_test(NAME SOURCES file... LINK lib... [LABELS label...] [TIMEOUT s])
# One GoogleTest executable, run by ctest as one entry.
function(v2vouch_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/tests")
  target_link_libraries(${name} PRIVATE v2vouch_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
    if(V2VOUCH_SANITIZE)  # Ten times slower, at worst.
      set(ARG_TIMEOUT 1500)
    endif()
  endif()
  v2vouch_is_sanitized(is_sanitized)
  if(is_sanitized)
    list(APPEND ARG_LABELS sanitized)
    add_dependencies(v2vouch_sanitized_tests ${name})
  endif()
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()

# Tests that scripts/test runs once more under the sanitizers: the rooms through which foreign bytes
# come in, and those that index by them. Building everything instrumented takes too long for that.
set(V2VOUCH_SANITIZED_ROOMS
  daemon/common/base daemon/common/assignment daemon/rim/config daemon/detector daemon/rim/io daemon/obu daemon/local/radar daemon/local/camera
  daemon/v2v/intake daemon/rim/wire sim/import fuzz)
if(NOT TARGET v2vouch_sanitized_tests)
  add_custom_target(v2vouch_sanitized_tests)
endif()

# Sets `out` to whether the current folder belongs to V2VOUCH_SANITIZED_ROOMS.
function(v2vouch_is_sanitized out)
  file(RELATIVE_PATH folder "${PROJECT_SOURCE_DIR}/tests" "${CMAKE_CURRENT_SOURCE_DIR}")
  set(${out} FALSE PARENT_SCOPE)
  foreach(room ${V2VOUCH_SANITIZED_ROOMS})
    if("${folder}/" MATCHES "^${room}/")
      set(${out} TRUE PARENT_SCOPE)
    endif()
  endforeach()
endfunction()
