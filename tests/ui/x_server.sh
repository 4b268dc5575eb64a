#!/usr/bin/env bash
# Runs a command on an X server of its own, which ends with it: tests/ui/x_server.sh COMMAND...
set -euo pipefail
command -v Xvfb >/dev/null || { echo "Xvfb is not installed: apt-get install xvfb" >&2; exit 1; }
folder="$(mktemp -d)"
# The server chooses a display that is free, and writes its number once it takes connections.
mkfifo "$folder/display"
Xvfb -displayfd 3 -screen 0 1600x1000x24 -nolisten tcp -noreset 3>"$folder/display" 2>"$folder/log" &
server=$!
trap 'kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; rm -rf "$folder"' EXIT
if ! read -r -t 60 number <"$folder/display"; then
  cat "$folder/log" >&2
  echo "Xvfb did not start" >&2
  exit 1
fi
DISPLAY=":$number" QT_QPA_PLATFORM=xcb "$@"
