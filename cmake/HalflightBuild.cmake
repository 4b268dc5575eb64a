# Build rules that every folder shares: warnings, sanitizers, ccache, modules, shaders and tests.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

find_package(Threads REQUIRED)

add_library(hl_options INTERFACE)
target_compile_options(hl_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                                            -Wconversion -Wno-sign-conversion -Werror)
target_compile_definitions(hl_options INTERFACE GLM_FORCE_DEPTH_ZERO_TO_ONE GLM_FORCE_EXPLICIT_CTOR GLM_FORCE_XYZW_ONLY
                                                VK_NO_PROTOTYPES)
# Made now: ccache names a folder that is not there yet differently, and would find nothing of a fresh clone's again.
file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/generated")
target_include_directories(hl_options INTERFACE "${CMAKE_SOURCE_DIR}" "${CMAKE_BINARY_DIR}/generated")
target_link_libraries(hl_options INTERFACE Threads::Threads)
# A program loads the libraries that it uses, not those that it could use.
target_link_options(hl_options INTERFACE -Wl,--as-needed)
if(HALFLIGHT_SANITIZE)
  target_compile_options(hl_options INTERFACE "-fsanitize=${HALFLIGHT_SANITIZE}" -fno-omit-frame-pointer -g1
                                              -fno-sanitize-recover=undefined)
  # Sanitizers make GCC see paths that are not there.
  target_compile_options(hl_options INTERFACE -Wno-maybe-uninitialized)
  target_link_options(hl_options INTERFACE "-fsanitize=${HALFLIGHT_SANITIZE}")
  # One ctest run may hold the tests of several builds.
  string(REGEX REPLACE "^(.).*" "\\1san_" HALFLIGHT_TEST_PREFIX "${HALFLIGHT_SANITIZE}")
endif()

# hl_module(core SOURCES a.cpp b.cpp DEPS fmt::fmt PRIVATE_DEPS ...): a static library hl_core.
function(hl_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(hl_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(hl_${name} PUBLIC hl_options ${ARG_DEPS} PRIVATE ${ARG_PRIVATE_DEPS})
endfunction()

# hl_program(halflight-cli): an executable that may come to load the import module, which nothing links.
function(hl_program target)
  add_dependencies(${target} hl_import)
endfunction()

# hl_test(unit/metrics_test.cpp LABELS unit DEPS hl_metrics [TIMEOUT 300] [ALONE]): one executable and one ctest entry. ALONE: it measures how soon
# something happens, and no other test runs beside it.
# Under the thread sanitizer only tests with the label `threads` or `session` are built and run: those are about threads of ours. Under the address
# sanitizer all but those with the label `statistics`: they take the same paths many million times, which others take too.
function(hl_test source)
  cmake_parse_arguments(ARG "ALONE" "TIMEOUT" "LABELS;DEPS" ${ARGN})
  string(REGEX REPLACE "[/\\.]" "_" target "${source}")
  string(REGEX REPLACE "_cpp$" "" target "${target}")
  add_executable(${target} ${source})
  hl_program(${target})
  target_link_libraries(${target} PRIVATE ${ARG_DEPS} GTest::gtest GTest::gtest_main)
  if(HALFLIGHT_SANITIZE MATCHES "address" AND "statistics" IN_LIST ARG_LABELS)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    return()
  endif()
  if(HALFLIGHT_SANITIZE STREQUAL "thread" AND NOT "threads" IN_LIST ARG_LABELS AND NOT "session" IN_LIST ARG_LABELS)
    set_target_properties(${target} PROPERTIES EXCLUDE_FROM_ALL TRUE)
    return()
  endif()
  add_test(NAME ${HALFLIGHT_TEST_PREFIX}${target} COMMAND ${target})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(HALFLIGHT_SANITIZE)
    math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}")
  endif()
  set_tests_properties(${HALFLIGHT_TEST_PREFIX}${target} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT}
    RUN_SERIAL ${ARG_ALONE})
endfunction()
