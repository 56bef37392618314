# SPDX-License-Identifier: GPL-3.0-or-later
"""The codes that are set beside ours: environments of their own, each optional, made once and kept."""

import os
import pathlib
import shutil
import subprocess
import sysconfig
import tomllib

COMPARE = pathlib.Path(__file__).resolve().parent.parent / "compare"
SYSTEM_PYTHON = os.environ.get("PAMR_PEER_PYTHON", "/usr/bin/python3")  # Debian's own, which sees its packages
COMPILER = os.environ.get("PAMR_PEER_CXX", "mpicxx")
LONGEST_LINE = 160
# Variables that pip needs before it fetches the source of a package of DUNE.
SOURCE_STUB = """
def metaData(*_, **__):
    return None, {"name": "NAME", "version": "VERSION", "packages": [], "py_modules": []}
"""
ALUGRID_SOURCES = (
    "3d/faceutility 3d/mappings 3d/topology impl/binaryio impl/macrofileheader impl/serial/ghost_info "
    "impl/serial/gitter_geo impl/serial/gitter_hexa_top impl/serial/gitter_impl impl/serial/gitter_mgb "
    "impl/serial/gitter_sti impl/serial/gitter_tetra_top impl/serial/mapp_cube_3d impl/serial/mapp_tetra_3d "
    "impl/serial/myalloc impl/duneinterface/gitter_dune_impl impl/serial/ghost_elements "
    "impl/duneinterface/gitter_dune_pll_impl impl/parallel/mpAccess impl/parallel/gitter_hexa_top_pll "
    "impl/parallel/gitter_pll_impl impl/parallel/gitter_pll_idn impl/parallel/gitter_pll_ldb "
    "impl/parallel/gitter_pll_mgb impl/parallel/gitter_pll_sti impl/parallel/gitter_tetra_top_pll"
).split()


class NotToBeHad(Exception):
    """A code that cannot be had, with the last error on the way to it."""


def listed():
    """{name: what peers.toml says of it}, in its order."""
    return tomllib.loads((pathlib.Path(__file__).parent / "peers.toml").read_text(encoding="ascii"))


