#!/usr/bin/env bash
# What runs on a machine without Halflight's libraries: halflight-cli, the libraries that it needs, shaders, presets, scenes (those over meshes as
# bundles), in one compressed archive. x86-64 Linux with a glibc no older than the one of the machine that built it.
#   bash app/portable.sh OUT.tar.xz [--validation] [--tests] [--scene NAME]... [FILE...]
# --validation  the validation layer travels too
# --tests       so do the tests that are about the device (labels gpu and parity), and `run-tests`
# --scene NAME  of the scenes over meshes from elsewhere only these (may be repeated); without it, all whose meshes are here
# FILE...       presets, experiments or bundles, put beside the program
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

out="" validation=false tests=false scenes=() files=()
while [ $# -gt 0 ]; do
  case "$1" in
    --validation) validation=true ;;
    --tests) tests=true ;;
    --scene) scenes+=("${2:?--scene takes a name}"); shift ;;
    -*) halflight_say "unknown option $1"; exit 2 ;;
    *) if [ -z "$out" ]; then out="$1"; else files+=("$1"); fi ;;
  esac
  shift
done
if [[ "$out" != *.tar.xz ]]; then halflight_say "portable.sh OUT.tar.xz [--validation] [--tests] [--scene NAME]... [FILE...]"; exit 2; fi

halflight_install "${halflight_build_packages[@]}" xz-utils
if $validation; then halflight_install vulkan-validationlayers; fi
mkdir -p "$halflight_root/build"
build="$halflight_root/build/release"
if $tests; then
  halflight_install "${halflight_test_packages[@]}"
  halflight_configure release -DHALFLIGHT_BUILD_TESTS=ON
elif [ ! -f "$build/CMakeCache.txt" ]; then
  halflight_configure release -DHALFLIGHT_BUILD_TESTS=OFF
