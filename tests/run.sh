#!/usr/bin/env bash
# Sets up, builds and runs every test: the release build with Vulkan validation, then the engine and command-line tests under
# the address and undefined-behaviour sanitizers, then the threaded ones under the thread sanitizer. One ctest run covers them.
#   bash tests/run.sh [release|asan|tsan]... [-- CTEST-OPTION...]      all three where none is named
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../app/setup.sh"

builds=()
while [ $# -gt 0 ]; do
  case "$1" in
    release | asan | tsan) builds+=("$1") ;;
    --) shift; break ;;
    *) halflight_say "usage: bash tests/run.sh [release|asan|tsan]... [-- CTEST-OPTION...]"; exit 2 ;;
  esac
  shift
done
[ ${#builds[@]} -gt 0 ] || builds=(release asan tsan)

halflight_install "${halflight_build_packages[@]}" "${halflight_test_packages[@]}"

all="$halflight_root/build/tests"
mkdir -p "$all"
: >"$all/CTestTestfile.cmake"
for build in "${builds[@]}"; do
  started=$SECONDS
  halflight_configure "$build" -DHALFLIGHT_BUILD_TESTS=ON
  cmake --build "$halflight_root/build/$build" -j "$halflight_jobs"
  halflight_say "built $build in $((SECONDS - started)) s"
  echo "subdirs(\"$halflight_root/build/$build\")" >>"$all/CTestTestfile.cmake"
done

# No test reads what a person's own runs left, nor what the last run of the tests did.
export HALFLIGHT_CACHE="$all/cache"
rm -rf "$HALFLIGHT_CACHE"
unset HALFLIGHT_HOME HALFLIGHT_SHADERS HALFLIGHT_IMPORT_MODULE
export QT_QPA_PLATFORM="${QT_QPA_PLATFORM:-offscreen}"
source "$halflight_root/tests/sanitizer_options.sh"

# Two at a time keep both cores of a small machine busy; more would fight over the software renderer's threads.
ctest --test-dir "$all" --output-on-failure -j "${HALFLIGHT_TEST_JOBS:-2}" "$@"
