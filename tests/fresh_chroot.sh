#!/usr/bin/env bash
# Do the two commands of the README work on a Debian 12 that has nothing? Makes one with debootstrap, clones the last commit into
# it and runs both commands there, twice. Needs root, debootstrap and 12 GB. Takes as long as a cold build and all tests.
#   bash tests/fresh_chroot.sh [--mirror URL] [--ccache FOLDER] [--app-only] [FOLDER]
# FOLDER (a fresh one under /tmp unless given) is left behind; an existing one is used again, packages and all.
# Without --mirror it is the one that this machine's apt has for bookworm. --ccache lends a compiler cache: that checks packages and
# scripts in less time, but is not a cold build. HALFLIGHT_SCENES is passed on where it is set.
set -euo pipefail

if [ "${HALFLIGHT_IN_NAMESPACE:-}" != 1 ]; then
  # Mounts go with the namespace, however this ends.
  HALFLIGHT_IN_NAMESPACE=1 exec unshare --mount bash "${BASH_SOURCE[0]}" "$@"
fi

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
mirror="" cache="" folder="" app_only=false
while [ $# -gt 0 ]; do
  case "$1" in
    --mirror) mirror="$2"; shift ;;
    --ccache) cache="$2"; shift ;;
    --app-only) app_only=true ;;
    *) folder="$1" ;;
  esac
  shift
done
if [ -z "$mirror" ]; then
  mirror="$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(COMPONENT) $(SITE)' \
    | sed -n 's/^Debian bookworm main //p' | head -n 1)"
fi
[ -n "$mirror" ] || { echo "no mirror for bookworm is configured here: give one with --mirror" >&2; exit 2; }
folder="${folder:-$(mktemp -d /tmp/halflight-fresh-XXXXXX)}"

timed() {
  local started=$SECONDS name="$1"
  shift
  "$@" || { echo "FAILED: $name after $((SECONDS - started)) s" >&2; exit 1; }
  echo "$name: $((SECONDS - started)) s"
}

if [ ! -x "$folder/usr/bin/apt-get" ]; then
  timed "debootstrap" debootstrap --variant=minbase bookworm "$folder" "$mirror" >&2
fi
cp /etc/resolv.conf "$folder/etc/resolv.conf"
mount -t proc proc "$folder/proc"
mount --rbind /dev "$folder/dev"

# The clone has the original's path, so that a lent compiler cache finds what it knows.
rm -rf "${folder:?}$root"
mkdir -p "$folder$(dirname "$root")"
git clone -q --no-hardlinks "$root" "$folder$root"
echo "commit $(git -C "$root" rev-parse --short=12 HEAD)"

environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM=dumb)
lend() {  # FOLDER: the same folder inside
  mkdir -p "$folder$1"
  mount --bind "$1" "$folder$1"
}
if [ -n "${HALFLIGHT_SCENES:-}" ]; then
  lend "$HALFLIGHT_SCENES"
  environment+=(HALFLIGHT_SCENES="$HALFLIGHT_SCENES")
fi
if [ -n "$cache" ]; then
  lend "$cache"
  environment+=(CCACHE_DIR="$cache")
fi

inside() { chroot "$folder" env -i "${environment[@]}" bash -c "cd '$root' && exec bash $*" </dev/null; }
timed "app/run.sh, first time" inside app/run.sh
timed "app/run.sh, again" inside app/run.sh
$app_only && exit 0
timed "tests/run.sh, first time" inside tests/run.sh
timed "tests/run.sh, again" inside tests/run.sh
