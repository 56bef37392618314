#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes what others install: Debian packages (tools with man pages and completions, library, Python, manual) and a source
# archive, in packages/ of the build folder.
#
#   scripts/package.sh [--test] [--no-manual]
#
#   --test       also installs the packages in a bare Debian 12 (debootstrap; as root), where no compiler is, runs the first
#                tutorial there as a user, imports the Python package and builds an example on the library
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
    -h | --help) sed -n '3,17s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
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
cmake --build "$build" --target installed ${PAMR_JOBS:+--parallel "$PAMR_JOBS"}
. "$root/scripts/mpi_environment.sh"

# Man pages and completions say what the tools say themselves.
out=$build/packages
rm -rf "$out"
mkdir -p "$out/man" "$out/completions"
tools=("$build"/bin/pamr-*)
"$root/scripts/completions.py" "$out/completions" "${tools[@]}"
for tool in "${tools[@]}"; do
  name=$(basename -- "$tool")
  purpose=$(sed -n "s/^# $name: //p" "$root/docs/tools/$name.md")
  help2man --no-info --no-discard-stderr --name "${purpose:?docs/tools/$name.md must begin with '# $name: ...'}" --section 1 \
    --source PAMR --manual "PAMR's tools" "$tool" | gzip -9n >"$out/man/$name.1.gz"
done
if [ $manual = yes ]; then "$root/docs/build.sh" "$build/manual"; else rm -rf "$build/manual"; fi

components="tools;dev;python"
if [ $manual = yes ]; then components+=";doc"; fi
(cd -- "$out" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$out" -D CPACK_COMPONENTS_ALL="$components" >"$out/cpack.log") || {
  cat "$out/cpack.log" >&2
  exit 1
}
rm -rf "$out/_CPack_Packages"
version=$(sed -n 's/^set(CPACK_PACKAGE_VERSION "\(.*\)")/\1/p' "$build/CPackConfig.cmake")
if [ -e "$root/.git" ]; then
  git -c safe.directory='*' -C "$root" archive --format=tar --prefix="pamr-$version/" HEAD | xz -6 >"$out/pamr-$version.tar.xz"
fi
(cd -- "$out" && ls -l -- *.deb *.tar.xz 2>/dev/null | awk '{ printf "%s %.1f MB\n", $9, $5 / 1e6 }')

if [ $test_them = yes ]; then "$root/scripts/test_packages.sh" "$out"; fi
