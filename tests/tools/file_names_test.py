#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""No output of a tool is one of its inputs or another output, whatever their names: for all tools, all pairs of files.

Each refusal leaves every file as it was and makes none, also with --force.
"""
import itertools
import os
import pathlib
import shutil

from gas_cases import NITROGEN, gas_in_a_cube
from surface_models import icosphere, write_stl
from tool_run import kuhn_cube, prepare_alone, refuses, run, run_tests

prepare_alone("pamr-mark", "pamr-convert", "pamr-dsmc", "pamr-refine")

DATA = pathlib.Path(__file__).parent / "data"
FOREIGN = (".vtu", ".msh", ".mesh", ".csv", ".json", ".html", ".toml", ".stl", ".png")  # not of a native output
SURFACE = '[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "body.stl"\n'


def write(name, text):
    pathlib.Path(name).write_text(text, encoding="ascii")
    return name


def snapshot():
    """Every file and link here, with its contents."""
    return {str(path): (path.lstat().st_ino, os.readlink(path) if path.is_symlink() else path.read_bytes())
            for path in pathlib.Path().glob("**/*") if path.is_symlink() or path.is_file()}


spelling = itertools.cycle((
    lambda name: "./" + name, lambda name: "sub/../" + name, lambda name: "here/" + name, os.path.abspath,
    lambda name: "here/sub/.././" + name))
n_links = itertools.count()


def other_name(file, option, ending):
    """Another name of a file, as this option takes it: by turns in all ways in which a file has two names."""
    native = option == "-o" and ending == ".hdf" and os.path.splitext(file)[1] not in FOREIGN
    if ending is None or file.endswith(ending) or native:
        return next(spelling)(file)
    number = next(n_links)
    link = f"link{number}{ending}"
    (os.link if number % 2 else os.symlink)(file, link)
    return link


def refuse_all_pairs(command, inputs, outputs):
    """`outputs`: options ("" for an argument after `command`) and how their names have to end, or None."""
    os.makedirs("sub", exist_ok=True)
    if not os.path.islink("here"):
        os.symlink(".", "here")
    names = {option: f"new{i}{ending or ''}" for i, (option, ending) in enumerate(outputs.items())}

    def try_names(names, says):
        files = snapshot()
        words = [word for option, name in names.items() for word in ((option, name) if option else (name,))]
        refuses(*command, *words, "--force", says=["expected an output of its own", *says])
        assert snapshot() == files, sorted(set(files) ^ set(snapshot()))

    for (option, ending), file in itertools.product(outputs.items(), inputs):
        name = other_name(file, option, ending)
        try_names(names | {option: name}, [name, "same file as the input"])
    for (one, ending), (other, other_ending) in itertools.combinations(outputs.items(), 2):
        if ending and other_ending and ending != other_ending:
            continue
        file = f"new{ending or other_ending or ''}"
        try_names(names | {one: file, other: next(spelling)(file)}, ["same file as the output"])


def test_tools_that_look_at_a_mesh_and_write_it():
    kuhn_cube("level0.hdf", 2)
    run("pamr-mark", "level0.hdf", "-o", "mesh.hdf", "--all", "--quiet")
    both = {"-o": ".hdf", "--json": None}
    refuse_all_pairs(["pamr-mark", "mesh.hdf", "--all"], ["mesh.hdf"], both)
    refuse_all_pairs(["pamr-refine", "mesh.hdf"], ["mesh.hdf"], both)
    refuse_all_pairs(["pamr-partition", "mesh.hdf", "-p", 2], ["mesh.hdf"], both)
    refuse_all_pairs(["pamr-quality", "mesh.hdf", "level0.hdf"], ["mesh.hdf", "level0.hdf"],
                     {"--csv": ".csv", "--html": ".html", "--json": None})
    refuse_all_pairs(["pamr-quality", "mesh.hdf", "--worst", 3], ["mesh.hdf"],
                     {"--worst-out": ".hdf", "--csv": ".csv", "--html": ".html", "--json": None})
    files = snapshot()
    refuses("pamr-diff", "mesh.hdf", "level0.hdf", "--json", "./level0.hdf", says=["same file as the input level0.hdf"])
    assert snapshot() == files


def test_pictures():
    kuhn_cube("mesh.hdf", 1)
    # the picture may have the name of no mesh, but for a link
    os.symlink("mesh.hdf", "link.png")
    files = snapshot()
    for names in (("-o", "link.png"), ("-o", "new.png", "--json", "./mesh.hdf"), ("-o", "new.png", "--json", "./new.png")):
        refuses("pamr-picture", "mesh.hdf", *names, "--force", says=["expected an output of its own"])
        assert snapshot() == files
    refuses("pamr-picture", "mesh.hdf", "-o", "new.png", "--json", "none/x.json", says=["existing folder"], creates="new.png")


def test_makers_of_meshes_and_surfaces():
    write_stl("body.stl", *icosphere(0))
    shutil.copy(DATA / "can.step", "can.step")
    write("case", '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-body"\nbounds = [[-2, -2, -2], [2, 2, 2]]\n'
          "[mesh.sizes]\nfar = 1\n" + SURFACE)
    both = {"-o": ".hdf", "--json": None}
    refuse_all_pairs(["pamr-mesh", "case"], ["case", "body.stl"], both)
    refuse_all_pairs(["pamr-mesh", "can.step"], ["can.step"], both)
    refuse_all_pairs(["pamr-surface", "repair", "body.stl"], ["body.stl"], {"-o": ".stl", "--json": None})


def test_the_potential():
    kuhn_cube("mesh.hdf", 2)
    write_stl("body.stl", *icosphere(0))
    sides = "".join(f'[boundary.{side}]\nkind = "symmetry"\n' for side in ("xmin", "xmax", "ymin", "ymax", "zmax"))
    write("case", '[boundary.zmin]\nkind = "potential"\nvalue = 1.0\n' + sides + SURFACE)
    refuse_all_pairs(["pamr-pb", "case", "--mesh", "mesh.hdf"], ["case", "mesh.hdf", "body.stl"],
                     {"-o": ".hdf", "--surface": ".vtu", "--json": None})


def test_converted_meshes_with_surfaces_and_fields():
    kuhn_cube("mesh.hdf", 1)
    write_stl("body.stl", *icosphere(0))
    shutil.copy(DATA / "can.step", "can.step")
    write("surfaces", SURFACE)
    refuse_all_pairs(["pamr-convert", "mesh.hdf", "--surfaces", "surfaces", "--cad", "can.step"],
                     ["mesh.hdf", "surfaces", "body.stl", "can.step"], {"": ".hdf", "--json": None})
    refuse_all_pairs(["pamr-convert", "mesh.hdf", "--surface", "body.stl", "--patch", "xmin"], ["mesh.hdf", "body.stl"],
                     {"": ".hdf", "--json": None})
    run("pamr-convert", "mesh.hdf", "m.mesh")
    write("m.sol", "MeshVersionFormatted 2\nDimension 3\nEnd\n")
    refuse_all_pairs(["pamr-convert", "m.mesh", "--sol-in", "m.sol"], ["m.mesh", "m.sol"], {"": ".hdf", "--json": None})
    refuse_all_pairs(["pamr-convert", "mesh.hdf"], ["mesh.hdf"], {"": ".mesh", "--sol-out": ".sol", "--json": None})


def test_the_conditions_beside_a_mesh_of_ugrid():
    kuhn_cube("mesh.hdf", 1)
    run("pamr-convert", "mesh.hdf", "m.lb8.ugrid")
    assert os.path.exists("m.mapbc")
    files = snapshot()
    for command, file in ((["m.lb8.ugrid", "o.hdf", "--json", "./m.mapbc"], "m.mapbc"),
                          (["mesh.hdf", "o.lb8.ugrid", "--json", "./o.mapbc"], "o.mapbc")):
        refuses("pamr-convert", *command, "--force", says=["expected an output of its own", file])
        assert snapshot() == files
    os.mkdir("sub")
    os.symlink("../m.mapbc", "sub/m.mapbc")
    files = snapshot()
    refuses("pamr-convert", "m.lb8.ugrid", "sub/m.lb8.ugrid", "--force", says=["sub/m.mapbc", "the input m.mapbc"])
    assert snapshot() == files


def test_a_folder_that_is_replaced_holds_no_input_and_no_other_output():
    kuhn_cube("mesh.hdf", 1)
    run("pamr-convert", "mesh.hdf", "case")
    mesh = "case/constant/polyMesh"
    shutil.copy("mesh.hdf", f"{mesh}/mesh.hdf")
    write(f"{mesh}/surfaces", SURFACE)
    write("surfaces", SURFACE.replace("body.stl", f"{mesh}/body.stl"))
    write_stl(f"{mesh}/body.stl", *icosphere(0))
    os.symlink("case", "link")
    os.symlink(f"{mesh}/mesh.hdf", "away.hdf")
    os.symlink("../../../mesh.hdf", f"{mesh}/link.hdf")
    for words in ([f"{mesh}/mesh.hdf", "case"], ["link/constant/polyMesh/mesh.hdf", "case"], [f"{mesh}/mesh.hdf", "link/"],
                  ["away.hdf", "case"], [f"{mesh}/link.hdf", "case"], ["mesh.hdf", "case", "--json", f"{mesh}/new.json"],
                  ["mesh.hdf", "case", "--surfaces", f"{mesh}/surfaces"], ["mesh.hdf", "case", "--surfaces", "surfaces"],
                  ["mesh.hdf", "new", "--json", "./new"]):
        files = snapshot()
        refuses("pamr-convert", *words, "--force", says=["expected an output apart from inputs and other outputs"])
        assert snapshot() == files
    run("pamr-convert", "mesh.hdf", "case", "--json", "case/constant/new.json", "--force")  # beside it
    assert not os.path.exists(f"{mesh}/mesh.hdf") and os.path.exists("case/constant/new.json")


ADAPT = '[adapt]\nmark = "--size-over n_scale --ratio 0.15 --coarsen-below 0.1 --max-level 1"\n'


def gas_case(adapts=True):
    """A case that adapts its mesh every five steps; names a file of species that it reads and a surface that it does not."""
    text = gas_in_a_cube("", transient=0, sampling=20, end="window = 5\n" + (ADAPT if adapts else ""))
    write("species", NITROGEN)
    write_stl("body.stl", *icosphere(0))
    return write("case", text.replace("[gas]\n", '[gas]\nspecies_file = "species"\n') + SURFACE)


def compute(*more, mesh="mesh.hdf"):
    return ["pamr-dsmc", "case", "--mesh", mesh, *more]


GAS_OUTPUTS = {"-o": ".hdf", "--checkpoint": None, "--surface": ".vtu", "--lines": ".csv", "--history": ".csv", "--json": None}


def prepare_gas():
    """A checkpoint after 12 steps, and the mesh beside it."""
    kuhn_cube("mesh.hdf", 2)
    gas_case()
    run(*compute("-o", "first.hdf", "--checkpoint", "old", "--steps", 12, "--quiet"))
    assert os.path.exists("old-10.hdf"), os.listdir()


def test_the_gas_does_not_replace_what_it_reads():
    prepare_gas()
    refuse_all_pairs(compute("--restart", "old"), ["case", "mesh.hdf", "species", "body.stl", "old-10.hdf"], GAS_OUTPUTS)


def test_the_gas_keeps_the_checkpoint_that_it_starts_from():
    prepare_gas()
    outputs = {option: ending for option, ending in GAS_OUTPUTS.items() if option != "--checkpoint"}
    refuse_all_pairs(compute("--restart", "old"), ["old"], outputs)
    refuse_all_pairs(compute("--carry", "old"), ["old"], GAS_OUTPUTS)
    # but for the one that it goes on with, by any name
    os.symlink(".", "there")
    run(*compute("-o", "x.hdf", "--restart", "old", "--checkpoint", "there/./old", "--steps", 14, "--quiet"))
    run(*compute("-o", "y.hdf", "--restart", "old", "--checkpoint", "old", "--quiet"))
    assert sorted(path.name for path in pathlib.Path().glob("old*")) == ["old", "old-15.hdf"]


def test_files_of_a_series_are_outputs():
    prepare_gas()
    shutil.copy("mesh.hdf", "w-0000015.hdf")
    shutil.copy("mesh.hdf", "c-15.hdf")
    os.symlink("w-0000015.hdf", "link.hdf")
    for command in (compute("-o", "x.hdf", "--series", "./w", mesh="w-0000015.hdf"),
                    compute("-o", "x.hdf", "--series", "./w", mesh="link.hdf"),
                    compute("-o", "./w-0000020.hdf", "--series", "w"),
                    compute("-o", "x.hdf", "--series", "w", "--json", "w-0000005.hdf"),
                    compute("-o", "x.hdf", "--checkpoint", "./c", mesh="c-15.hdf"),
                    compute("-o", "c-5.hdf", "--checkpoint", "c"),
                    compute("-o", "x.hdf", "--checkpoint", "c", "--json", "./c-10.hdf"),
                    compute("-o", "x.hdf", "--checkpoint", "c", "--series", "./c")):
        files = snapshot()
        refuses(*command, "--force", says=["expected an output of its own"])
        assert snapshot() == files
    files = snapshot()
    refuses(*compute("-o", "x.hdf", "--checkpoint", "c"), says=["c-15.hdf", "--force"])  # would be replaced
    refuses(*compute("-o", "x.hdf", "--series", "w"), says=["w-0000015.hdf", "--force"])
    assert snapshot() == files
    gas_case(adapts=False)  # writes no meshes beside checkpoints
    run(*compute("-o", "x.hdf", "--checkpoint", "c", "--steps", 2, "--quiet", mesh="c-15.hdf"))


if __name__ == "__main__":
    run_tests(globals())
