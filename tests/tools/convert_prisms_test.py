# SPDX-License-Identifier: GPL-3.0-or-later
"""Prisms, pyramids and quadrangles of other programs, cut into tetrahedra and triangles on request."""
import json
import pathlib
import struct
from dataclasses import dataclass, field

import h5py
import numpy as np

from tool_run import prepare_alone, refuses, run, run_tests, same_bytes

prepare_alone("pamr-convert", "pamr-mark", "pamr-quality")  # but where the ranks are named

PATCHES = {1: "bottom", 2: "x0", 3: "y0", 4: "y1", 5: "others"}
N_NODES = {"tetra": 4, "pyramid": 5, "wedge": 6, "triangle": 3, "quad": 4}
DIMENSION = {"tetra": 3, "pyramid": 3, "wedge": 3, "triangle": 2, "quad": 2}
TALL, WIDE, HIGH = 0.3, 0.25, 0.2  # of the stack of prisms, of the pyramids beside it, of the tetrahedra on it
VOLUME = TALL + TALL * WIDE / 3 + HIGH / 3
PIECES = {"wedge": 3, "pyramid": 2, "tetra": 1, "quad": 2, "triangle": 1}


@dataclass
class Mixed:
    points: np.ndarray
    elements: list = field(default_factory=list)  #: (type, nodes from 0 on in Gmsh's order, tag)

    def add(self, kind, nodes, tag):
        self.elements.append((kind, list(nodes), tag))

    def of(self, *kinds):
        return [element for element in self.elements if element[0] in kinds]


def layers(n=3, heights=(0, 0.1, TALL), seed=1):
    """Prisms over a triangulation of the unit square, pyramids on the quadrangles at x = 1, tetrahedra on top; nodes in no order."""
    dice = np.random.default_rng(seed)
    plane = [[i / n, j / n] for i in range(n + 1) for j in range(n + 1)]
    for point in plane:
        if 0 < point[0] < 1 and 0 < point[1] < 1:
            point[:] = np.array(point) + dice.uniform(-0.25, 0.25, 2) / n
    at = lambda i, j: i * (n + 1) + j
    triangles = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [(a, b, c), (a, c, d)] if dice.integers(2) else [(a, b, d), (b, c, d)]
    m, top = len(plane), len(heights) - 1
    mesh = Mixed([(*point, z) for z in heights for point in plane])
    for a, b, c in triangles:
        for k in range(top):
            low, up = [a + k * m, b + k * m, c + k * m], [a + k * m + m, b + k * m + m, c + k * m + m]
            turn = dice.integers(3)
            low, up = low[turn:] + low[:turn], up[turn:] + up[:turn]
            mesh.add("wedge", low + up if dice.integers(2) else [up[0], up[2], up[1], low[0], low[2], low[1]], 1)
        mesh.add("triangle", (a, c, b), 1)
        a, b, c, apex = a + top * m, b + top * m, c + top * m, len(mesh.points)
        x, y, z = np.mean([mesh.points[a], mesh.points[b], mesh.points[c]], axis=0)
        mesh.points.append((x, y, z + HIGH))
        mesh.add("tetra", (a, b, c, apex), 3)
        for u, v in ((a, b), (b, c), (c, a)):
            mesh.add("triangle", (u, v, apex), 5)
    for k in range(top):
        for i in range(n):
            for tag, (u, v) in {2: (at(0, i + 1), at(0, i)), 3: (at(i, 0), at(i + 1, 0)), 4: (at(i + 1, n), at(i, n)),
                                0: (at(n, i), at(n, i + 1))}.items():
                quad = [u + k * m, v + k * m, v + k * m + m, u + k * m + m]
                if tag:
                    mesh.add("quad", quad, tag)
                    continue
                apex = len(mesh.points)
                mesh.points.append(tuple(np.mean([mesh.points[q] for q in quad], axis=0) + [WIDE, 0, 0]))
                turn = dice.integers(4)
                mesh.add("pyramid", (quad[turn:] + quad[:turn]) + [apex], 2)
                for p, q in zip(quad, quad[1:] + quad[:1]):
                    mesh.add("triangle", (p, q, apex), 5)
    new = dice.permutation(len(mesh.points))
    points = np.empty((len(new), 3))
    points[new] = mesh.points
    return Mixed(points, [(kind, [int(new[p]) for p in nodes], tag) for kind, nodes, tag in mesh.elements])


