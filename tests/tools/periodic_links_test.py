# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of Gmsh with periodic links: they are not kept, and that is said where it is read and wherever it is refined."""
import pathlib

import h5py

from tool_run import refuses, run, run_tests, same_bytes


def periodic_box():
    """A box whose sides along x and along z are linked, in all of Gmsh's formats that are read."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    sides = {}
    for _, tag in gmsh.model.getEntities(2):
        x = gmsh.model.occ.getCenterOfMass(2, tag)
        axis = max(range(3), key=lambda k: abs(x[k] - 0.5))
        sides["xyz"[axis] + ("min" if x[axis] < 0.5 else "max")] = tag
    for axis, shift in (("x", (1, 0, 0)), ("z", (0, 0, 1))):
        affine = [1, 0, 0, shift[0], 0, 1, 0, shift[1], 0, 0, 1, shift[2], 0, 0, 0, 1]
        gmsh.model.mesh.setPeriodic(2, [sides[axis + "max"]], [sides[axis + "min"]], affine)
    gmsh.model.addPhysicalGroup(3, [1])
    for name, tag in sides.items():
        gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, [tag]), name)
    gmsh.model.mesh.generate(3)
    names = []
    for version in (2.2, 4.1):
        for binary in (0, 1):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            names.append(f"box{version}{'b' if binary else 't'}.msh")
            gmsh.write(names[-1])
    gmsh.finalize()
    return names


SAYS = "patches 'xmax', 'xmin', 'zmax', 'zmin' are periodic, but the links are not kept"


def said(result):
    """The remark with its patches in the order of their names."""
    assert result.err.count("are periodic") == 1, result.err
    line = next(line for line in result.err.splitlines() if "are periodic" in line)
    names, rest = line.split("patches ")[1].split(" are periodic")
    return f"patches {', '.join(sorted(names.split(', ')))} are periodic{rest}"


def test_periodic_links_are_said_when_they_are_read_and_when_the_mesh_is_refined():
    for name in periodic_box():
        told = run("pamr-convert", name, name + ".hdf", "--json", "report.json")
        assert said(told).startswith(SAYS) and '"periodic_links": 2' in pathlib.Path("report.json").read_text()
        run("pamr-convert", name, "serial.hdf", "--force", "--quiet", serial=True)
        assert same_bytes("serial.hdf", name + ".hdf")
        refuses("pamr-convert", name, "strict.hdf", "--strict", says=["no periodic links, found 2"], creates="strict.hdf")
    with h5py.File(name + ".hdf") as file:
        kinds = dict(zip((n.decode() for n in file["PAMR/patches/names"]), (k.decode() for k in file["PAMR/patches/kinds"])))
    assert kinds == {"xmin": "periodic", "xmax": "periodic", "ymin": "", "ymax": "", "zmin": "periodic", "zmax": "periodic"}
    mesh = name + ".hdf"
    for level in (1, 2):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--patch", "xmin", "--force", "--quiet")
        mesh = f"level{level}.hdf"
        assert said(run("pamr-refine", "marked.hdf", "-o", mesh, "--quiet")).startswith(SAYS)
    run("pamr-convert", mesh, "case", "--quiet")
    assert "periodic" not in pathlib.Path("case/constant/polyMesh/boundary").read_text(), "plain patches for OpenFOAM"


def test_a_damaged_list_of_links_is_refused_with_its_line():
    text = pathlib.Path(periodic_box()[0]).read_text()
    here = text.index("$Periodic")
    for old, new in (("\n2\n", "\n3\n"), ("\n2\n", "\n-2\n"), ("$EndPeriodic", "")):
        pathlib.Path("bad.msh").write_text(text[:here] + text[here:].replace(old, new, 1))
        refuses("pamr-convert", "bad.msh", "bad.hdf", says=["bad.msh", "expected"], creates="bad.hdf")


run_tests(globals())
