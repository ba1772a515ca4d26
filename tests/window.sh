#!/usr/bin/env bash
# Opens a real window on a screen that nobody sees, drags, resizes, closes it, and opens it again on another model.
# tests/window.sh [PROGRAM [SCREENSHOT]]: by default target/release/translume and out/window.png. Prints how many pictures came a second.
set -euo pipefail
program=$(realpath "${1:-target/release/translume}")
screenshot=${2:-out/window.png}
patience=${TRANSLUME_PATIENCE:-120}

missing=()
for tool in Xvfb xdotool import; do command -v "$tool" >/dev/null || missing+=("$tool"); done
if [ ${#missing[@]} -gt 0 ]; then
    echo "Missing: ${missing[*]}; on Debian or Ubuntu: apt-get install xvfb xdotool imagemagick" >&2
    exit 1
fi

mkdir -p "$(dirname "$screenshot")"
work=$(mktemp -d)
window=
fail() {
    echo "$1" >&2
    cat "$work"/*.log >&2 2>/dev/null || true
    exit 1
}
finish() {
    if [ -n "$window" ]; then kill "$window" 2>/dev/null || true; fi
    kill "$screen" 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$work"
}

Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp 3>"$work/display" 2>"$work/xvfb.txt" &
screen=$!
trap finish EXIT
for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
DISPLAY=:$(cat "$work/display")
HOME=$work/home
XDG_RUNTIME_DIR=$work/run
mkdir -m 700 -p "$HOME" "$XDG_RUNTIME_DIR"
export DISPLAY HOME XDG_RUNTIME_DIR
unset WAYLAND_DISPLAY

# Waits until a command succeeds.
await() {
    local what=$1
    shift
    for _ in $(seq $((patience * 5))); do
        if "$@" >/dev/null 2>&1; then return; fi
        kill -0 "$window" 2>/dev/null || fail "the window has closed before: $what"
        sleep 0.2
    done
    fail "$what has not come in $patience s"
}

# Starts the program and waits for its first picture.
start() {
    log=$work/$1.log
    shift
    RUST_LOG=translume_demo=info "$program" "$@" >"$log" 2>&1 &
    window=$!
    await "a window" xdotool search --onlyvisible --name '^Translume$'
    id=$(xdotool search --onlyvisible --name '^Translume$' | head -n 1)
    await "a picture" grep -q "first picture" "$log"
    sleep 2
}

# Quits by the keyboard, and looks at how it went.
stop() {
    xdotool windowfocus --sync "$id" key ctrl+q
    for _ in $(seq $((patience * 5))); do kill -0 "$window" 2>/dev/null || break; sleep 0.2; done
    if kill -0 "$window" 2>/dev/null; then fail "the window does not close"; fi
    local status=0
    wait "$window" || status=$?
    window=
    [ "$status" = 0 ] || fail "the program ended with $status"
    if grep -qi "panic" "$log"; then fail "something panicked"; fi
    grep -o "[0-9]* pictures in .*" "$log" || fail "no word of pictures"
}

colours() { convert "$1" -format %k info:; }

start first
xdotool mousemove --window "$id" 640 400 mousedown 1
for step in $(seq 10); do xdotool mousemove_relative -- 12 4; sleep 0.05; done
xdotool mouseup 1
xdotool windowsize "$id" 1100 700
sleep 2
[ "$(xdotool getwindowgeometry --shell "$id" | grep WIDTH)" = WIDTH=1100 ] || fail "the window keeps its size"
import -window "$id" "$work/first.png"
stop

start second view torus-knot
import -window "$id" "$screenshot"
stop

# A window that shows nothing has some dozens of colours.
for image in "$work/first.png" "$screenshot"; do
    [ "$(colours "$image")" -gt 1000 ] || fail "$image shows hardly anything"
done
if cmp -s "$work/first.png" "$screenshot"; then fail "both windows look the same"; fi
cp "$work/first.png" "${screenshot%.png}-first.png"
echo "$screenshot and ${screenshot%.png}-first.png are written"