def turned(kind, nodes):
    """The same cell seen in a mirror."""
    turn = {"wedge": [0, 2, 1, 3, 5, 4], "pyramid": [0, 3, 2, 1, 4]}[kind]
    return [nodes[k] for k in turn]


def with_one_turned(mesh, kind):
    place = next(i for i, element in enumerate(mesh.elements) if element[0] == kind)
    elements = list(mesh.elements)
    elements[place] = (kind, turned(kind, elements[place][1]), elements[place][2])
    return Mixed(mesh.points, elements)


# --- writers, one for each format

def rows(values, shift=0):
    return " ".join(str(value + shift) for value in values)


def write_msh(mesh, name, several=False):
    types = {"triangle": 2, "quad": 3, "tetra": 4, "wedge": 6, "pyramid": 7}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(PATCHES) + 1)]
    lines += [f'2 {tag} "{patch}"' for tag, patch in PATCHES.items()] + ['3 1 "layers"', "$EndPhysicalNames", "$Nodes", str(len(mesh.points))]
    lines += [f"{i + 1} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(mesh.points.tolist())] + ["$EndNodes", "$Elements"]
    elements = [(kind, nodes, tag, DIMENSION[kind] * 10 + tag) for kind, nodes, tag in mesh.elements]
    if several:  # side x0 is in the group of the bottom, too, and the prisms are in that of the tetrahedra
        elements += [(kind, nodes, 1 if kind == "quad" else 3, entity) for kind, nodes, tag, entity in elements
                     if (kind, tag) in (("quad", 2), ("wedge", 1))]
    lines += [str(len(elements))] + [f"{i + 1} {types[kind]} 2 {tag} {entity} {rows(nodes, 1)}"
                                     for i, (kind, nodes, tag, entity) in enumerate(elements)] + ["$EndElements", ""]
    pathlib.Path(name).write_text("\n".join(lines))


def write_msh_4(mesh, name):
    import gmsh

    types = {"triangle": 2, "quad": 3, "tetra": 4, "wedge": 6, "pyramid": 7}
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    entities = sorted({(DIMENSION[kind], tag) for kind, _, tag in mesh.elements})
    for dimension, tag in entities:
        gmsh.model.addDiscreteEntity(dimension, tag)
        group = gmsh.model.addPhysicalGroup(dimension, [tag], tag)
        if dimension == 2:
            gmsh.model.setPhysicalName(2, group, PATCHES[tag])
    gmsh.model.mesh.addNodes(*entities[0], list(range(1, len(mesh.points) + 1)), mesh.points.ravel().tolist())
    for dimension, tag in entities:
        for kind, number in types.items():
            chosen = [nodes for k, nodes, t in mesh.of(kind) if t == tag]
            if chosen and DIMENSION[kind] == dimension:
                gmsh.model.mesh.addElementsByType(tag, number, [], (np.array(chosen) + 1).ravel().tolist())
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(name)
    gmsh.finalize()


def write_medit(mesh, name):
    names = {"triangle": "Triangles", "quad": "Quadrilaterals", "tetra": "Tetrahedra", "wedge": "Prisms", "pyramid": "Pyramids"}
    lines = ["MeshVersionFormatted 2", "Dimension 3", f"Vertices\n{len(mesh.points)}"]
    lines += [f"{x!r} {y!r} {z!r} 0" for x, y, z in mesh.points.tolist()]
    for kind, keyword in names.items():
        lines += [keyword, str(len(mesh.of(kind)))] + [f"{rows(nodes, 1)} {tag}" for _, nodes, tag in mesh.of(kind)]
    pathlib.Path(name).write_text("\n".join(lines + ["End", ""]))


def write_binary_medit(mesh, name):
    codes = {"triangle": 6, "quad": 7, "tetra": 8, "wedge": 9, "pyramid": 49}
    data = struct.pack("<iiiii", 1, 2, 3, 20, 3)

    def section(code, n, content):
        nonlocal data
        data += struct.pack("<iii", code, len(data) + 12 + len(content), n) + content
    section(4, len(mesh.points), b"".join(struct.pack("<dddi", *point, 0) for point in mesh.points))
    for kind, code in codes.items():
        section(code, len(mesh.of(kind)), b"".join(struct.pack(f"<{len(nodes) + 1}i", *(p + 1 for p in nodes), tag)
                                                   for _, nodes, tag in mesh.of(kind)))
    pathlib.Path(name).write_bytes(data + struct.pack("<ii", 54, 0))


def order_of_vtk(kind, nodes):
    """VTK and SU2 see the first triangle of a wedge counter-clockwise from outside."""
    return nodes[3:] + nodes[:3] if kind == "wedge" else nodes


def write_su2(mesh, name):
    types = {"triangle": 5, "quad": 9, "tetra": 10, "wedge": 13, "pyramid": 14}
    cells = mesh.of("wedge", "pyramid", "tetra")
    lines = ["NDIME= 3", f"NELEM= {len(cells)}"] + [f"{types[kind]} {rows(order_of_vtk(kind, nodes))}" for kind, nodes, _ in cells]
    lines += [f"NPOIN= {len(mesh.points)}"] + [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()] + [f"NMARK= {len(PATCHES)}"]
    for tag, patch in PATCHES.items():
        faces = [(kind, nodes) for kind, nodes, t in mesh.of("triangle", "quad") if t == tag]
        lines += [f"MARKER_TAG= {patch}", f"MARKER_ELEMS= {len(faces)}"] + [f"{types[kind]} {rows(nodes)}" for kind, nodes in faces]
    pathlib.Path(name).write_text("\n".join(lines + [""]))


def order_of_ugrid(kind, nodes):
    """The apex of a pyramid comes third."""
    return [nodes[1], nodes[0], nodes[4], nodes[2], nodes[3]] if kind == "pyramid" else nodes


def write_ugrid(mesh, name):
    end = ">" if ".b8." in name else "<"
    faces = [mesh.of(kind) for kind in ("triangle", "quad")]
    cells = [mesh.of(kind) for kind in ("tetra", "pyramid", "wedge")]
    data = struct.pack(end + "7i", len(mesh.points), *(len(block) for block in faces + cells), 0)
    data += mesh.points.astype(end + "f8").tobytes()
    number = lambda values: np.array(values, dtype=end + "i4").tobytes()
    for block in faces:
        data += number([[p + 1 for p in nodes] for _, nodes, _ in block])
    data += number([tag for block in faces for _, _, tag in block])
    for block in cells:
        data += number([[p + 1 for p in order_of_ugrid(kind, nodes)] for kind, nodes, _ in block])
    pathlib.Path(name).write_bytes(data)


def vtk_types(mesh):
    return [{"triangle": 5, "quad": 9, "tetra": 10, "wedge": 13, "pyramid": 14}[kind] for kind, _, _ in mesh.elements]


def write_vtk(mesh, name, pixels=False):
    kept = [order_of_vtk(kind, nodes) for kind, nodes, _ in mesh.elements]
    types = vtk_types(mesh)
    if pixels:
        kept = [[a, b, d, c] if len(nodes) == 4 and kind == 9 else nodes for kind, nodes in zip(types, kept) for a, b, c, d in [(nodes * 2)[:4]]]
        types = [8 if kind == 9 else kind for kind in types]
    n = len(kept)
    lines = ["# vtk DataFile Version 3.0", "a mesh", "ASCII", "DATASET UNSTRUCTURED_GRID", f"POINTS {len(mesh.points)} double"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    lines += [f"CELLS {n} {sum(len(nodes) + 1 for nodes in kept)}"] + [f"{len(nodes)} {rows(nodes)}" for nodes in kept]
    lines += [f"CELL_TYPES {n}"] + [str(kind) for kind in types] + [f"CELL_DATA {n}"]
    lines += ["SCALARS medit:ref int 1", "LOOKUP_TABLE default"] + [str(tag) for _, _, tag in mesh.elements]
    lines += ["SCALARS row double 1", "LOOKUP_TABLE default"] + [str(float(i)) for i in range(n)]
    pathlib.Path(name).write_text("\n".join(lines + [""]))


def write_vtu(mesh, name):
    n, kept = len(mesh.elements), [order_of_vtk(kind, nodes) for kind, nodes, _ in mesh.elements]

    def array(kind, title, values, components=1):
        return (f'<DataArray type="{kind}" Name="{title}" NumberOfComponents="{components}" format="ascii">\n'
                + " ".join(repr(v) if kind == "Float64" else str(v) for v in values) + "\n</DataArray>\n")
    text = ('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{n}">\n'
            "<Points>\n" + array("Float64", "Points", mesh.points.ravel().tolist(), 3) + "</Points>\n<Cells>\n"
            + array("Int64", "connectivity", [p for nodes in kept for p in nodes])
            + array("Int64", "offsets", np.cumsum([len(nodes) for nodes in kept]).tolist()) + array("UInt8", "types", vtk_types(mesh))
            + "</Cells>\n<CellData>\n" + array("Int32", "medit:ref", [tag for _, _, tag in mesh.elements])
            + array("Float64", "row", [float(i) for i in range(n)])
            + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")
    pathlib.Path(name).write_text(text)


def write_mfem(mesh, name):
    shapes = {"triangle": 2, "quad": 3, "tetra": 4, "wedge": 6, "pyramid": 7}
    lines = ["MFEM mesh v1.0", "", "dimension", "3", ""]
    for keyword, chosen in (("elements", mesh.of("wedge", "pyramid", "tetra")), ("boundary", mesh.of("triangle", "quad"))):
        lines += [keyword, str(len(chosen))] + [f"{tag} {shapes[kind]} {rows(nodes)}" for kind, nodes, tag in chosen] + [""]
    lines += ["vertices", str(len(mesh.points)), "3"] + [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    pathlib.Path(name).write_text("\n".join(lines + [""]))


def write_cgns(mesh, name):
    """Sections that are mixed and of one type; boundary conditions by ranges of elements; a solution at the cells."""
    types = {"triangle": 5, "quad": 7, "tetra": 10, "pyramid": 12, "wedge": 14}

    def node(parent, title, label, values=None):
        group = parent.create_group(title)
        kind = "MT"
        if values is not None:
            values = np.frombuffer(values.encode(), np.int8) if isinstance(values, str) else np.asarray(values)
            kind = {"int8": "C1", "int32": "I4", "float64": "R8", "float32": "R4"}[values.dtype.name]
            group.create_dataset(" data", data=values)
        for key, text, size in (("name", title, 33), ("label", label, 33), ("type", kind, 3)):
            group.attrs.create(key, np.array(text.encode(), f"S{size}"))
        return group
    with h5py.File(name, "w") as file:
        for key, text, size in (("name", "HDF5 MotherNode", 33), ("label", "Root Node of HDF5 File", 33), ("type", "MT", 3)):
            file.attrs.create(key, np.array(text.encode(), f"S{size}"))
        node(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([3.4], np.float32))
        base = node(file, "Base", "CGNSBase_t", np.array([3, 3], np.int32))
        cells = mesh.of("pyramid") + mesh.of("wedge") + mesh.of("tetra")
        zone = node(base, "Zone", "Zone_t", np.array([[len(mesh.points)], [len(cells)], [0]], np.int32))
        node(zone, "ZoneType", "ZoneType_t", "Unstructured")
        grid = node(zone, "GridCoordinates", "GridCoordinates_t")
        for axis in range(3):
            node(grid, "Coordinate" + "XYZ"[axis], "DataArray_t", mesh.points[:, axis].copy())
        conditions = node(zone, "ZoneBC", "ZoneBC_t")
        first = 1
        # the section of prisms comes last though its elements are not the last ones
        for title, chosen, mixed in (("a pyramids", mesh.of("pyramid"), False), ("z prisms", mesh.of("wedge"), False),
                                     ("b tetrahedra", mesh.of("tetra"), True)):
            number = 20 if mixed else types[chosen[0][0]]
            section = node(zone, title, "Elements_t", np.array([number, 0], np.int32))
            nodes = [value for kind, corners, _ in chosen for value in ([types[kind]] if mixed else []) + [p + 1 for p in corners]]
            node(section, "ElementRange", "IndexRange_t", np.array([first, first + len(chosen) - 1], np.int32))
            node(section, "ElementConnectivity", "DataArray_t", np.array(nodes, np.int32))
            first += len(chosen)
        for tag, patch in PATCHES.items():
            chosen = [element for element in mesh.of("triangle", "quad") if element[2] == tag]
            section = node(zone, f"faces {tag}", "Elements_t", np.array([20, 0], np.int32))
            nodes = [value for kind, corners, _ in chosen for value in [types[kind]] + [p + 1 for p in corners]]
            span = np.array([first, first + len(chosen) - 1], np.int32)
            node(section, "ElementRange", "IndexRange_t", span)
            node(section, "ElementConnectivity", "DataArray_t", np.array(nodes, np.int32))
            condition = node(conditions, patch, "BC_t", "BCWall")
            node(condition, "PointRange", "IndexRange_t", span.reshape(2, 1))
            node(condition, "GridLocation", "GridLocation_t", "FaceCenter")
            first += len(chosen)
        solution = node(zone, "Solution", "FlowSolution_t")
        node(solution, "GridLocation", "GridLocation_t", "CellCenter")
        node(solution, "row", "DataArray_t", np.arange(len(cells), dtype=float))


FACES = {"tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
         "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]}  # seen counter-clockwise from outside


def write_foam(mesh, folder):
    cells, faces = mesh.of("wedge", "pyramid", "tetra"), {}
    for c, (kind, nodes, _) in enumerate(cells):
        for face in FACES[kind]:
            corners = [nodes[k] for k in face]
            faces.setdefault(frozenset(corners), []).append((c, corners))
    patch_of = {frozenset(nodes): tag for _, nodes, tag in mesh.of("triangle", "quad")}
    inner = sorted((found for found in faces.values() if len(found) == 2), key=lambda found: (found[0][0], found[1][0]))
    outer = {tag: [found for key, found in faces.items() if len(found) == 1 and patch_of[key] == tag] for tag in PATCHES}
    order = inner + [found for tag in PATCHES for found in outer[tag]]
    target = pathlib.Path(folder, "constant/polyMesh")
    target.mkdir(parents=True)
    head = "FoamFile\n{{ version 2.0; format ascii; class {}; object {}; }}\n"

    def put(name, kind, lines):
        (target / name).write_text(head.format(kind, name) + f"{len(lines)}\n(\n" + "\n".join(lines) + "\n)\n")
    put("points", "vectorField", [f"({x!r} {y!r} {z!r})" for x, y, z in mesh.points.tolist()])
    put("faces", "faceList", [f"{len(found[0][1])}({rows(found[0][1])})" for found in order])
    put("owner", "labelList", [str(found[0][0]) for found in order])
    put("neighbour", "labelList", [str(found[1][0]) for found in inner])
    start, entries = len(inner), []
    for tag, patch in PATCHES.items():
        entries.append(f"{patch} {{ type patch; nFaces {len(outer[tag])}; startFace {start}; }}")
        start += len(outer[tag])
    put("boundary", "polyBoundaryMesh", entries)
    zones = [f"{title} {{ type cellZone; cellLabels List<label> {len(chosen)}({rows(chosen)}); }}" for title, chosen in
             (("region_1", [c for c, cell in enumerate(cells) if cell[0] == "wedge"]),
              ("region_2", [c for c, cell in enumerate(cells) if cell[0] == "pyramid"]),
              ("region_3", [c for c, cell in enumerate(cells) if cell[0] == "tetra"]))]
    put("cellZones", "regIOobject", zones)


WRITERS = {"g.msh": write_msh, "g4.msh": write_msh_4, "m.mesh": write_medit, "m.meshb": write_binary_medit, "s.su2": write_su2,
           "u.lb8.ugrid": write_ugrid, "u.b8.ugrid": write_ugrid, "l.vtk": write_vtk, "v.vtu": write_vtu, "f.mfem": write_mfem,
           "c.cgns": write_cgns, "case": write_foam}


# --- what is looked at

def tetrahedra(name):
    """Corners of the cells, 4 x 3 each, and the cell fields, both by cell."""
    with h5py.File(name) as file:
        grid = file["VTKHDF"]
        cells = grid["Connectivity"][:].reshape(-1, 4)
        return grid["Points"][:][cells], {key: grid["CellData"][key][:] for key in grid["CellData"]}


def cell_set(corners):
    return {frozenset(map(tuple, cell)) for cell in corners.tolist()}


def volumes(corners):
    a, b, c, d = (corners[:, k] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def own_volumes(mesh):
    """Of each element: the volume of a cell, by its faces as seen from outside."""
    result = []
    for kind, nodes, _ in mesh.elements:
        if DIMENSION[kind] == 2:
            result.append(0)
            continue
        total = 0
        for face in FACES[kind]:
            p = mesh.points[[nodes[k] for k in face]]
            total += sum(np.dot(p[0], np.cross(p[k], p[k + 1])) for k in range(1, len(p) - 1)) / 6
        result.append(total)
    return np.array(result)


def check(mesh, name, out):
    """Reads it, and finds volumes and areas, patches and regions, and no hanging node."""
    done = run("pamr-convert", name, out, "--split-prisms", "--strict", "--json", "r.json")
    n = {kind: len(mesh.of(kind)) for kind in N_NODES}
    n_cells = 3 * n["wedge"] + 2 * n["pyramid"]
    assert f"{n['wedge']} prisms and {n['pyramid']} pyramids were cut into {n_cells} tetrahedra" in done.err, done.err
    assert "warning" not in done.err, done.err
    quality = run("pamr-quality", out, "--json", "-", "--quiet").json
    assert quality["cells"] == n_cells + n["tetra"] and abs(quality["volume"] - VOLUME) < 1e-12, quality
    areas = {}
    for kind, nodes, tag in mesh.of("triangle", "quad"):
        p = mesh.points[nodes]
        areas[tag] = areas.get(tag, 0) + sum(np.linalg.norm(np.cross(p[k] - p[0], p[k + 1] - p[0])) / 2 for k in range(1, len(p) - 1))
    found = {patch: entry["area"] for patch, entry in quality["patches"].items()}
    assert len(found) == len(areas) and np.allclose(sorted(found.values()), sorted(areas.values()), rtol=1e-12), (found, areas)
    report = json.loads(pathlib.Path("r.json").read_text())["cut_elements"]
    assert report["prisms"] == n["wedge"] and report["pyramids"] == n["pyramid"], report


def test_every_format_gives_the_same_cells():
    mesh = layers()
    own = own_volumes(mesh)
    assert (own[[i for i, e in enumerate(mesh.elements) if DIMENSION[e[0]] == 3]] > 0).all() and abs(own.sum() - VOLUME) < 1e-12
    cells_of, sums = {}, {}
    for name, write in WRITERS.items():
        write(mesh, name)
        out = name.replace(".", "_") + ".hdf"
        check(mesh, name, out)
        corners, fields = tetrahedra(out)
        cells_of[name] = cell_set(corners)
        size = volumes(corners)
        if "region" in fields and name != "c.cgns":  # CGNS has sections instead of numbers
            for tag, kind in ((1, "wedge"), (2, "pyramid"), (3, "tetra")):
                expected = sum(own[i] for i, e in enumerate(mesh.elements) if e[0] == kind)
                assert abs(size[fields["region"] == tag].sum() - expected) < 1e-12, (name, kind)
        sums[name] = sorted(fields)
        if "row" in fields:  # every piece has the values of its element
            cells = mesh.of("pyramid") + mesh.of("wedge") + mesh.of("tetra") if name == "c.cgns" else mesh.elements
            expected = own_volumes(Mixed(mesh.points, cells))
            found = np.bincount(fields["row"].astype(int), weights=size, minlength=len(cells))
            assert np.allclose(found, expected, rtol=0, atol=1e-14), name
    assert all(cells == cells_of["g.msh"] for cells in cells_of.values())
    for name in ("g.msh", "g4.msh", "m.mesh", "m.meshb", "l.vtk", "v.vtu", "f.mfem", "c.cgns", "case"):
        assert "region" in sums[name], (name, sums[name])
    for name in ("l.vtk", "v.vtu", "c.cgns"):
        assert "row" in sums[name], (name, sums[name])
    write_vtk(mesh, "pixels.vtk", pixels=True)
    check(mesh, "pixels.vtk", "pixels.hdf")
    assert same_bytes("pixels.hdf", "l_vtk.hdf")


def test_an_inverted_cell_is_found_in_every_format():
    mesh = layers(n=1, heights=(0, TALL))
    bad = with_one_turned(with_one_turned(mesh, "wedge"), "pyramid")
    for name, write in WRITERS.items():
        if name == "case":
            continue  # faces say where the inside is
        write(bad, name)
        done = run("pamr-convert", name, "out.hdf", "--split-prisms", "--force")
        assert "5 inverted cells were turned over" in done.err, (name, done.err)
    refuses("pamr-convert", "g.msh", "no.hdf", "--split-prisms", "--strict", says=["5 inverted"], creates="no.hdf")


def test_the_bytes_do_not_depend_on_the_ranks():
    mesh = layers()
    for name, all_ranks in (("g.msh", (2, 3, 4, 7)), ("u.lb8.ugrid", (3,)), ("m.meshb", (4,)), ("s.su2", (3,)), ("v.vtu", (2,))):
        WRITERS[name](mesh, name)
        run("pamr-convert", name, "1.hdf", "--split-prisms", "--force", "--quiet")
        for ranks in all_ranks:
            run("pamr-convert", name, f"{ranks}.hdf", "--split-prisms", "--force", "--quiet", ranks=ranks)
            assert same_bytes("1.hdf", f"{ranks}.hdf"), (name, ranks)


def test_elements_in_several_groups_are_cut_once():
    mesh = layers(n=2)
    write_msh(mesh, "several.msh", several=True)
    report = run("pamr-convert", "several.msh", "several.hdf", "--split-prisms", "--json", "-", "--quiet").json
    assert "bottom+x0" in report["patches"] and "x0" not in report["patches"], report["patches"]
    quality = run("pamr-quality", "several.hdf", "--json", "-", "--quiet").json
    assert abs(quality["volume"] - VOLUME) < 1e-12
    assert abs(quality["patches"]["bottom+x0"]["area"] - TALL) < 1e-12


def test_without_the_option_they_are_refused_with_counts():
    mesh = layers(n=1, heights=(0, TALL))
    for name, write in WRITERS.items():
        write(mesh, name)
        refuses("pamr-convert", name, "no.hdf", says=["2 prisms", "1 pyramids", "(--split-prisms"], creates="no.hdf")
    text = pathlib.Path("g.msh").read_text()
    n = int(text.split("$Elements\n")[1].split("\n")[0])
    text = text.replace(f"$Elements\n{n}\n", f"$Elements\n{n + 1}\n{n + 1} 5 2 1 1 1 2 3 4 5 6 7 8\n")
    pathlib.Path("hexahedra.msh").write_text(text)
    done = refuses("pamr-convert", "hexahedra.msh", "no.hdf", says=["2 prisms", "1 hexahedra"], creates="no.hdf")
    assert "--split-prisms" not in done.err
    done = refuses("pamr-convert", "hexahedra.msh", "no.hdf", "--split-prisms", says=["found 1 hexahedra"], creates="no.hdf")
    run("pamr-convert", "g.msh", "ours.hdf", "--split-prisms", "--quiet")
    refuses("pamr-convert", "ours.hdf", "no.hdf", "--split-prisms", says=["a mesh of another program", "ours.hdf"], creates="no.hdf")
    pathlib.Path("m.sol").write_text("MeshVersionFormatted 2\nDimension 3\nSolAtTetrahedra\n2\n1 1\n3\n4\nEnd\n")
    refuses("pamr-convert", "m.mesh", "no.hdf", "--split-prisms", "--sol-in", "m.sol", says=["m.sol", "expected fields on vertices"])


def test_twisted_and_flat_prisms_are_refused():
    mesh = layers(n=1, heights=(0, TALL))
    place = next(i for i, element in enumerate(mesh.elements) if element[0] == "wedge")
    a, b, c, d, e, f = mesh.elements[place][1]
    for name, nodes, says in (("twisted", [a, b, c, e, f, d], "twisted"), ("flat", [a, b, c, a, b, c], "flat ones")):
        bad = Mixed(mesh.points, [("wedge", nodes, 1)])
        write_medit(bad, name + ".mesh")
        refuses("pamr-convert", name + ".mesh", "no.hdf", "--split-prisms", says=[name + ".mesh", says], creates="no.hdf")


def test_a_boundary_layer_of_gmsh_is_refined():
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    top = next(tag for _, tag in gmsh.model.getEntities(2) if abs(gmsh.model.occ.getCenterOfMass(2, tag)[2] - 1) < 1e-9)
    gmsh.model.occ.extrude([(2, top)], 0, 0, 0.1, numElements=[1, 1, 1], heights=[0.5, 0.8, 1], recombine=True)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.write("layer.msh")
    gmsh.finalize()
    done = run("pamr-convert", "layer.msh", "layer.hdf", "--split-prisms", "--json", "r.json")
    assert " prisms and 0 pyramids were cut into " in done.err and "inverted" not in done.err, done.err
    run("pamr-mark", "layer.hdf", "-o", "marked.hdf", "--box", "0,0,0.8,1,1,1.1")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf")
    quality = run("pamr-quality", "fine.hdf", "--json", "-", "--quiet").json
    assert abs(quality["volume"] - 1.1) < 1e-12 and quality["inverted_cells"] == 0
    inside = json.loads(pathlib.Path("r.json").read_text())["inner_faces"]
    assert len(inside) == 1, inside  # the top of the box, under the layers
    assert abs(sum(entry["area"] for patch, entry in quality["patches"].items() if patch not in inside) - 6.4) < 1e-9, quality["patches"]


if __name__ == "__main__":
    run_tests(globals())
