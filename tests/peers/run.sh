#!/bin/bash
# Ours, Cycles and (where its Python is given) Mitsuba on one scene, seed by seed in turn, then the comparison. See README.md.
#   run.sh SCENE CAMERA WIDTH HEIGHT GRID SPP PEER_SPP SEEDS OUT [compare.py's --region ...]
# PEER_SCENE: the built program (build/release/tests/peer_scene). BLENDER: blender. MITSUBA_PYTHON: a Python that has mitsuba.
set -euo pipefail
if [ $# -lt 9 ]; then sed -n 2,4p "$0" >&2; exit 2; fi
scene=$1 camera=$2 width=$3 height=$4 grid=$5 spp=$6 peer_spp=$7 seeds=$8 out=$9
shift 9
here=$(cd "$(dirname "$0")" && pwd)
program=${PEER_SCENE:-$here/../../build/release/tests/peer_scene}
mkdir -p "$out"
"$program" export "$scene" "$camera" "$out"
for seed in $(seq "$seeds"); do
  nice -n 19 "$program" render "$scene" "$camera" "$width" "$height" "$grid" "$spp" "$seed" "$out"
  nice -n 19 "${BLENDER:-blender}" -b --factory-startup --python-exit-code 1 --python "$here/cycles_scene.py" -- \
    "$out" "$out" "$width" "$height" "$peer_spp" "$seed" >"$out/blender.log" 2>&1 || { cat "$out/blender.log" >&2; exit 1; }
  if [ -n "${MITSUBA_PYTHON:-}" ]; then
    nice -n 19 "$MITSUBA_PYTHON" "$here/mitsuba_scene.py" "$out" "$out" "$width" "$height" "$peer_spp" "$seed"
  fi
done
status=0
/usr/bin/python3 "$here/compare.py" "$out" cycles "$@" || status=1
if [ -n "${MITSUBA_PYTHON:-}" ]; then /usr/bin/python3 "$here/compare.py" "$out" mitsuba "$@" || status=1; fi
exit $status
