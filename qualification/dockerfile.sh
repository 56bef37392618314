#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs each line of packaging/Dockerfile where no Docker is: a stage is a bare Debian made by debootstrap, RUN a command in it. Then
# refines a mesh in the last one, as `docker run` would.
#
#   qualification/dockerfile.sh [12 | 13] [FOLDER]    the release of Debian (default: 12); as root; half an hour on two cores
#
# What is committed is built. FOLDER: packages that are there already, put where the line `RUN scripts/package.sh` would make them.
# Environment: PAMR_MIRROR (Debian's archive), PAMR_DOCKER_ROOTS (folder for the systems, kept and used again; default: temporary).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
case ${1:-} in -h | --help) sed -n '3,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;; esac
. "$root/scripts/bare_debian.sh"
in_own_mounts "${BASH_SOURCE[0]}" "$@"
declare -A suites=([12]=bookworm [13]=trixie)
declare -A value=([DEBIAN]=${1:-12}) # of ARG
given=${2:+$(cd -- "$2" && pwd)}
[ -n "${suites[${value[DEBIAN]}]:-}" ] || { echo "dockerfile.sh: expected 12 or 13, found ${value[DEBIAN]}" >&2; exit 2; }
roots=${PAMR_DOCKER_ROOTS:-}
if [ -z "$roots" ]; then
  roots=$(mktemp -d -t pamr-docker.XXXXXX)
  chmod 755 "$roots"
  trap 'for bare in "$roots"/*; do leave_bare; done; rm -rf --one-file-system "$roots"' EXIT
fi

stage=0
environment=() workdir=/
declare -A folder_of=()

from() { # image [AS name]
  [ "${1%:*}" = debian ] || { echo "dockerfile.sh: expected an image of Debian, found $1" >&2; exit 1; }
  stage=$((stage + 1)) environment=() workdir=/
  bare=$roots/stage$stage
  mkdir -p "$bare"
  enter_bare "${suites[${1#*:}]}" "$bare" "$roots/debootstrap.log"
  if [ "${2:-}" = AS ]; then folder_of[$3]=$bare; fi
}
copy() { # [--from=STAGE] what where
  if [ "$1" = . ]; then
    mkdir -p "$bare$2"
    git -c safe.directory='*' -C "$root" archive HEAD | tar -x -C "$bare$2"
    return
  fi
  local from=${folder_of[${1#--from=}]}
  mkdir -p "$bare$3"
  # shellcheck disable=SC2086  # a pattern
  cp "$from"/${2#/} "$bare$3"
}
run() {
  if [ -n "$given" ] && [ "$1" = scripts/package.sh ]; then
    mkdir -p "$bare$workdir/build/release/packages"
    cp "$given"/*.deb "$bare$workdir/build/release/packages"
    return
  fi
  inside env "${environment[@]}" sh -ec "mkdir -p '$workdir' && cd '$workdir' && $1"
}

while read -r instruction rest; do
  for name in "${!value[@]}"; do rest=${rest//\$\{$name\}/${value[$name]}}; done
  case $instruction in
    "" | "#"*) continue ;;
    ARG) [ -n "${value[${rest%%=*}]:-}" ] || value[${rest%%=*}]=${rest#*=}; continue ;;
  esac
  printf -- '-- %s %s\n' "$instruction" "$rest"
  begin=$SECONDS
  # shellcheck disable=SC2086  # words of an instruction
  case $instruction in
    FROM) from $rest ;;
    COPY) set -f && set -- $rest && set +f && copy "$@" ;;
    WORKDIR) workdir=$rest ;;
    ENV) environment+=("$rest") ;;
    RUN) run "$rest" >"$roots/run.log" 2>&1 </dev/null || { tail -n 30 "$roots/run.log" >&2; exit 1; } ;;
    *) echo "dockerfile.sh: expected ARG, FROM, COPY, WORKDIR, ENV or RUN, found $instruction" >&2; exit 1 ;;
  esac
  [ $((SECONDS - begin)) -lt 5 ] || echo "   $((SECONDS - begin)) s"
done <"$root/packaging/Dockerfile"

run 'rm -f *.hdf; pamr-mesh --shape sphere-in-box -o a.hdf && pamr-mark a.hdf -o b.hdf --patch sphere &&
  mpirun -n 2 pamr-refine b.hdf -o c.hdf && pamr-quality c.hdf --gate inverted_cells:max:0 &&
  mpirun -n 2 python3 -c "import pamr; print(pamr.__version__)"'
echo "each line of the Dockerfile ran (Debian ${value[DEBIAN]})"
