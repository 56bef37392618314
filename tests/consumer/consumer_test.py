#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs PAMR, builds a project of its own against it, and runs the programs of README.md word for word.

Usage: consumer_test.py SOURCE BUILD CMAKE COMPILER MPIEXEC...
"""
import functools
import glob
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD, CMAKE, COMPILER, MPIEXEC = *sys.argv[1:5], sys.argv[5:]
CONSUMER = os.path.join(SOURCE, "tests", "consumer")


def text_of(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return file.read()


def without_license(text):
    return re.sub(r"^.*SPDX-License-Identifier.*\n", "", text, count=1)


class Consumer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="pamr consumer ")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        cls.prefix = os.path.join(cls.folder, "prefix")
        made = os.path.join(cls.folder, "made here")
        cls.run_ok(CMAKE, "--install", BUILD, "--prefix", made)
        os.rename(made, cls.prefix)  # an installed PAMR may be moved
        cls.tool("pamr-mesh", "--shape", "kuhn-cube", "--n", "8", "-o", "cube.hdf")

    @classmethod
    def run_ok(cls, *command, environment=None):
        result = subprocess.run(command, cwd=cls.folder, capture_output=True, text=True, env=environment)
        if result.returncode != 0:
            raise AssertionError(f"{command} ended with {result.returncode}\n{result.stdout}\n{result.stderr}")
        return result.stdout

    @classmethod
    def tool(cls, name, *arguments):
        return cls.run_ok(*MPIEXEC, "2", os.path.join(cls.prefix, "bin", name), *arguments)

    def has_package(self):
        return bool(glob.glob(os.path.join(self.prefix, "lib", "python3*", "dist-packages", "pamr", "_core*")))

    def environment(self):
        """Of a user who has put the tools and the Python package into the paths."""
        package = glob.glob(os.path.join(self.prefix, "lib", "python3*", "dist-packages"))
        launcher = os.path.dirname(shutil.which(MPIEXEC[0]) or MPIEXEC[0])
        return os.environ | {"PATH": os.pathsep.join((os.path.join(self.prefix, "bin"), launcher, os.environ["PATH"])),
                             "PYTHONPATH": os.pathsep.join(package)}

    @classmethod
    @functools.cache
    def build(cls, source, name):
        """Not optimized: their compilation takes longer than what they do."""
        build = os.path.join(cls.folder, name)
        cls.run_ok(CMAKE, "-G", "Ninja", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={cls.prefix}",
                   f"-DCMAKE_CXX_COMPILER={COMPILER}", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O0",
                   "-DCMAKE_UNITY_BUILD=ON")
        cls.run_ok(CMAKE, "--build", build)
        return build

    def test_the_readme_shows_these_programs(self):
        readme = text_of(SOURCE, "README.md")
        for language, name in (("cpp", "refine_ball.cpp"), ("python", "mark_ball.py"), ("python", "refine_loop.py")):
            program = without_license(text_of(CONSUMER, name))
            self.assertIn(f"```{language}\n{program}```\n", readme, f"README.md must show {name} as it is")

    def test_programs_in_cpp_and_with_files_give_the_same_mesh(self):
        build = self.build(CONSUMER, "build")
        self.run_ok(*MPIEXEC, "2", os.path.join(build, "refine_ball"))
        if os.path.exists(os.path.join(build, "clients")):
            self.assertIn("flux factor", self.run_ok(os.path.join(build, "clients")))
        if os.path.exists(os.path.join(build, "potential")):
            self.assertIn("PETSc has started", self.run_ok(os.path.join(build, "potential")))
        self.tool("pamr-quality", "fine.hdf", "--gate", "inverted_cells:max:0")

        shutil.copy(os.path.join(self.folder, "cube.hdf"), os.path.join(self.folder, "level0.hdf"))
        for _ in range(2):  # once more over the files of the first time
            self.run_ok(sys.executable, os.path.join(CONSUMER, "mark_ball.py"), environment=self.environment())

        first, second = (json.loads(self.tool("pamr-quality", name, "--json", "-", "--quiet"))["fingerprint"]
                         for name in ("fine.hdf", "level1.hdf"))  # which has marks now
        self.assertEqual(first, second)
        self.tool("pamr-quality", "level3.hdf", "--gate", "inverted_cells:max:0")

    def test_a_program_without_cmake(self):
        """pkg-config quotes no blanks but those of -I and -L: the place has none."""
        place = tempfile.mkdtemp(prefix="pamr-pc-")
        self.addCleanup(shutil.rmtree, place)
        os.symlink(self.prefix, os.path.join(place, "prefix"))
        pkgconfig = glob.glob(os.path.join(place, "prefix", "lib*", "**", "pkgconfig"), recursive=True)[0]
        environment = self.environment() | {"PKG_CONFIG_PATH": pkgconfig}
        flags = shlex.split(self.run_ok("pkg-config", "--cflags", "--libs", "pamr", environment=environment))
        source = os.path.join(self.folder, "version.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write("#include <iostream>\n#include <pamr/pamr.hpp>\nint main(int argc, char** argv) {\n"
                       "  const pamr::par::Runtime mpi(argc, argv);\n  const pamr::par::Comm comm(mpi.world());\n"
                       "  const auto mesh = pamr::assemble::assemble(comm, pamr::io::read_native(comm, \"cube.hdf\"));\n"
                       "  std::cout << pamr::version() << ' ' << mesh.n_cells() << std::endl;\n}\n")
        self.run_ok("mpicxx", "-std=c++20", source, "-o", os.path.join(self.folder, "version"), *flags, environment=environment)
        version = self.run_ok("pkg-config", "--modversion", "pamr", environment=environment).strip()
        self.assertEqual(self.run_ok(os.path.join(self.folder, "version")), f"{version} 3072\n")
        if self.has_package():
            self.assertEqual(self.run_ok(sys.executable, "-c", "import pamr; print(pamr.__version__)", environment=environment).strip(),
                             version)

    def test_each_tool_has_a_completion_and_a_man_page(self):
        for tool in os.listdir(os.path.join(self.prefix, "bin")):
            if not tool.startswith("pamr-"):
                continue
            self.assertIn(tool, text_of(self.prefix, "share", "bash-completion", "completions", tool))
            if shutil.which("help2man"):
                self.assertIn(".TH", text_of(self.prefix, "share", "man", "man1", f"{tool}.1"))

    def test_components_that_were_not_built_are_refused_by_name(self):
        (config,) = glob.glob(os.path.join(self.prefix, "lib*", "**", "pamrConfig.cmake"), recursive=True)
        script = os.path.join(self.folder, "components.cmake")
        with open(script, "w", encoding="utf-8") as file:
            file.write("find_package(pamr REQUIRED COMPONENTS refiner hexahedra OPTIONAL_COMPONENTS prisms)\n")
        result = subprocess.run([CMAKE, f"-Dpamr_DIR={os.path.dirname(config)}", "-P", script], cwd=self.folder,
                                capture_output=True, text=True)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("expected a PAMR with hexahedra, found one that was built with refiner", " ".join(result.stderr.split()))

    def test_cad_files_are_read_where_pamr_is_installed(self):
        """By tools, programs of others and Python, all of which load a library to do so; none has it from the start."""
        if not glob.glob(os.path.join(self.prefix, "lib", "**", "libpamr_cad-*.so"), recursive=True):
            return  # built without OpenCASCADE
        part = os.path.join(SOURCE, "tests", "tools", "data", "can.step")
        self.tool("pamr-mesh", part, "-o", "can.hdf")
        self.tool("pamr-mark", "can.hdf", "-o", "marked.hdf", "--all")
        self.tool("pamr-refine", "marked.hdf", "-o", "fine_can.hdf")
        libraries = self.run_ok("ldd", os.path.join(self.prefix, "bin", "pamr-refine"))
        self.assertIn("libmpi", libraries)
        self.assertNotIn("libTK", libraries)
        self.assertEqual(self.run_ok(os.path.join(self.build(CONSUMER, "build"), "cad"), part), "3 faces\n")
        if self.has_package():
            program = ("import pamr\nfrom mpi4py import MPI\nmesh = pamr.Mesh.read(MPI.COMM_WORLD, 'can.hdf')\n"
                       "print(pamr.refine(mesh, [True] * len(mesh.cells)).mesh.n_cells == 8 * mesh.n_cells)")
            self.assertEqual(self.run_ok(sys.executable, "-c", program, environment=self.environment()), "True\n")

    def test_the_python_package_gives_the_same_bytes_on_any_ranks(self):
        if not self.has_package():
            return  # not built: configuration says so
        files = []
        for ranks in ("1", "3"):
            self.run_ok(*MPIEXEC, ranks, sys.executable, os.path.join(CONSUMER, "refine_loop.py"),
                        environment=self.environment())
            with open(os.path.join(self.folder, "loop.hdf"), "rb") as file:
                files.append(file.read())
        self.assertEqual(files[0], files[1])

    def test_the_programs_of_the_pages_on_coupling_run(self):
        page = "".join(text_of(SOURCE, "docs", name) for name in ("coupling.md", "coupling-python.md", "coupling-openfoam.md"))
        (script,) = re.findall(r"^```sh\n(.*?)^```$", page, re.M | re.S)
        program, openfoam = re.findall(r"^```python\n(.*?)^```$", page, re.M | re.S)
        os.mkdir(os.path.join(self.folder, "page"))
        self.run_ok("sh", "-e", "-c", "cd page\n" + script, environment=self.environment())
        self.tool("pamr-quality", "page/level3.hdf", "--gate", "inverted_cells:max:0")
        if not self.has_package():
            return
        files = []
        for ranks in ("1", "3"):
            out = self.run_ok(*MPIEXEC, ranks, sys.executable, "-c", program, environment=self.environment())
            self.assertIn("32768 cells, volume 4.165 of 4.189", out)
            with open(os.path.join(self.folder, "ball.hdf"), "rb") as file:
                files.append(file.read())
        self.assertEqual(files[0], files[1])
        self.run_with_openfoam(openfoam)

    def run_with_openfoam(self, program):
        """The page's program with a solver that finds 360 everywhere."""
        shutil.copy(os.path.join(self.folder, "cube.hdf"), os.path.join(self.folder, "level0.hdf"))
        cases = [os.path.join(self.folder, name) for name in ("case0", "case1")]
        for ranks in ("1", "3"):
            for case in cases:
                shutil.rmtree(case, ignore_errors=True)
            os.makedirs(os.path.join(cases[0], "1"))
            with open(os.path.join(cases[0], "1", "T"), "w", encoding="ascii") as file:
                file.write("FoamFile { version 2.0; format ascii; class volScalarField; object T; }\ndimensions [0 0 0 1 0 0 0];\n"
                           'internalField uniform 360;\nboundaryField { ".*" { type zeroGradient; } }\n')
            self.run_ok(*MPIEXEC, ranks, sys.executable, "-c", program, environment=self.environment())
            self.assertEqual(text_of(cases[1], "0", "T"), text_of(cases[0], "1", "T"))
            self.assertIn(f"nCells:{8 * 6 * 8 ** 3} ", text_of(cases[1], "constant", "polyMesh", "owner"))
            self.assertEqual(len(glob.glob(os.path.join(cases[1], "processor*"))), int(ranks))

    def test_the_installed_example_and_its_tests(self):
        build = self.build(os.path.join(self.prefix, "share", "pamr", "examples"), "example")
        out = self.run_ok(os.path.join(os.path.dirname(CMAKE), "ctest"), "--test-dir", build, "--verbose")
        self.assertEqual(out.count("1296 -> "), 2)  # on one rank and on two
        self.assertEqual(out.count("the probe is in cell"), 2)
        self.assertIn("same_bytes", out)
        self.tool("pamr-quality", os.path.join(build, "loop.hdf"), "--gate", "inverted_cells:max:0")
        self.run_ok(*MPIEXEC, "2", os.path.join(build, "moving-front", "moving-front"), "--n", "2", "--levels", "1")
        self.assertIn("step,time,cells", text_of(self.folder, "history.csv"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
