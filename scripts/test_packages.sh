#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the packages of scripts/package.sh in a bare Debian of this system's release and uses them there, as an ordinary user, by the
# tests of packaging/debian/tests: tools, Python and manual where no compiler is; at last the library, with a compiler.
#
#   scripts/test_packages.sh FOLDER    the folder with the packages; as root, since it makes a root of its own
#
# Environment: PAMR_MIRROR, PAMR_TEST_ROOT (see scripts/package.sh).
set -euo pipefail

packages=$(cd -- "${1:?expected the folder with the packages}" && pwd)
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
. "$root/scripts/bare_debian.sh"
in_own_mounts "${BASH_SOURCE[0]}" "$@"
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
if [ -n "${PAMR_TEST_ROOT:-}" ]; then
  bare=$PAMR_TEST_ROOT
else
  bare=$(mktemp -d -t pamr-debian.XXXXXX)
  chmod 755 "$bare" # the user in it has to find its programs
  trap 'leave_bare; rm -rf --one-file-system "$bare"' EXIT
fi
enter_bare "$release" "$bare" "$packages/debootstrap.log"
install() { # names or patterns of packages, with what they depend on and nothing else
  inside sh -c "apt-get -q -y install --no-install-recommends $*" >>"$packages/apt.log" 2>&1 || {
    tail -n 20 "$packages/apt.log" >&2
    exit 1
  }
}
check() { # a test of packaging/debian/tests, as the user in a folder of its own
  local begin=$SECONDS
  inside install -d -o 4321 -g 4321 "/tmp/user/$1"
  chroot --userspec=4321:4321 "$bare" env -i PATH=/usr/bin:/bin HOME=/tmp/user LC_ALL=C.UTF-8 AUTOPKGTEST_TMP="/tmp/user/$1" \
    "/tmp/packages/tests/$1" >>"$packages/test.log" 2>&1 || {
    tail -n 20 "$packages/test.log" >&2
    echo "test_packages.sh: $1: failed" >&2
    exit 1
  }
  echo "-- $1: $((SECONDS - begin)) s"
}

: >"$packages/test.log"
rm -rf "$bare/tmp/packages" "$bare/tmp/user"
mkdir -p "$bare/tmp/packages" "$bare/tmp/user"
chown 4321:4321 "$bare/tmp/user"
cp -r "$packages"/*.deb "$root/packaging/debian/tests" "$bare/tmp/packages"
# A system that was kept may have them.
inside sh -c 'dpkg --purge pamr-doc python3-pamr libpamr-dev pamr; apt-get -q -y autoremove; apt-get -q update' >"$packages/apt.log" 2>&1

begin=$SECONDS
install '/tmp/packages/pamr_*.deb'
echo "apt install ./pamr_*.deb: $((SECONDS - begin)) s"
if inside sh -c 'command -v cc || command -v c++ || command -v cmake'; then
  echo "test_packages.sh: expected a system without a compiler" >&2
  exit 1
fi
check tools
if ls "$packages"/python3-pamr_*.deb >/dev/null 2>&1; then
  install '/tmp/packages/python3-pamr_*.deb'
  check python
fi
if ls "$packages"/pamr-doc_*.deb >/dev/null 2>&1; then
  install '/tmp/packages/pamr-doc_*.deb'
  check manual
fi
if ls "$packages"/libpamr-dev_*.deb >/dev/null 2>&1; then
  install '/tmp/packages/libpamr-dev_*.deb' cmake g++ make pkgconf
  check library
fi
inside sh -c 'apt-get -q -y purge pamr libpamr-dev python3-pamr pamr-doc; test ! -e /usr/bin/pamr-refine' >>"$packages/apt.log" 2>&1
echo "the packages work on a bare Debian ($release)"
