# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh
# Sourced by ./demo and ./check, which stand in the root of the checkout.

say() { printf '%s: %s\n' "$(basename "$0")" "$*"; }
fail() { code=$1; shift; printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit "$code"; }

# Reads a log and keeps its lines "[step/all] what": one moving line on a terminal, else a line for each tenth of the way.
# In the shell itself, since the awk of a bare Debian reads a pipe in blocks and would say nothing for minutes.
progress() {
  last=-1
  while IFS= read -r line; do
    case "$line" in '['[0-9]*/[0-9]*']'*) ;; *) continue ;; esac
    count=${line#'['}; count=${count%%']'*}
    case "$count" in 0/* | */0 | *[!0-9/]*) continue ;; esac
    tenth=$((10 * ${count%/*} / ${count#*/}))
    if [ -t 1 ]; then printf '\r\033[K%.78s' "$line"
    elif [ "$tenth" -gt "$last" ]; then printf '%.110s\n' "$line"
    fi
    last=$tenth
  done
  if [ -t 1 ]; then printf '\r\033[K'; fi
}

# run LOG FILTER COMMAND...: the command with all it says in LOG, and only its progress on the screen.
run() {
  log=$1; filter=$2; shift 2
  { status=0; "$@" 2>&1 || status=$?; echo "$status" >"$log.status"; } | tee "$log" | "$filter" | progress
  return "$(cat "$log.status")"
}

# Lines of apt-get as "[step/all] what": every package is fetched, unpacked and set up once.
apt_steps() {
  step=0
  all=0
  # shellcheck disable=SC2034  # the words of a line, some of them in the way
  while read -r first second third fourth fifth rest; do
    case "$first $second" in
      [0-9]*' upgraded,') all=$((3 * (first + third))); continue ;;
      Get:*) what="fetching $fifth" ;;
      Unpacking*) what="unpacking $second" ;;
      'Setting up') what="setting up $third" ;;
      *) continue ;;
    esac
    [ "$all" -gt 0 ] || continue   # still fetching lists
    step=$((step + 1))
    echo "[$step/$all] $what"
  done
}

# install_missing FILE...: the packages named in the files, installed if they are not there. Exit 3 if it may not.
install_missing() {
  packages=$(sed 's/#.*//' "$@")
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "not Debian or Ubuntu; going on as if the packages of $* were installed"
    return
  fi
  missing=''
  for package in $packages; do
    dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" = 0 ]; then root=''
  elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then root='sudo'
  else fail 3 "packages are missing; as root, type:  apt-get update && apt-get install -y --no-install-recommends$missing"
  fi
  say "installing$missing"
  # shellcheck disable=SC2086  # words on purpose: sudo or nothing, and a list of packages
  run build/apt.log apt_steps $root sh -c 'apt-get update -q && DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "$@"' apt $missing ||
    { tail -n 5 build/apt.log >&2; fail 3 "apt-get failed, see build/apt.log; the packages are:$missing"; }
}

# As many jobs as cores, but no more than memory holds: a source that uses CGAL takes up to 1.5 GB.
job_count() {
  cores=$(nproc 2>/dev/null || echo 1)
  room=$(awk '/^MemAvailable/ { print int($2 / 1500000) }' /proc/meminfo 2>/dev/null || true)
  [ "${room:-$cores}" -lt "$cores" ] && cores=$room
  [ "$cores" -ge 1 ] || cores=1
  echo "$cores"
}

# configure ARGUMENT...: the release preset, in build/release.
configure() {
  cmake --preset release "$@" >build/configure.log 2>&1 ||
    { tail -n 20 build/configure.log >&2; fail 1 "cmake failed, see build/configure.log"; }
}

# build TARGET...
build() {
  run build/build.log cat cmake --build --preset release -j "$(job_count)" --target "$@" ||
    { grep -v '^\[[0-9]*/[0-9]*\] ' build/build.log | head -n 60 >&2; fail 1 "the build failed, see build/build.log"; }
}
