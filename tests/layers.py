#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Enforces who may include whom, where third parties may appear, the form of files, and that links lead somewhere.

Usage: layers.py ROOT    lists every violation under ROOT as FILE:LINE: rule; exit code 1 when there is one.
The rules are the tables below; layers_test.py breaks each of them.
"""
import pathlib
import re
import sys

VALUES = ("base", "par", "geometry", "mesh")
MESH_AT_REST = VALUES + ("assemble", "order", "validate")
STAGES = ("locate", "io", "mark", "refine", "check", "balance")
REFINER = MESH_AT_REST + STAGES + ("coarsen", "curved", "adapt")
SOLVERS = ("dsmc", "poisson_boltzmann")

# Module of a file -> modules whose headers it may include as well as its own.
MAY_INCLUDE = {
    "base": (),
    "geometry": ("base",),
    "par": ("base",),
    "mesh": ("base", "par", "geometry"),
    **{module: VALUES for module in ("assemble", "validate")},
    "order": VALUES + ("assemble",),
    "pamr": MESH_AT_REST + ("locate", "io", "mark", "refine", "check", "balance", "coarsen", "curved", "adapt"),  # pamr.hpp
    **{stage: MESH_AT_REST for stage in STAGES},
    "check": MESH_AT_REST + ("locate",),
    **{user: MESH_AT_REST + ("refine",) for user in ("coarsen", "curved")},
    "adapt": REFINER,
    "meshing": MESH_AT_REST + ("io", "check"),
    "surface_mesh": ("base", "geometry"),
    **{solver: MESH_AT_REST + ("locate", "io", "mark", "check", "balance", "curved", "adapt/adapt.hpp",
                               "adapt/flags.hpp", "adapt/forecast.hpp") for solver in SOLVERS},
    "cli": ("base", "par", "geometry", "io"),
    "python": REFINER + ("meshing",),
    "tools": REFINER + SOLVERS + ("meshing", "surface_mesh", "cli"),
}

# Folders of a solver from the ground up: a file includes headers of its own folder and of those before it.
FLOORS = {
    "dsmc": ("gas", "kernel", "sampling", "flow", "state", "run"),
    "poisson_boltzmann": ("problem", "fem", "goals", "report"),
}

# What only some places may hold: pattern of the line, pattern of the places, rule. Tests are free to use an oracle.
CORNERS = (
    (re.compile(r"\bMPI_[A-Z][a-z]\w*\s*\("), re.compile(r"lib/pamr/par/"), "MPI is called in lib/pamr/par only"),
    (re.compile(r"#\s*include\s*[<\"](pt)?scotch"), re.compile(r"lib/pamr/balance/scotch_partition\.cpp$"),
     "Scotch is included in balance/scotch_partition.cpp only"),
    (re.compile(r"#\s*include\s*[<\"]CGAL/"),
     re.compile(r"geometry/.*\.cpp$|lib/meshing/(.*\.cpp|searched_domain\.hpp)$|lib/surface_mesh/"),
     "CGAL is included in geometry/**/*.cpp, lib/meshing/**/*.cpp, its searched_domain.hpp and lib/surface_mesh only"),
    (re.compile(r"#\s*include\s*[<\"]pugixml"), re.compile(r"lib/pamr/io/vtk/"), "pugixml is included in lib/pamr/io/vtk only"),
    (re.compile(r"#\s*include\s*[<\"]OpenMesh/"), re.compile(r"lib/surface_mesh/"),
     "OpenMesh is included in lib/surface_mesh only"),
    (re.compile(r"#\s*include\s*[<\"]CGAL/(Mesh|make_mesh|exude_mesh|Labeled_mesh)_"),
     re.compile(r"lib/meshing/(.*\.cpp|searched_domain\.hpp)$"),
     "CGAL's Mesh_3 is included in lib/meshing only"),
    (re.compile(r"#\s*include\s*<\w+\.hxx>"), re.compile(r"geometry/pamr/geometry/cad/"),
     "OpenCASCADE is included in geometry/cad only"),
    (re.compile(r"#\s*include\s*[<\"]petsc"), re.compile(r"lib/solvers/poisson_boltzmann/"),
     "PETSc is included in lib/solvers/poisson_boltzmann only"),
    (re.compile(r"\b(v?fork|popen|posix_spawnp?)\s*\(|\bstd::system\s*\("), re.compile(r"tools/cli/check_in_child\.cpp$"),
     "processes are started in tools/cli/check_in_child.cpp only, before MPI starts"),
)
# The corners of a tetrahedron's faces stand once for C++ and once for Python. Checkers that know nothing of PAMR's code,
# programs of other meshers and drawings have their own.
FACE_TABLE = re.compile(r"1, 2, 3\W+0, (3, 2|2, 3)\W+0, 1, 3\W+0, (2, 1|1, 2)\W")
FACE_TABLES = ("tet.hpp", "tet.py")
OWN_TABLES = {"drawings", "strangers", "bench"}  # folders
FACE_RULE = "the corners of a tetrahedron's faces stand in mesh/tet.hpp and tools/picture/tet.py"
MAX_LINES = 500
MAX_FUNCTION = 80
MAX_PARAMETERS = 5
MANY_PARAMETERS = re.compile(r"lib/pamr/curved/straighten\.hpp$")  # a header that still has a function with more
SOURCE = (".cpp", ".hpp", ".ipp", ".c", ".h")
WITH_LICENSE = SOURCE + (".py", ".sh", ".cmake", ".in")
FORBIDDEN_NAMES = {"utils", "util", "common", "misc", "helpers", "helper", "manager"}
NOT_OURS = {"build", "out", "__pycache__"}
OWN_INCLUDE = re.compile(r'#\s*include\s*["<](?:pamr/|solvers/)?([\w.]+)/([^">]*)[">]')
MARKDOWN_LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
OTHER_CASE = re.compile(r'(?:cases/|(?<!\.\./)\.\./|\.parent / ")([a-z][\w-]*)(?:/|" /)')
RELATIVE_INCLUDE = re.compile(r'#\s*include\s*"[^"]*\.\./')


def files_of(root):
    for path in sorted(root.iterdir()):
        if path.is_dir():
            if path.name not in NOT_OURS and (not path.name.startswith(".") or path.name == ".ci"):
                yield from files_of(path)
        else:
            yield path


def without_comments(text):
    """The text with comments blanked, line numbers kept."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)


