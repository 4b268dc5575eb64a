#!/usr/bin/env bash
# Sets up, builds and opens the workbench on its default preset. Without a display it runs that preset headless and prints
# each pass's time and the errors against the reference.
#   bash app/run.sh [--headless] [PRESET|SCENE|SCREENSHOT [OPTION...]]      options as those of halflight or of halflight-cli render
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

headless=false
if [ "${1:-}" = "--headless" ]; then
  headless=true
  shift
elif [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
  halflight_say "no display: running headless"
  headless=true
fi
if [ $# -eq 0 ]; then
  set -- "$halflight_root/presets/cornell_radiosity.json"
  # A quarter of the default paths: a minute or two on a CPU, and kept for the next time. The errors are free of the reference's noise.
  if $headless; then set -- "$@" --metrics relmse,bias --set reference.samples=64; fi
fi

halflight_install "${halflight_build_packages[@]}"
mkdir -p "$halflight_root/build"
build="$halflight_root/build/release"
# The tests share this folder; only they need their packages.
if [ -f "$build/CMakeCache.txt" ]; then
  halflight_configure release
else
  halflight_configure release -DHALFLIGHT_BUILD_TESTS=OFF
fi

program=halflight
if $headless; then program=halflight-cli; fi
halflight_say "building $program"
cmake --build "$build" --target "$program" -j "$halflight_jobs" >&2

if $headless; then
  exec "$build/app/halflight-cli" render "$@"
else
  exec "$build/ui/halflight" "$@"
fi