def call(command, **options):
    """Runs a command; its last line of error is that of `NotToBeHad`."""
    try:
        done = subprocess.run(
            [str(word) for word in command],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
            **options,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotToBeHad(str(error)[:LONGEST_LINE]) from error
    if done.returncode != 0:
        lines = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        telling = [line for line in lines if "rror" in line and "See above" not in line and "hint" not in line]
        raise NotToBeHad(f"{pathlib.Path(command[0]).name}: {(telling or lines or ['no message'])[-1]}"[:LONGEST_LINE])
    return done.stdout


class Peers:
    """Codes in a folder that is kept. `command(name)` is the start of the command line of one that can be had."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.all = listed()
        self.errors = {}
        self.commands = {}

    def command(self, name):
        """Makes it where it is not there yet; None, and the reason in `errors`, where that is impossible."""
        if name not in self.commands:
            try:
                self.commands[name] = self._make(name, self.all[name])
            except NotToBeHad as error:
                self.commands[name] = None
                self.errors[name] = str(error)
        return self.commands[name]

    def environment(self, name):
        """Of its processes: one thread, and the libraries that its packages bring along."""
        variables = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
        if "pip" in self.all[name]:
            variables["LD_LIBRARY_PATH"] = str(self._environment_folder(name) / "lib")  # MPICH's, as a package
        return variables

    def _environment_folder(self, name):
        return self.folder / self.all[name].get("environment", name)

    def _make(self, name, entry):
        program = COMPARE / entry["program"]
        if program.suffix == ".cpp":
            return [self._built(name, entry, program)]
        if "module" in entry:
            try:
                call([SYSTEM_PYTHON, "-c", f"import {entry['module']}, numpy"])
            except NotToBeHad as error:
                raise NotToBeHad(f"not installed ({entry['packages']}); {error}"[:LONGEST_LINE]) from error
            return [SYSTEM_PYTHON, "-B", program]
        return [self._virtual_python(name, entry), "-B", program]

    def sources(self, name):
        """The folder with the sources of a code that is in a git repository; None, and the reason in `errors`, where they
        cannot be had."""
        entry = self.all[name]
        folder = self.folder / f"{name}-{entry['commit'][:8]}"
        git, stamp = ["git", "-C", folder], folder / "pamr-made-of"
        if not stamp.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            try:
                call([*git, "init", "-q"])
                call([*git, "config", "remote.origin.url", entry["git"]])
                call([*git, "fetch", "-q", "--depth", "1", "--filter=blob:none", "origin", entry["commit"]], timeout=600)
                call([*git, "checkout", "-q", "FETCH_HEAD", "--", entry["folder"]], timeout=600)
            except NotToBeHad as error:
                self.errors[name] = str(error)
                return None
            stamp.write_text(entry["commit"], encoding="ascii")
        return folder

    def _virtual_python(self, name, entry):
        folder = self._environment_folder(name)
        python = folder / "bin/python"
        stamp = folder / "pamr-made-of"
        wanted = "\n".join(entry["pip"])
        if stamp.exists() and stamp.read_text(encoding="ascii") == wanted:
            return python
        shutil.rmtree(folder, ignore_errors=True)
        self.folder.mkdir(parents=True, exist_ok=True)
        call([base_python(entry.get("python")), "-m", "venv", folder])
        call(
            [
                python,
                "-m",
                "pip",
                "install",
                "-q",
                "--disable-pip-version-check",
                "--only-binary",
                ":all:",
                *entry["pip"],
            ],
            timeout=900,
        )
        stamp.write_text(wanted, encoding="ascii")
        return python

    def _built(self, name, entry, program):
        """From the source of our program and what Debian has, unpacked."""
        folder = self.folder / name
        target, stamp = folder / "peer", folder / "pamr-made-of"
        sources = [program, *sorted(COMPARE.glob("*.hpp"))]
        wanted = "\n".join(
            [*entry["deb"], entry.get("source", ""), *(path.read_text(encoding="ascii") for path in sources)]
        )
        if target.exists() and stamp.exists() and stamp.read_text(encoding="ascii") == wanted:
            return target
        if not shutil.which(COMPILER):
            raise NotToBeHad(f"no compiler {COMPILER}")
        folder.mkdir(parents=True, exist_ok=True)
        root = unpacked(entry["deb"], folder)
        flags = {"netgen-debian": netgen_flags, "ug": ug_flags, "alugrid": self._alugrid_flags}[name](root)
        call([COMPILER, "-std=c++20", "-O2", "-w", program, "-o", target, *flags], timeout=900)
        stamp.write_text(wanted, encoding="ascii")
        return target

    def _alugrid_flags(self, root):
        folder = root.parent.parent
        name, version = self.all["alugrid"]["source"].split("==")
        sources = folder / f"{name}-{version}"
        if not sources.exists():
            fetch_source(name, version, folder)
        library = folder / "libalugrid.a"
        (sources / "config.h").write_text("/* Everything is defined on the command line. */\n", encoding="ascii")
        definitions = [
            "-DHAVE_MPI=1",
            "-DENABLE_MPI=1",
            "-DOMPI_SKIP_MPICXX",  # what some of its sources include as C
            "-DMPICH_SKIP_MPICXX",
            "-DHAVE_DUNE_ALUGRID=1",
            f'-DALUGRID_VERSION_NAME="{version}"',
            f'-DDUNE_ALUGRID_VERSION="{version}"',
            "-DNDEBUG",
            f"-I{sources}",
            f"-I{root}/include",
        ]
        if not library.exists():
            objects = folder / "objects"
            objects.mkdir(exist_ok=True)
            for source in ALUGRID_SOURCES:
                target = objects / (source.replace("/", "-") + ".o")
                if not target.exists():
                    call(
                        [
                            COMPILER,
                            "-std=c++17",
                            "-O2",
                            "-w",
                            "-c",
                            sources / "dune/alugrid" / (source + ".cc"),
                            "-o",
                            target,
                            *definitions,
                        ],
                        timeout=900,
                    )
            call(["ar", "rcs", library, *objects.glob("*.o")])
        return [*definitions, library, *dune_libraries(root), "-ldunegrid", "-ldunegeometry", "-ldunecommon"]


def base_python(releases):
    """A Python of one of these releases; the system's, or the one that was asked for, where any will do."""
    if not releases or "PAMR_PEER_PYTHON" in os.environ:
        return SYSTEM_PYTHON
    homes = sorted((pathlib.Path.home() / ".pyenv/versions").glob("*/bin"), reverse=True)
    for release in releases:
        for home in [None, *homes]:
            found = shutil.which(f"python{release}", path=str(home) if home else None)
            if found and subprocess.run([found, "-c", ""], capture_output=True, check=False).returncode == 0:
                return found
    raise NotToBeHad(f"no Python {' or '.join(releases)} here")


def unpacked(packages, folder):
    """Packages of Debian, unpacked under the folder, not installed: its `usr`. One with `?` may be missing."""
    root = folder / "debian"
    (root / "packages").mkdir(parents=True, exist_ok=True)
    for package in packages:
        name = package.rstrip("?")
        if list((root / "packages").glob(f"{name}_*.deb")):
            continue
        try:
            call(["apt-get", "-q", "download", name], cwd=root / "packages", timeout=300)
        except NotToBeHad:
            if package == name:
                raise
            continue
        call(["dpkg", "-x", *(root / "packages").glob(f"{name}_*.deb"), root])
    return root / "usr"


def fetch_source(name, version, folder):
    """The source of a package of PyPI, which pip hands over when it knows its name and version."""
    environment = folder / "pip"
    stub = folder / "stub"
    stub.mkdir(exist_ok=True)
    (stub / "packagemetadata.py").write_text(
        SOURCE_STUB.replace("NAME", name).replace("VERSION", version), encoding="ascii"
    )
    call([SYSTEM_PYTHON, "-m", "venv", environment])
    pip = [environment / "bin/python", "-m", "pip"]
    call(
        [*pip, "install", "-q", "--disable-pip-version-check", "setuptools==66.1.1", "scikit-build==0.19.1", "wheel"],
        timeout=300,
    )
    call(
        [
            *pip,
            "download",
            "-q",
            "--disable-pip-version-check",
            "--no-deps",
            "--no-binary",
            ":all:",
            "--no-build-isolation",
            "-d",
            folder,
            f"{name}=={version}",
        ],
        env={**os.environ, "PYTHONPATH": str(stub)},
        timeout=300,
    )
    call(["tar", "xzf", f"{name}-{version}.tar.gz"], cwd=folder)


def library_folder(root):
    return root / "lib" / (sysconfig.get_config_var("MULTIARCH") or "x86_64-linux-gnu")


def dune_libraries(root):
    folder = library_folder(root)
    return [f"-L{folder}", f"-Wl,-rpath,{folder}", "-Wl,--disable-new-dtags", f"-Wl,-rpath-link,{folder}"]


# netgen's library is built with MPI, which shows in the layout of its mesh class.
def netgen_flags(root):
    folder = library_folder(root) / "netgen"
    version = (folder / "libmesh.so").resolve().name.removeprefix("libmesh.so.")
    return [
        "-DPARALLEL",
        f'-DNETGEN_VERSION_NAME="{version}"',
        f"-I{root}/include/netgen",
        f"-I{root}/include/netgen/include",
        f"-L{folder}",
        f"-Wl,-rpath,{folder}",
        "-lmesh",
        "-linterface",
        "-lngcore",
    ]


# Debian's library is the parallel one (ModelP); without its definitions the headers describe another.
def ug_flags(root):
    version = (library_folder(root) / "libduneuggrid.so").resolve().name.removeprefix("libduneuggrid.so.")
    return [
        "-DHAVE_DUNE_UGGRID=1",
        "-DHAVE_MPI=1",
        "-DENABLE_MPI=1",
        "-DModelP",
        "-DNDEBUG",
        f'-DUG_VERSION_NAME="{version}"',
        f"-I{root}/include",
        *dune_libraries(root),
        "-ldunegrid",
        "-lduneuggrid",
        "-ldunegeometry",
        "-ldunecommon",
    ]