def module_of(name):
    """Module of a product file, or nothing for files that are free (tests, cases)."""
    parts = name.split("/")
    if parts[0] == "geometry" and len(parts) > 3:
        return "geometry"
    if parts[:2] == ["lib", "pamr"] and len(parts) > 3:
        return parts[2]
    if parts[:2] == ["lib", "solvers"] and len(parts) > 3:
        return parts[2]
    if parts[0] == "lib" and len(parts) > 2:
        return parts[1]
    if parts[0] == "tools":
        return "cli" if parts[1] == "cli" else "tools"
    return None


def include_violations(name, lines):
    module = module_of(name)
    for number, line in enumerate(lines, 1):
        if RELATIVE_INCLUDE.search(line):
            yield number, "includes are written from the include folder, not with .."
        match = OWN_INCLUDE.search(line)
        if not module or not match or match.group(1) not in MAY_INCLUDE:
            continue
        allowed = MAY_INCLUDE.get(module, ())
        other, header = match.groups()
        if other != module and other not in allowed and f"{other}/{header}" not in allowed:
            yield number, f"{module} must not include {other}"
        if other == module and module in FLOORS:
            mine, floor = name.split("/")[3], header.split("/")[0]
            if mine in FLOORS[module] and floor not in FLOORS[module][:FLOORS[module].index(mine) + 1]:
                yield number, f"{module}/{mine} must not include {module}/{floor}"


def corner_violations(name, lines):
    if not module_of(name):
        return
    for number, line in enumerate(lines, 1):
        for pattern, places, rule in CORNERS:
            if pattern.search(line) and not places.match(name):
                yield number, rule


def form_violations(name, text):
    path = pathlib.PurePosixPath(name)
    head = text.splitlines()[:2]
    has_license = path.suffix in WITH_LICENSE or path.name == "CMakeLists.txt" or name == ".ci/run"
    if has_license and not any("SPDX-License-Identifier: GPL-3.0-or-later" in line for line in head):
        yield 1, "the first line names the license: SPDX-License-Identifier: GPL-3.0-or-later"
    if path.suffix in SOURCE and text.count("\n") > MAX_LINES:
        yield text.count("\n"), f"a source file has at most {MAX_LINES} lines"
    if path.suffix == ".hpp" and "#pragma once" not in text:
        yield 1, "a header has #pragma once"
    for part in list(path.parts[:-1]) + [path.stem]:
        if part in FORBIDDEN_NAMES:
            yield 1, f"'{part}' says nothing; name the file or folder after what it holds"
    module = module_of(name)
    if module and path.suffix == ".hpp" and module != "tools":
        if module == "pamr":  # the header that includes the others
            return
        space = "pamr" if module == "base" else f"pamr::{module}"
        if not re.search(rf"\bnamespace {space}\b", text):
            yield 1, f"folder and namespace agree: namespace {space}"
    if path.name == "CMakeLists.txt" or path.suffix == ".cmake":
        for number, line in enumerate(text.splitlines(), 1):
            if re.search(r"\bGLOB(_RECURSE)?\b|\bCMAKE_(SOURCE|BINARY)_DIR\b", line):
                yield number, "no globs and no CMAKE_SOURCE_DIR: targets and listed files only"


