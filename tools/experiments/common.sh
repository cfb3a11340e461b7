# Shared by the experiments; to be sourced: `. tools/experiments/common.sh`. POSIX shell.
# A folder $work goes away at the end, and with it what was started.
# POVSLAM_BIN names a folder with built programs to use in place of building them here.

. "$(dirname "$0")/../setup.sh"
cd "$POVSLAM_ROOT"
export LC_ALL=C

# experiment_start TARGET…: installs and builds what is missing; sets $bin and $work.
experiment_start() {
  bin=${POVSLAM_BIN:-}
  if [ -z "$bin" ]; then
    povslam_install_packages
    povslam_build release "$@" >&2
    bin=$POVSLAM_ROOT/build/release
  fi
  work=$(mktemp -d "${TMPDIR:-/tmp}/povslam-experiment.XXXXXX")
  children=
  trap experiment_end EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
}

experiment_end() {
  # shellcheck disable=SC2086 # one word per process
  [ -z "$children" ] || kill $children 2>/dev/null || true
  rm -rf "$work"
}

# alone_in_a_network "$0" "$@": starts the script once more with multicast of its own, where the system permits it.
alone_in_a_network() {
  [ -z "${POVSLAM_ALONE:-}" ] || return 0
  export POVSLAM_ALONE=yes
  PATH=$PATH:/usr/sbin:/sbin
  for unshare in "unshare --net" "unshare --net --map-root-user"; do
    if $unshare ip link set lo up 2>/dev/null; then
      exec $unshare sh -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
    fi
  done
}

# Of the simulated robot's camera, told to daemon and listener alike.
mount_m="0 0 0.8"
mount_q="-0.5 0.5 -0.5 0.5"

# simulated_daemon KEY=VALUE…: starts povslamd with the simulated camera and the driver's options; sets $daemon.
simulated_daemon() {
  set -- "$@" "translation_m=[$(echo "$mount_m" | tr ' ' ',')]" "q_xyzw=[$(echo "$mount_q" | tr ' ' ',')]"
  arguments="--set sensor.front.driver=synthetic"
  for option; do arguments="$arguments --set sensor.front.$option"; done
  # shellcheck disable=SC2086 # no option has a blank
  ${pinned:-} "$bin/povslamd" --set daemon.exit_at_end=false $arguments ${settings:-} 2>>"$work/daemon.log" &
  daemon=$!
  children="$children $daemon"
}

# start_listener FILE: starts povslam listen, which writes the camera's trajectory to FILE and its words to FILE.log.
start_listener() {
  ${pinned:-} "$bin/povslam" listen --rate 0 --out "$1" --camera "$mount_m $mount_q" >"$1.log" &
  listener=$!
  children="$children $listener"
}

stop_listener() {
  sleep 0.5
  kill -INT "$listener"
  wait "$listener" || povslam_die "the listener failed"
}

# print_frames LISTENED SENT: from the last health message; each frame sent must be tracked, lost, or dropped for a reason.
print_frames() {
  grep '^health:' "$1" | tail -1 | awk -v sent="$2" '
    function number(pattern) { return match($0, pattern) ? substr($0, RSTART, RLENGTH) + 0 : 0 }
    {
      delivered = number("[0-9]+ in "); tracked = number("[0-9]+ tracked"); lost = number("[0-9]+ lost")
      printf "frames sent %d: delivered %d, tracked %d, lost %d", sent, delivered, tracked, lost
      sum = tracked + lost
      count = split("ring_full bad_frame gap late unused", reason)
      for (i = 1; i <= count; i++) {
        dropped = number("[0-9]+ " reason[i])
        sum += dropped
        printf ", %s %d", reason[i], dropped
      }
      printf "\nsum %d: %s\n", sum, sum == sent ? "each is accounted for" : "DIFFERS by " sent - sum
      exit sum != sent
    }'
}

# figure FILE KEY…: the number at that path of a JSON file.
figure() {
  file=$1
  shift
  python3 -c '
import json, sys
value = json.load(open(sys.argv[1]))
for key in sys.argv[2:]:
    value = value[key] if isinstance(value, dict) and key in value else None
print("-" if value is None else value)' "$file" "$@"
}

# median NUMBER…
median() {
  printf '%s\n' "$@" | sort -g | awk '{v[NR] = $1} END {print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2}'
}
