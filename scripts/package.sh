#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes what others install: Debian packages (tools with man pages and completions, library, Python, manual) and, of what is
# committed, their source package, in packages/ of the build folder. packaging/debian says what they are.
#
#   scripts/package.sh [--test] [--no-manual]
#
#   --test       also checks them with lintian and installs them in a bare Debian of the same release (debootstrap; as root),
#                where the tests of packaging/debian/tests run as a user: tools and Python where no compiler is
#   --no-manual  without the package of the manual
#
# Environment: PAMR_BUILD (build folder, default build/release; one that is configured is used as it is), PAMR_JOBS
# (compilers at once), PAMR_MIRROR (Debian's archive for --test, default http://deb.debian.org/debian), PAMR_TEST_ROOT (folder
# for the bare Debian, kept and used again; default: a temporary one).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${PAMR_BUILD:-$root/build/release}
test_them=no
manual=yes
for option in "$@"; do
  case $option in
    --test) test_them=yes ;;
    --no-manual) manual=no ;;
    -h | --help) sed -n '3,16s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "package.sh: unknown option $option (see package.sh --help)" >&2; exit 2 ;;
  esac
done

wanted=(--python --packages)
if [ $manual = yes ]; then wanted+=(--manual); fi
"$root/scripts/setup.sh" "${wanted[@]}" --packages-only
if [ ! -f "$build/build.ninja" ]; then
  cmake --preset release -S "$root" -B "$build" -DPAMR_TESTS=OFF -DPAMR_BENCH=OFF -DPAMR_BATCHES=ON
fi
build=$(cd -- "$build" && pwd)

# The sources as they are released, or as they lie here where no git knows, and packaging/debian where Debian looks for it.
out=$build/packages
version=$(sed -n 's/^pamr (\(.*\)-.*/\1/p' "$root/packaging/debian/changelog")
sources=$out/pamr-$version
rm -rf "$out"
mkdir -p "$sources"
wanted=(--build=any,all)
if [ $manual = no ]; then wanted=(--build=any); fi
if [ -e "$root/.git" ]; then
  git -c safe.directory='*' -C "$root" archive --format=tar --prefix="pamr-$version/" HEAD | xz -6 >"$out/pamr_$version.orig.tar.xz"
  tar -xJf "$out/pamr_$version.orig.tar.xz" -C "$out"
  wanted=("${wanted[0]/--build=/--build=source,}")
else
  tar -C "$root" --exclude=./build --exclude="./${build#"$root/"}" -c . | tar -x -C "$sources"
fi
cp -r "$root/packaging/debian" "$sources/debian"
(cd -- "$sources" && PAMR_SOURCE=$root PAMR_BUILD=$build DEB_BUILD_OPTIONS="noautodbgsym nocheck parallel=${PAMR_JOBS:-$(nproc)}" \
  dpkg-buildpackage --no-sign --no-pre-clean --no-check-builddeps "${wanted[@]}") >"$out/dpkg-buildpackage.log" 2>&1 || {
  tail -n 40 "$out/dpkg-buildpackage.log" >&2
  exit 1
}
rm -rf "$sources"
find "$out" -maxdepth 1 \( -name '*.deb' -o -name '*.tar.xz' \) -printf '%f %s\n' | sort | awk '{ printf "%s %.1f MB\n", $1, $2 / 1e6 }'

if [ $test_them = yes ]; then
  lintian --fail-on error,warning --tag-display-limit 0 "$out"/*.changes
  "$root/scripts/test_packages.sh" "$out"
fi