fi
targets=(halflight-cli)
if $tests; then
  while read -r target; do targets+=("$target"); done < <(ctest --test-dir "$build" -N -L 'gpu|parity' | sed -n 's/^ *Test *#[0-9]*: *//p')
  if [ ${#targets[@]} -lt 2 ]; then halflight_say "no tests of the device were found in $build"; exit 1; fi
fi
halflight_say "building ${#targets[@]} programs"
cmake --build "$build" --target "${targets[@]}" -j "$halflight_jobs" >&2

stage="$(mktemp -d)"
trap 'rm -rf "$stage"' EXIT
root="$stage/halflight"
mkdir -p "$root"/{bin,lib,fallback,scenes,presets}
install -s "$build/app/halflight-cli" "$root/bin/"
if $tests; then for test in "${targets[@]:1}"; do install -s "$build/tests/$test" "$root/bin/"; done; fi

# glibc's own libraries are the machine's. Those of the compiler and the Vulkan loader too, where it has them and they are new enough.
for library in $(ldd "$root"/bin/* | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p' | sort -u); do
  case "$(basename "$library")" in
    libc.so.*|libm.so.*|libpthread.so.*|libdl.so.*|librt.so.*) ;;
    libstdc++.so.*|libgcc_s.so.*) cp -L "$library" "$root/fallback/" ;;
    *) cp -L "$library" "$root/lib/" ;;
  esac
done
mkdir -p "$root/loader"
loader="$(ldconfig -p | sed -n 's/.*libvulkan\.so\.1 .*x86-64.*=> //p' | head -n 1)"
if [ -n "$loader" ]; then cp -L "$loader" "$root/loader/"; fi
if $validation; then
  mkdir -p "$root/layers"
  manifest=/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json
  layer="$(sed -n 's/.*"library_path": *"\([^"]*\)".*/\1/p' "$manifest")"
  cp -L "$(ldconfig -p | sed -n "s#.*$(basename "$layer") .*=> ##p" | head -n 1)" "$root/layers/" 2>/dev/null || cp -L "/usr/lib/x86_64-linux-gnu/$(basename "$layer")" "$root/layers/"
  sed "s#\"library_path\": *\"[^\"]*\"#\"library_path\": \"./$(basename "$layer")\"#" "$manifest" >"$root/layers/$(basename "$manifest")"
fi

cp -r "$build/shaders" "$root/spirv"
find "$root/spirv" -type f ! -name '*.spv' -delete
find "$root/spirv" -depth -type d -name 'CMakeFiles' -exec rm -rf {} +
cp -r "$halflight_root/presets/." "$root/presets/"
if $tests; then  # sources that tests compile or read
  (cd "$halflight_root" && find shaders engine/params engine/techniques tests/shaders tests/data \( -name '*.glsl' -o -name '*.h' -o -name '*.inl' -o -name '*.comp' \
     -o -name '*.vert' -o -name '*.frag' -o -name '*.rgen' -o -name '*.rchit' -o -name '*.rmiss' -o -name '*.rahit' -o -path 'tests/data/*' \) -type f -print0 | tar --null -T - -cf -) | tar -xf - -C "$root"
else
  mkdir -p "$root/shaders"  # by which the folder is known as the program's own
fi
for scene in "$halflight_root"/scenes/*.json; do
  name="$(basename "$scene" .json)"
  mesh="$(tr -d '\n' <"$scene" | sed -n 's/.*"mesh": *{[^}]*"file": *"\([^"]*\)".*/\1/p')"
  if ! grep -q '"mesh"' "$scene"; then cp "$scene" "$root/scenes/"; continue; fi
  # The project's own meshes always travel.
  if [ ! -f "$halflight_root/scenes/$mesh" ] && [ ${#scenes[@]} -gt 0 ] && ! printf '%s\n' "${scenes[@]}" | grep -qxF -- "$name"; then continue; fi
  if ! "$build/app/halflight-cli" pack "$name" --out "$root/scenes/$name.hlb" >/dev/null 2>"$stage/why"; then
    if [ ${#scenes[@]} -gt 0 ]; then cat "$stage/why" >&2; exit 2; fi
    halflight_say "left out: $(cat "$stage/why")"
  fi
done
for file in ${files[@]+"${files[@]}"}; do cp "$file" "$root/"; done

cat >"$root/environment" <<'W'
# Sourced. `here` is this folder.
export HALFLIGHT_HOME="$here" HALFLIGHT_SHADERS="$here/spirv"
export LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
if ! "$here/bin/halflight-cli" --version >/dev/null 2>&1; then LD_LIBRARY_PATH="$here/fallback:$LD_LIBRARY_PATH"; fi
if ! ldconfig -p 2>/dev/null | grep -q libvulkan.so.1; then LD_LIBRARY_PATH="$LD_LIBRARY_PATH:$here/loader"; fi
if [ -d "$here/layers" ]; then export VK_LAYER_PATH="$here/layers${VK_LAYER_PATH:+:$VK_LAYER_PATH}"; fi
W
cat >"$root/halflight-cli" <<'W'
#!/bin/sh
here="$(cd "$(dirname "$0")" && pwd)"
. "$here/environment"
exec "$here/bin/halflight-cli" "$@"
W
chmod +x "$root/halflight-cli"
if $tests; then
  cat >"$root/run-tests" <<'W'
#!/bin/sh
# Every test, one line each, the whole output of those that fail; ends with the number of failures, which is the exit code.
here="$(cd "$(dirname "$0")" && pwd)"
. "$here/environment"
export HALFLIGHT_SCENES="${HALFLIGHT_SCENES:-$here/scenes}"
failed=0
for test in "$here"/bin/*_test; do
  if "$test" >"/tmp/halflight-test.$$" 2>&1; then
    echo "passed $(basename "$test") $(grep -c '^\[       OK' "/tmp/halflight-test.$$") cases, $(grep -c '^\[  SKIPPED' "/tmp/halflight-test.$$") skipped lines"
    grep -A 3 -i 'skipped' "/tmp/halflight-test.$$" | grep -v '^\[' | head -n 4
  else
    failed=$((failed + 1)); echo "FAILED $(basename "$test")"; tail -n "${HALFLIGHT_TEST_LINES:-60}" "/tmp/halflight-test.$$"
  fi
done
echo "$failed failed"
exit $failed
W
  chmod +x "$root/run-tests"
fi

mkdir -p "$(dirname "$out")"
tar -C "$stage" -cf - halflight | xz -T "$halflight_jobs" >"$out.partial"
mv "$out.partial" "$out"
halflight_say "$out: $(du -h "$out" | cut -f 1), unpacked $(du -sh "$root" | cut -f 1); glibc $(ldd --version | sed -n '1s/.* //p') or newer"
