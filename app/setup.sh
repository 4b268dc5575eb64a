# Sourced by app/run.sh and tests/run.sh: the packages a Debian 12 needs, and how a build folder is configured.
# Everything here costs next to nothing when it is done already.

halflight_root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

halflight_build_packages=(
  build-essential ccache cmake git ninja-build pkg-config
  glslang-dev glslang-tools spirv-tools libspirv-cross-c-shared-dev libvulkan-dev libvulkan-volk-dev
  libassimp-dev zlib1g-dev libeigen3-dev libembree-dev libglm-dev libopenimageio-dev openimageio-tools libtbb-dev
  libcli11-dev libfmt-dev libspdlog-dev libxxhash-dev libzstd-dev nlohmann-json3-dev
  libqcustomplot-dev qt6-base-dev
  mesa-vulkan-drivers
)
halflight_test_packages=(libgtest-dev vulkan-validationlayers xauth xvfb)

# Objects are found again in another checkout, as long as it says the same.
export CCACHE_BASEDIR="$halflight_root" CCACHE_NOHASHDIR=1

halflight_jobs="${HALFLIGHT_JOBS:-$(nproc)}"

halflight_say() { printf '== %s\n' "$*" >&2; }

# halflight_install PACKAGE...: asks apt for those that are missing, and not at all when none is.
halflight_install() {
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    halflight_say "no apt here: the README lists what has to be installed; going on with what there is"
    return 0
  fi
  local present missing=() package
  present="$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null | sed -n 's/ installed$//p' || true)"
  for package in "$@"; do
    grep -qxF -- "$package" <<<"$present" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      halflight_say "these packages are missing, and neither root nor sudo is here to install them: ${missing[*]}"
      return 1
    fi
    as_root=(sudo)
  fi
  halflight_say "installing ${missing[*]}"
  # A source of someone else's that does not answer is no reason to stop: the installation tells whether it mattered.
  "${as_root[@]}" apt-get update -q || halflight_say "apt-get update failed; trying with the lists there are"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# halflight_configure PRESET [CMAKE-OPTION...]: build/PRESET, through the preset of that name.
halflight_configure() {
  local preset="$1"
  shift
  (cd "$halflight_root" && cmake --preset "$preset" "$@" >"$halflight_root/build/configure-$preset.log" 2>&1) || {
    cat "$halflight_root/build/configure-$preset.log" >&2
    halflight_say "configuring $preset failed"
    return 1
  }
}
