#!/usr/bin/env bash
# Sets up, builds and opens the workbench on its default preset. Without a display it runs that preset headless and prints
# its speed and error.
#   bash app/run.sh [--headless] [PRESET|SCENE|SCREENSHOT]
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
experiment="${1:-$halflight_root/presets/cornell_radiosity.json}"

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
  exec "$build/app/halflight-cli" render "$experiment"
else
  exec "$build/ui/halflight" "$experiment"
fi