def function_violations(lines):
    """Functions that are too long, by the layout of clang-format: a body ends where a brace stands alone in the column in
    which the signature began. Tables and types end with a brace and a semicolon, namespaces with a comment."""
    for indent in ("", "  "):
        start = 0
        for number, line in enumerate(lines, 1):
            if line.rstrip() == indent + "}":
                if number - start + 1 > MAX_FUNCTION:
                    yield start, f"a function has at most {MAX_FUNCTION} lines, this one has {number - start + 1}"
            elif re.match(indent + r"[^\s#}/]", line):
                start = number


def parameter_violations(text):
    """Functions of a header with too many parameters. What stands in parentheses are parameters, and not the arguments
    of a call, where each of its parts is a type and a name."""
    for match in re.finditer(r"\w\s*\(", text):
        parts, depth = [""], 0
        for character in text[match.end():]:
            depth += (character in "([{<") - (character in ")]}>")
            if depth < 0:
                break
            if character == "," and depth == 0:
                parts.append("")
            else:
                parts[-1] += character
        if len(parts) > MAX_PARAMETERS and all(re.match(r"\s*[\w:][^=]*[\s*&]\w+\s*(=|$)", part) for part in parts):
            number = text.count("\n", 0, match.start()) + 1
            yield number, f"a function has at most {MAX_PARAMETERS} parameters, this one has {len(parts)}"


def folder_violations(name):
    """Every file of a solver lies in one of its folders."""
    module, parts = module_of(name), name.split("/")
    if module in FLOORS and parts[-1] != "CMakeLists.txt" and parts[3] not in FLOORS[module]:
        yield 1, f"a file of {module} lies in one of its folders: {', '.join(FLOORS[module])}"


def name_violations(names):
    """Of the product's files: each name stands once, and each source has the header of its name beside it; no_NAME.cpp, which takes the
    place of NAME.cpp in builds without a library, that of NAME."""
    first = {}
    product = [pathlib.PurePosixPath(n) for n in names if module_of(n) and pathlib.PurePosixPath(n).suffix in SOURCE]
    for path in product:
        if path.name in first:
            yield f"{path}:1: a file name stands once: there is {first[path.name]} too"
        first.setdefault(path.name, path)
        is_main = (path.parts[0] == "tools" and len(path.parts) == 2) or str(path) == "lib/python/module.cpp"
        header = path.with_name(path.stem.removeprefix("no_") + ".hpp")
        if path.suffix == ".cpp" and not is_main and header not in product:
            yield f"{path}:1: a source has the header of its name beside it"


def case_violations(name, lines):
    """Of the scripts of a case: what cases share lies beside their folders."""
    parts = name.split("/")
    if parts[0] != "cases" or len(parts) < 3:
        return
    for number, line in enumerate(lines, 1):
        for other in OTHER_CASE.findall(line.split("#")[0]):
            if other != parts[1]:
                yield number, f"a case uses nothing of another ({other}): move what both need to cases/"


def link_violations(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        for target in MARKDOWN_LINK.findall(line):
            if ":" not in target and not (path.parent / target).exists():
                yield number, f"the link leads nowhere: {target}"


def violations(root):
    yield from name_violations([path.relative_to(root).as_posix() for path in files_of(root)])
    for path in files_of(root):
        name = path.relative_to(root).as_posix()
        if path.suffix == ".md":
            for number, rule in link_violations(path):
                yield f"{name}:{number}: {rule}"
        if path.suffix not in WITH_LICENSE and path.name != "CMakeLists.txt" and name != ".ci/run":
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        found = list(form_violations(name, text)) + list(folder_violations(name))
        found += list(case_violations(name, text.splitlines()))
        table = FACE_TABLE.search(text)
        if table and path.name not in FACE_TABLES and not OWN_TABLES & set(name.split("/")):
            found.append((text[:table.start()].count("\n") + 1, FACE_RULE))
        if path.suffix in SOURCE:
            lines = without_comments(text).splitlines()
            found += list(include_violations(name, lines)) + list(corner_violations(name, lines))
            found += list(function_violations(text.splitlines())) if module_of(name) else []
            if module_of(name) and path.suffix == ".hpp" and not MANY_PARAMETERS.match(name):
                found += list(parameter_violations("\n".join(lines)))
        for number, rule in sorted(found):
            yield f"{name}:{number}: {rule}"


def main():
    root = pathlib.Path(sys.argv[1])
    found = list(violations(root))
    print("\n".join(found) if found else "layers: no violation")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
