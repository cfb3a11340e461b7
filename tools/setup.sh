# Shared by tools/demo and tools/test; to be sourced: `. tools/setup.sh`. POSIX shell, no other needs.
# Sets POVSLAM_ROOT (the repository) and offers povslam_install_packages and povslam_build.

POVSLAM_ROOT=$(git -C "$(dirname "$0")" rev-parse --show-toplevel 2>/dev/null || (cd "$(dirname "$0")/.." && pwd))

povslam_die() {
  echo "povslam: $*" >&2
  exit 1
}

# povslam_missing_packages [EXTRA…]: names of packages.txt's and extra packages that dpkg does not know as installed.
povslam_missing_packages() {
  { sed -e 's/#.*//' "$POVSLAM_ROOT/packages.txt"; echo "$@"; } | tr -s ' \t' '\n\n' | while read -r package; do
    [ -n "$package" ] || continue
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || echo "$package"
  done
}

# povslam_install_packages [EXTRA…]: installs what is missing, and only then asks for root.
povslam_install_packages() {
  command -v dpkg-query >/dev/null || povslam_die "this script installs Debian packages; here is no dpkg. See packages.txt"
  missing=$(povslam_missing_packages "$@")
  [ -n "$missing" ] || return 0
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || povslam_die "not root and no sudo; as root run: apt-get install" $missing
    as_root=sudo
  fi
  echo "povslam: installing" $missing
  $as_root apt-get -q update || povslam_die "apt-get update failed (is the network there?)"
  # shellcheck disable=SC2086 # one word per package
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends $missing ||
    povslam_die "apt-get install failed"
}

# One compiler per 1.5 GB of free memory, at most one per processor.
povslam_jobs() {
  by_memory=$(awk '/^MemAvailable:/ {n = int($2 / 1500000); print n < 1 ? 1 : n}' /proc/meminfo)
  by_processor=$(nproc)
  if [ "$by_memory" -lt "$by_processor" ]; then echo "$by_memory"; else echo "$by_processor"; fi
}

# povslam_build PRESET [TARGET…]: configures and builds into build/PRESET; POVSLAM_JOBS overrides the number of jobs.
povslam_build() {
  preset=$1
  shift
  [ $# -eq 0 ] || set -- --target "$@"
  (
    cd "$POVSLAM_ROOT" || exit 1
    mkdir -p build
    cmake --preset "$preset" >"build/configure-$preset.log" 2>&1 || { cat "build/configure-$preset.log" >&2; exit 1; }
    cmake --build --preset "$preset" --parallel "${POVSLAM_JOBS:-$(povslam_jobs)}" "$@"
  ) || povslam_die "the build of preset $preset failed"
}
