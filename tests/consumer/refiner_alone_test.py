#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the refiner alone (preset `refiner`), static and then shared, installs each and tests it with the installed example.

Usage: refiner_alone_test.py SOURCE CMAKE COMPILER JOBS
"""
import os
import re
import resource
import subprocess
import sys
import tempfile

SOURCE, CMAKE, COMPILER, JOBS = sys.argv[1:5]
CTEST = os.path.join(os.path.dirname(CMAKE), "ctest")
LIBRARIES = ("pamr", "pamr_base", "pamr_geometry")


def run(*command, fails=False):
    result = subprocess.run(command, capture_output=True, text=True)
    if (result.returncode != 0) != fails:
        raise SystemExit(f"{command} ended with {result.returncode}\n{result.stdout}\n{result.stderr}")
    return result.stdout + result.stderr


def install(folder, kind):
    """Builds and installs it, and moves it to another place; returns that."""
    build, made, prefix = (os.path.join(folder, name) for name in ("build", f"made {kind}", kind))
    run(CMAKE, "--preset", "refiner", "-S", SOURCE, "-B", build, f"-DCMAKE_CXX_COMPILER={COMPILER}",
        f"-DBUILD_SHARED_LIBS={'ON' if kind == 'shared' else 'OFF'}")
    log = run(CMAKE, "--build", build, "--parallel", JOBS)
    if kind == "shared":
        assert "Building CXX" not in log, "the objects of static and shared libraries must be the same"
    assert "warning:" not in log, log
    run(CMAKE, "--install", build, "--prefix", made)
    os.rename(made, prefix)
    return prefix


def test_example(folder, prefix, kind):
    build = os.path.join(folder, f"example {kind}")
    run(CMAKE, "-S", os.path.join(prefix, "share", "pamr", "examples"), "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DCMAKE_CXX_COMPILER={COMPILER}", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O0")
    run(CMAKE, "--build", build)
    run(CTEST, "--test-dir", build, "--output-on-failure", "--no-tests=error")
    return build


def test_what_was_not_built_is_refused(folder, prefix):
    script = os.path.join(folder, "gas.cmake")
    with open(script, "w", encoding="utf-8") as file:
        file.write("find_package(pamr REQUIRED COMPONENTS dsmc cad refiner)\n")
    out = run(CMAKE, f"-Dpamr_DIR={folder_of(prefix, 'pamrConfig.cmake')}", "-P", script, fails=True)
    assert "expected a PAMR with dsmc, cad, found one that was built with refiner only" in " ".join(out.split()), out


def folder_of(prefix, name):
    (folder,) = (path for path, _, files in os.walk(prefix) if name in files)
    return folder


def test_shared_libraries(prefix, example):
    """Names that the loader looks for, where it finds them, and which names they show."""
    lib = folder_of(prefix, "libpamr.so")
    with open(os.path.join(SOURCE, "lib", "pamr", "base", "version.hpp"), encoding="utf-8") as file:
        version = re.findall(r"^#define PAMR_VERSION_\w+ (\d+)$", file.read(), re.M)
    soname = ".".join(version[:2] if version[0] == "0" else version[:1])
    for name in LIBRARIES:
        path = os.path.join(lib, f"lib{name}.so")
        assert os.path.basename(os.path.realpath(path)) == f"lib{name}.so.{'.'.join(version)}"
        assert f"[lib{name}.so.{soname}]" in run("readelf", "--dynamic", path)
        shown = [line.split()[-1] for line in run("nm", "--dynamic", "--defined-only", path).splitlines()]
        others = [symbol for symbol in shown if "4pamr" not in symbol]
        assert shown and not others, others[:10]
    assert f"libpamr.so.{soname} => {lib}" in run("ldd", os.path.join(example, "refine_loop"))


with tempfile.TemporaryDirectory(prefix="pamr-refiner-") as place:
    for library_kind in ("static", "shared"):
        placed = install(place, library_kind)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"{library_kind}: {used.ru_utime + used.ru_stime:.0f} s of processor time so far", flush=True)
        program = test_example(place, placed, library_kind)
        test_what_was_not_built_is_refused(place, placed)
    test_shared_libraries(placed, program)
