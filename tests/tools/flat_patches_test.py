# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches that nobody described stay what they are beside a described one, from the import to the third refinement."""
import pathlib

import h5py
import numpy as np

from tool_run import run, run_tests, same_bytes

BALL = '[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [0.1, 0.2, 0.3]\nradius = 1.0\n'
PLANE = '[[surface]]\nname = "{}"\nkind = "plane"\npoint = {}\nnormal = {}\n'


def mesh_of(region, surfaces, near, file="made.msh"):
    """A mesh for Gmsh, so without surfaces, of a region in a box of side 4."""
    box = "".join(PLANE.format(f"{axis}{side}", [s * 2 * (a == k) for k in range(3)], [s * (a == k) for k in range(3)])
                  for a, axis in enumerate("xyz") for s, side in ((-1, "min"), (1, "max")) if axis + side != "zmin")
    inside = " & ".join(f"-{axis}{side}" for axis in "xyz" for side in ("min", "max") if axis + side != "zmin")
    pathlib.Path("case.toml").write_text(
        f'[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "{inside} & {region}"\nbounds = [[-2, -2, -2], [2, 2, 2]]\n'
        f"[mesh.sizes]\nfar = 1.2\nnear = {near}\n{box}{surfaces}")
    run("pamr-mesh", "case.toml", "-o", "made.hdf", "--quiet", serial=True)
    run("pamr-convert", "made.hdf", file, "--quiet", serial=True)


def points_of(mesh):
    """Coordinates of the nodes of each patch."""
    with h5py.File(mesh) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        neighbors, names = file["PAMR/cell_to_cell"][:], [name.decode() for name in file["PAMR/patches/names"][:]]
    result = {}
    for number, name in enumerate(names):
        cell, slot = np.nonzero(neighbors == -(number + 1))
        result[name] = points[np.unique([cells[cell, (slot + k) % 4] for k in (1, 2, 3)])]
    return result


def refined(mesh, patch, levels, **how):
    """The mesh after refinements at the patch, and what the tool said."""
    said = []
    for level in range(levels):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--patch", patch, "--force", "--quiet", **how)
        mesh = f"level{level + 1}{'s' if how else ''}.hdf"
        said.append(run("pamr-refine", "marked.hdf", "-o", mesh, "--quiet", **how).err)
    return mesh, said


def quality(mesh):
    return run("pamr-quality", mesh, "--json", "-", "--quiet").json["patches"]


def test_the_ground_stays_flat_where_a_ball_stands_in_it():
    mesh_of("+ground & +ball", BALL + PLANE.format("ground", [0, 0, 0], [0, 0, 1]), "{ ball = 0.6 }")
    pathlib.Path("ball.toml").write_text(BALL)

    report = run("pamr-convert", "made.msh", "level0.hdf", "--surfaces", "ball.toml", "--json", "-").json
    many, said = refined("level0.hdf", "ball", 3)
    one, _ = refined("level0.hdf", "ball", 3, serial=True)

    assert report["planes"] == {"ground": {"surface": "plane of ground", "worst_distance": 0}}
    assert same_bytes(one, many) and said == ["", "", ""]
    points = points_of(many)
    assert (points["ground"][:, 2] == 0).all() and len(points["ground"]) > 300
    assert abs(np.linalg.norm(points["ball"] - [0.1, 0.2, 0.3], axis=1) - 1).max() < 1e-15
    patches = quality(many)
    assert patches["ground"]["surface"] == "plane of ground" and "flat" not in patches["ground"]
    assert patches["xmin"]["surface"] == "" and patches["xmin"]["flat"] is True
    assert patches["xmin"]["worst_plane_distance"] == 0 == patches["xmin"]["off_facets_nodes"]


def test_a_mesh_of_an_older_version_finds_the_same_plane():
    mesh_of("+ground & +ball", BALL + PLANE.format("ground", [0, 0, 0], [0, 0, 1]), "{ ball = 0.6 }")
    pathlib.Path("ball.toml").write_text(BALL)
    run("pamr-convert", "made.msh", "level0.hdf", "--surfaces", "ball.toml", "--quiet")
    with h5py.File("level0.hdf", "r+") as file:  # as if nobody had looked for planes
        names = [name.decode() for name in file["PAMR/patches/names"][:]]
        for dataset, value in (("PAMR/patches/surfaces", ["ball" if name == "ball" else "" for name in names]), ("PAMR/surfaces", BALL)):
            del file[dataset]
            file[dataset] = value
            file["PAMR/checksums"].attrs.pop(dataset)
    with h5py.File(refined("level0.hdf", "ball", 1)[0]) as file:
        first = file["PAMR/surfaces"][()]
    with h5py.File(refined("level1.hdf", "ball", 1, serial=True)[0]) as file:
        assert file["PAMR/surfaces"][()] == first and b'name = "plane of ground"' in first
    assert (points_of("level1.hdf")["ground"][:, 2] == 0).all() and (points_of("level1s.hdf")["ground"][:, 2] == 0).all()


def test_a_patch_that_continues_a_described_one_is_told_of_before_it_is_bent():
    # a rod with a round end, of which only the end is described
    rod = '[[surface]]\nname = "rod"\nkind = "revolution"\norigin = [0, 0, 0]\naxis = [0, 0, 1]\nprofile = [{ from = [1, 0], to = ' \
          '[0, 1], center = [0, 0] }, { from = [0, 1], to = [-3, 1] }]\n'
    mesh_of("+ground & -rod", rod + PLANE.format("ground", [0, 0, -2], [0, 0, 1]), "{ rod = 0.5 }", "one.msh")
    with h5py.File("made.hdf", "r+") as file:
        neighbors, points = file["PAMR/cell_to_cell"], file["VTKHDF/Points"][:]
        cells, names = file["VTKHDF/Connectivity"][:].reshape(-1, 4), [n.decode() for n in file["PAMR/patches/names"][:]]
        links = neighbors[:]
        for cell, slot in zip(*np.nonzero(links == -(names.index("rod") + 1))):
            if points[np.delete(cells[cell], slot), 2].mean() > 0:
                links[cell, slot] = -(len(names) + 1)
        neighbors[...] = links
        for dataset, value in (("names", names + ["end"]), ("kinds", [""] * (len(names) + 1)),
                               ("surfaces", [""] * len(names) + ["end"])):
            del file[f"PAMR/patches/{dataset}"]
            file[f"PAMR/patches/{dataset}"] = value
            file["PAMR/checksums"].attrs.pop(f"PAMR/patches/{dataset}")
        del file["PAMR/surfaces"]
        file["PAMR/surfaces"] = BALL.replace("ball", "end").replace("[0.1, 0.2, 0.3]", "[0, 0, 0]")
        for name in ("PAMR/surfaces", "PAMR/cell_to_cell"):
            file["PAMR/checksums"].attrs.pop(name)
    fine, said = refined("made.hdf", "end", 2)

    words = "patch 'rod' has no surface: "
    assert all(words in line and "continue patch 'end' smoothly" in line and "[[surface]]" in line for line in said)
    counts = [int(line.split(words)[1].split()[0]) for line in said]
    assert counts[0] >= 8 and counts[1] == 2 * counts[0], counts
    rod = quality(fine)["rod"]
    assert rod["flat"] is False and rod["off_facets_nodes"] == 3 * counts[0] and 1e-3 < rod["worst_off_facets"] < 0.1
    assert f"{3 * counts[0]} off the faces of a patch without a surface" in run("pamr-quality", fine).out


run_tests(globals())
