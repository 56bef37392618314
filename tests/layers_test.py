#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks every rule of layers.py once, in a tree of its own, and sees it caught."""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
sys.dont_write_bytecode = True
import layers  # noqa: E402

SPDX = "// SPDX-License-Identifier: GPL-3.0-or-later\n"
REFINE_HEADER = SPDX + '#pragma once\n#include "pamr/mesh/tet.hpp"\nnamespace pamr::refine {}\n'


class Layers(unittest.TestCase):
    def found(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True)
            path.write_text(text)
            module = layers.module_of(name)
            if path.suffix == ".cpp" and module not in (None, "tools"):  # the header of its name
                space = "pamr" if module == "base" else f"pamr::{module}"
                path.with_suffix(".hpp").write_text(SPDX + f"#pragma once\nnamespace {space} {{}}\n")
            return list(layers.violations(pathlib.Path(folder)))

    def assert_caught(self, name, text, *words):
        found = self.found(name, text)
        self.assertEqual(len(found), 1, found)
        for word in (name, *words):
            self.assertIn(word, found[0])

    def assert_clean(self, name, text):
        self.assertEqual(self.found(name, text), [])

    def test_a_good_file_is_clean(self):
        self.assert_clean("lib/pamr/refine/close.hpp", REFINE_HEADER)

    def test_a_stage_must_not_include_a_sibling(self):
        self.assert_caught("lib/pamr/refine/a.cpp", SPDX + '#include "pamr/check/fingerprint.hpp"\n', ":2:",
                           "refine must not include check")

    def test_base_includes_nothing_and_geometry_only_base(self):
        self.assert_caught("lib/pamr/base/a.cpp", SPDX + '#include "pamr/par/comm.hpp"\n', "base must not include par")
        self.assert_caught("geometry/pamr/geometry/a.cpp", SPDX + '#include "pamr/mesh/tet.hpp"\n',
                           "geometry must not include mesh")

    def test_the_library_must_not_know_its_tools(self):
        self.assert_caught("lib/pamr/adapt/a.cpp", SPDX + '#include "cli/session.hpp"\n', "adapt must not include cli")

    def test_a_case_must_not_use_another(self):
        spdx = "# SPDX-License-Identifier: GPL-3.0-or-later\n"
        self.assert_caught("cases/rod/run.sh", spdx + '"$root/cases/spheres/loop.sh"\n', ":2:", "a case uses nothing of another (spheres)")
        self.assert_caught("cases/rod/run.sh", spdx + '"$case_folder/../spheres/loop.sh"\n', "(spheres)")
        self.assert_caught("cases/rod/run.py", spdx + 'HERE.parent / "spheres" / "loop.sh"\n', "(spheres)")
        self.assert_clean("cases/rod/run.sh", spdx + '"$root/cases/loop.sh" "$root/cases/rod/a" # cases/spheres/\n. ../start.sh ../../scripts/b\n')
        self.assert_clean("studies/rod/run.sh", spdx + '"$root/cases/spheres/loop.sh"\n')

    def test_solvers_must_not_refine(self):
        self.assert_caught("lib/solvers/dsmc/run/a.cpp", SPDX + '#include "pamr/refine/close.hpp"\n',
                           "dsmc must not include refine")
        self.assert_caught("lib/solvers/dsmc/run/a.cpp", SPDX + '#include "pamr/adapt/pass.hpp"\n',
                           "dsmc must not include adapt")
        self.assert_clean("lib/solvers/dsmc/run/a.cpp", SPDX + '#include "pamr/adapt/adapt.hpp"\n')
        self.assert_clean("tools/refine.cpp", SPDX + '#include "pamr/adapt/adapt.hpp"\n#include "cli/session.hpp"\n')

    def test_solvers_do_not_know_one_another_nor_the_refiner_them(self):
        self.assert_caught("lib/solvers/dsmc/run/a.cpp", SPDX + '#include "solvers/poisson_boltzmann/force.hpp"\n',
                           "dsmc must not include poisson_boltzmann")
        self.assert_caught("lib/pamr/adapt/a.cpp", SPDX + '#include "solvers/dsmc/gas/gas.hpp"\n',
                           "adapt must not include dsmc")
        self.assert_caught("lib/pamr/io/a.cpp", SPDX + '#include "meshing/mesh3.hpp"\n', "io must not include meshing")

    def test_meshing_must_not_refine(self):
        self.assert_caught("lib/meshing/a.cpp", SPDX + '#include "pamr/adapt/adapt.hpp"\n',
                           "meshing must not include adapt")

    def test_the_folders_of_a_solver_have_an_order(self):
        self.assert_caught("lib/solvers/dsmc/state/a.cpp", SPDX + '#include "solvers/dsmc/run/plan.hpp"\n', ":2:",
                           "dsmc/state must not include dsmc/run")
        self.assert_caught("lib/solvers/dsmc/gas/a.cpp", SPDX + '#include "solvers/dsmc/kernel/boundary.hpp"\n',
                           "dsmc/gas must not include dsmc/kernel")
        self.assert_caught("lib/solvers/poisson_boltzmann/fem/a.cpp",
                           SPDX + '#include "solvers/poisson_boltzmann/goals/functionals.hpp"\n',
                           "poisson_boltzmann/fem must not include poisson_boltzmann/goals")
        self.assert_clean("lib/solvers/dsmc/run/a.cpp", SPDX + '#include "solvers/dsmc/gas/gas.hpp"\n')
        self.assert_clean("lib/solvers/dsmc/state/a.cpp", SPDX + '#include "solvers/dsmc/state/hosts.hpp"\n')

    def test_a_file_of_a_solver_lies_in_one_of_its_folders(self):
        for name in ("lib/solvers/dsmc/attic/a.ipp", "lib/solvers/poisson_boltzmann/a.ipp"):
            self.assert_caught(name, SPDX, "one of its folders")

    def test_the_corners_of_faces_stand_once(self):
        for rows in ("123 032 013 021", "123 023 013 012"):
            table = "{" + ", ".join("{" + ", ".join(row) + "}" for row in rows.split()) + "}"
            self.assert_caught("lib/pamr/refine/a.ipp", SPDX + f"\nint a[4][3] = {table};\n", ":3:", "corners")
            self.assert_caught("tests/tools/a_test.py", f"# {SPDX}FACES = {table}\n", ":2:", "corners")
            self.assert_clean("lib/pamr/mesh/tet.hpp", SPDX + f"#pragma once\nnamespace pamr::mesh {{ int a[4][3] = {table}; }}\n")

    def test_petsc_and_mesh_3_have_one_place(self):
        self.assert_caught("lib/solvers/dsmc/run/a.cpp", SPDX + "#include <petscksp.h>\n", "PETSc")
        self.assert_clean("lib/solvers/poisson_boltzmann/fem/a.cpp", SPDX + "#include <petscksp.h>\n")
        self.assert_caught("geometry/pamr/geometry/a.cpp", SPDX + "#include <CGAL/Mesh_triangulation_3.h>\n", "Mesh_3")

    def test_relative_includes_are_caught(self):
        self.assert_caught("lib/pamr/mesh/a.cpp", SPDX + '#include "../par/comm.hpp"\n', "include folder")

    def test_mpi_is_called_in_par_only(self):
        call = SPDX + "int f() { return MPI_Barrier(c); }\n"
        self.assert_caught("lib/pamr/mesh/a.cpp", call, "MPI is called in lib/pamr/par only")
        self.assert_caught("tools/refine.cpp", call, "MPI is called")
        self.assert_clean("lib/pamr/par/a.cpp", call)
        self.assert_clean("lib/pamr/mesh/a.cpp", SPDX + "// MPI_Barrier(c) is called elsewhere\nMPI_Comm comm;\n")

    def test_processes_are_started_before_mpi_only(self):
        for call in ("fork()", "popen(command, mode)", 'std::system("gmsh")', "posix_spawnp(a, b, c, d, e, f)"):
            self.assert_caught("lib/pamr/io/a.cpp", SPDX + f"auto a = {call};\n", "before MPI starts")
        self.assert_clean("tools/cli/check_in_child.cpp", SPDX + "auto a = fork();\n")

    def test_scotch_has_one_place(self):
        text = SPDX + "#include <ptscotch.h>\n"
        self.assert_caught("lib/pamr/balance/graph.cpp", text, "Scotch")
        self.assert_clean("lib/pamr/balance/scotch_partition.cpp", text)

    def test_cgal_stays_in_geometry_sources_the_mesher_and_surface_meshes(self):
        include = "#include <CGAL/Kernel.h>\n"
        self.assert_caught("lib/pamr/check/a.cpp", SPDX + include, "CGAL")
        self.assert_caught("geometry/pamr/geometry/a.hpp",
                           SPDX + "#pragma once\n" + include + "namespace pamr::geometry {}\n", "CGAL")
        self.assert_clean("geometry/pamr/geometry/a.cpp", SPDX + include)
        self.assert_clean("lib/meshing/a.cpp", SPDX + include)
        self.assert_clean("lib/surface_mesh/a.cpp", SPDX + include)

    def test_openmesh_stays_with_the_surface_meshes(self):
        include = "#include <OpenMesh/Core/IO/MeshIO.hh>\n"
        for place in ("lib/pamr/check/a.cpp", "geometry/pamr/geometry/a.cpp", "lib/meshing/a.cpp"):
            self.assert_caught(place, SPDX + include, "OpenMesh")
        self.assert_clean("lib/surface_mesh/a.cpp", SPDX + include)

    def test_pugixml_stays_with_the_files_of_vtk(self):
        include = "#include <pugixml.hpp>\n"
        for place in ("lib/pamr/io/medit/a.cpp", "lib/pamr/check/a.cpp", "tools/a.cpp"):
            self.assert_caught(place, SPDX + include, "pugixml")
        self.assert_clean("lib/pamr/io/vtk/a.cpp", SPDX + include)

    def test_opencascade_stays_with_cad(self):
        include = "#include <TopoDS_Face.hxx>\n"
        for place in ("lib/meshing/a.cpp", "geometry/pamr/geometry/a.cpp", "tools/a.cpp"):
            self.assert_caught(place, SPDX + include, "OpenCASCADE")
        self.assert_clean("geometry/pamr/geometry/cad/a.cpp", SPDX + include)

    def test_files_have_at_most_500_lines(self):
        self.assert_clean("lib/pamr/par/a.cpp", SPDX + "\n" * 499)
        self.assert_caught("lib/pamr/par/a.cpp", SPDX + "\n" * 500, "500 lines")

    def test_names_stand_once_and_sources_have_their_header(self):
        found = list(layers.name_violations(["lib/pamr/io/a.hpp", "lib/pamr/io/a.cpp", "lib/pamr/mark/a.hpp",
                                             "tools/pamr_b.cpp", "tests/a.hpp", "tests/b.cpp", "lib/pamr/io/c.cpp"]))
        self.assertEqual(found, ["lib/pamr/mark/a.hpp:1: a file name stands once: there is lib/pamr/io/a.hpp too",
                                 "lib/pamr/io/c.cpp:1: a source has the header of its name beside it"])

    def test_functions_have_at_most_80_lines(self):
        for indent, end in (("", "\n"), ("  ", "\n};\n")):
            head = SPDX + ("struct S {\n" if indent else "") + "/// One.\n"
            body = [f"{indent}int f(int a,", f"{indent}      int b) {{"] + [f"{indent}  a += b;"] * 76
            self.assert_clean("lib/pamr/par/a.cpp", head + "\n".join(body + [indent + "  return a;", indent + "}"]) + end)
            body.append(f"{indent}  a += b;")
            self.assert_caught("lib/pamr/par/a.cpp",
                               head + "\n".join(body + [indent + "  return a;", indent + "}"]) + end, "80 lines")
        table = "constexpr int a[] = {\n" + "  1,\n" * 90 + "};\n"
        self.assert_clean("lib/pamr/par/a.cpp", SPDX + "namespace pamr::par {\n" + table + "}  // namespace pamr::par\n")

    def test_functions_of_headers_have_at_most_5_parameters(self):
        def header(declaration):
            return SPDX + f"#pragma once\nnamespace pamr::refine {{\n{declaration}\n}}\n"

        name = "lib/pamr/refine/a.hpp"
        pair = "const std::pair<A, B>& p = {1, 2}"
        self.assert_clean(name, header(f"int f(int a, B* b, {pair},\n      std::span<const C> s, D&& d);"))
        self.assert_caught(name, header(f"int f(int a, B* b, {pair},\n      std::span<const C> s, D&& d, E e);"),
                           ":4:", "5 parameters, this one has 6")
        self.assert_caught(name, header("struct S {\n  S(int a, int b, int c, int d, int e, int f) {}\n};"),
                           ":5:", "5 parameters")
        self.assert_clean(name, header("inline int f() { return g(a, b, at(c), d[0], sizeof(E), 1, f.h); }"))
        self.assert_clean("lib/pamr/refine/b.hpp", header("int f(int a /* b, c, d, e, g */);"))

    def test_the_license_is_named_in_every_kind_of_file(self):
        for name in ("lib/pamr/par/a.cpp", "tests/a.py", "cases/x/run.sh", "tests/CMakeLists.txt", "cmake/a.cmake"):
            self.assert_caught(name, "\n", "license")

    def test_headers_have_pragma_once_and_their_namespace(self):
        self.assert_caught("lib/pamr/par/a.hpp", SPDX + "namespace pamr::par {}\n", "#pragma once")
        self.assert_caught("lib/pamr/par/a.hpp", SPDX + "#pragma once\nnamespace pamr {}\n", "namespace pamr::par")

    def test_names_that_say_nothing_are_caught(self):
        self.assert_caught("lib/pamr/refine/utils/a.hpp", REFINE_HEADER, "'utils'")
        self.assert_caught("lib/pamr/refine/helpers.hpp", REFINE_HEADER, "'helpers'")

    def test_globs_are_caught(self):
        self.assert_caught("lib/CMakeLists.txt", "# " + SPDX + "file(GLOB x *.cpp)\n", "globs")

    def test_links_to_nowhere_are_caught(self):
        self.assert_caught("docs/a.md", "[b](b.md) and [itself](a.md#words), [far](https://example.org/c.md)\n", "b.md")

    def test_the_program_fails_with_code_1_when_there_is_a_violation(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "a.cpp").write_text("int x;\n")
            old, sys.argv = sys.argv, ["layers.py", folder]
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                code = layers.main()
            sys.argv = old
            self.assertEqual(code, 1)
            self.assertIn("a.cpp:1:", printed.getvalue())


if __name__ == "__main__":
    unittest.main()
