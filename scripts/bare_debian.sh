# SPDX-License-Identifier: GPL-3.0-or-later
# To be sourced by scripts that try PAMR in a bare Debian, as root. Environment: PAMR_MIRROR (default http://deb.debian.org/debian).

# Starts the calling script again, given with its arguments, where what it mounts goes with it.
in_own_mounts() {
  if [ "$(id -u)" != 0 ]; then
    echo "${1##*/}: expected to be root, which debootstrap and chroot need" >&2
    exit 2
  fi
  [ -n "${PAMR_TESTS_IN_OWN_MOUNTS:-}" ] || PAMR_TESTS_IN_OWN_MOUNTS=1 exec unshare --mount --propagation private "$@"
}

# enter_bare SUITE FOLDER LOG: makes the system unless it is there, and what programs in it need; `inside` runs one as root.
enter_bare() {
  bare=$2
  [ -x "$bare/usr/bin/apt-get" ] || debootstrap --variant=minbase "$1" "$bare" "${PAMR_MIRROR:-http://deb.debian.org/debian}" >"$3"
  mount -t proc proc "$bare/proc"
  mount -t sysfs -o ro sysfs "$bare/sys"
  mount --rbind /dev "$bare/dev"
  [ ! -e /etc/resolv.conf ] || cp -L /etc/resolv.conf "$bare/etc/resolv.conf"
}
leave_bare() { umount -R "$bare/proc" "$bare/sys" "$bare/dev" 2>/dev/null || true; }
inside() { chroot "$bare" env -i PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
