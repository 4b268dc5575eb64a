#!/usr/bin/env bash
# Sets up, builds and opens the workbench on its default preset. Without a display it runs the default experiment headless and prints its
# speed-against-error table; of a preset that is named it prints each pass's time and the errors against the reference.
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

if ! $headless; then
  [ $# -gt 0 ] || set -- "$halflight_root/presets/cornell_radiosity.json"
  exec "$build/ui/halflight" "$@"
elif [ $# -gt 0 ]; then
  exec "$build/app/halflight-cli" render "$@"
fi
# A folder for each build: what it measured is kept, so that the second time costs nothing, and never mixed with another's.
results="$build/default_experiment"
mine="$results/$(cksum <"$build/app/halflight-cli" | cut -d ' ' -f 1)"
for other in "$results"/*; do
  if [ -d "$other" ] && [ "$other" != "$mine" ]; then rm -rf -- "$other"; fi
done
exec "$build/app/halflight-cli" bench cornell_radiosity_quick --out "$mine"
