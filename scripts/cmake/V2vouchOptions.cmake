# Language level, warnings, sanitizers and determinism flags, as one interface target that every
# room links. Nothing is set directory-wide but the output folder and the standard.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")

option(V2VOUCH_WERROR "Treat warnings as errors" ON)
set(V2VOUCH_SANITIZE "" CACHE STRING "Value for -fsanitize=, empty for none")
option(V2VOUCH_COVERAGE "Instrument for gcov" OFF)

find_program(V2VOUCH_CCACHE ccache)
if(V2VOUCH_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${V2VOUCH_CCACHE}")
endif()

add_library(v2vouch_options INTERFACE)
target_compile_options(v2vouch_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 cries wolf in std::string (its bug 105651).
  -ffp-contract=off  # Bit-equal results whatever the optimiser would like to fuse.
  $<$<BOOL:${V2VOUCH_WERROR}>:-Werror>)
target_compile_definitions(v2vouch_options INTERFACE
  V2VOUCH_VERSION="${PROJECT_VERSION}")
target_include_directories(v2vouch_options INTERFACE "${PROJECT_SOURCE_DIR}")
if(V2VOUCH_SANITIZE)
  target_compile_options(v2vouch_options INTERFACE
    -fsanitize=${V2VOUCH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    -O1 -g1)  # Instrumented code at -O2 takes much longer to compile and finds no more.
  target_link_options(v2vouch_options INTERFACE -fsanitize=${V2VOUCH_SANITIZE})
  # GCC's value-range warnings misfire in instrumented code.
  target_compile_options(v2vouch_options INTERFACE -Wno-maybe-uninitialized)
endif()
if(V2VOUCH_COVERAGE)
  target_compile_options(v2vouch_options INTERFACE --coverage)
  target_link_options(v2vouch_options INTERFACE --coverage)
endif()
