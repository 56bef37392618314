# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-picture: from the command line to the file."""
import io
import json
import os
import signal
import sys
import warnings

import files
from files import as_unicode, check_input, check_output, is_device, one_line, say, tell, write_whole
from refused import Refused

TOOL = "pamr-picture"
SIGNALS = signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1


def interrupt(_number, _frame):
    """Ends the process here: an exception could be lost in a destructor. The screen ends with its parent."""
    for path in files.unfinished:
        files.remove(path)
    tell(f"{TOOL}: interrupted: outputs that were not complete are removed{files.complete_text()}")
    os._exit(6)


def check_files(o):
    for mesh in o.meshes:
        check_input(mesh)
    if is_device(o.output):
        raise Refused(f"{o.output}: expected a regular file to replace, found a device or pipe")
    check_output(o.output, o.meshes, [], o.force)
    if o.json and o.json != "-":
        check_output(o.json, o.meshes, [o.output])


def warn(text, what="warning"):
    tell(f"{TOOL}: {what}: {text}")


def extent_of(subjects, view, focus, zoom):
    """Left, right, bottom, top of all that is seen from here, with a small border."""
    import numpy as np
    flat = [view.flat(s.points()) for s in subjects]
    low, high = (np.array([pick(f, axis=0) for f in flat]) for pick in (np.min, np.max))
    low, high = low.min(axis=0), high.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    half = np.maximum(half, 1e-3 * half.max() + 1e-30) * 1.02
    if focus is not None:
        middle = view.flat(focus)
    half = half / zoom
    return [middle[0] - half[0], middle[0] + half[0], middle[1] - half[1], middle[1] + half[1]]


def fitted(extent, width, height):
    """The extent, widened to the shape of a box of pixels."""
    middle = (extent[0] + extent[1]) / 2, (extent[2] + extent[3]) / 2
    half = (extent[1] - extent[0]) / 2, (extent[3] - extent[2]) / 2
    pixel = max(half[0] / width, half[1] / height)
    return [middle[0] - pixel * width, middle[0] + pixel * width, middle[1] - pixel * height, middle[1] + pixel * height]


def counts(subject):
    mesh, n = subject.mesh, sum(data.GetNumberOfCells() for data, _, _ in subject.pieces())
    if subject.wish.condition is not None:
        return f"{int(subject.chosen.sum()):,} of {len(mesh.cells):,} cells"
    return f"{len(mesh.cells):,} cells" if len(mesh.cells) else f"{n:,} triangles"


def title_of(o, subjects):
    if o.title is not None:
        return o.title
    unit = next((s.values.unit for s in subjects if s.values.unit), "") if o.scale == 1 else ""
    return f"{o.field}, {unit}" if unit else o.field


def legend_of(o, subjects, coloring):
    """Names, face colors and edge colors; nothing where the picture needs none."""
    import numpy as np
    import palettes
    if o.field == "patch":
        colors = [coloring.patch_color(name) for name in coloring.patches]
        return coloring.patches, colors, [palettes.INK] * len(colors)
    if coloring.classes is not None:
        colors = palettes.of_patches(np.arange(len(coloring.classes)))
        known = {k: name for s in subjects for k, name in s.mesh.region_names.items()} if o.field == "region" else {}
        names = [known.get(int(value), f"{o.title or o.field} {value:.0f}") for value in coloring.classes]
        return names, colors, [palettes.INK] * len(colors)
    if o.field is not None:
        return (["not finite"], [palettes.NOTHING], [palettes.INK]) if coloring.has_gaps else ([], [], [])
    deepest = max(int(s.levels().max()) for s in subjects)
    if deepest == 0:
        return [], [], []
    last = len(palettes.LEVEL_EDGE) - 1
    names = [f"level {i}" + (" and more" if i == last < deepest else "") for i in range(min(deepest, last) + 1)]
    return names, palettes.LEVEL_FLAT[:len(names)], palettes.LEVEL_EDGE[:len(names)]


def require_patches(wanted, meshes):
    """Each name stands for a patch of some mesh: a surface beside volume meshes need not have them."""
    from mesh_files import patches_named
    known = {patch for mesh in meshes for patch in mesh.patches}
    for name in wanted:
        if name != "all" and not any(patches_named(name, mesh.groups) for mesh in meshes):
            raise Refused(f"{meshes[0].file}: --patch: unknown patch '{name}'; there are {', '.join(sorted(known))}")


def make(o):
    """The picture's bytes and what the report says of it."""
    import mesh_files
    import page as pages
    from panel import Subject, Wish, draw
    from x_server import screen
    wish = Wish(o.plane, o.whole_cells, o.condition, o.patch, o.field, o.scale, o.smooth, o.isolines, o.streamlines, o.edges, o.mirror)
    meshes = [mesh_files.read(file) for file in o.meshes]
    require_patches(o.patch or [], meshes)
    subjects = [Subject(mesh, wish) for mesh in meshes]
    coloring = pages.Coloring(wish, subjects, o.range, o.log, o.map)
    for subject in subjects:
        subject.remark_on_values(o.log)
    legend = legend_of(o, subjects, coloring)
    is_planar = all(len(s.pieces()) == 1 and s.pieces()[0][1] for s in subjects)
    has_axes = is_planar and all(view.is_along_axes for view in o.views)
    if has_axes and not o.size_is_given:
        left, right, bottom, top = extent_of(subjects, o.views[0], o.focus[0], o.zoom[0])
        o.size = o.size[0], pages.Page.fitting_height(o.size[0], len(o.views), len(subjects), coloring.norm is not None,
                                                      bool(legend[0]), (right - left) / (top - bottom))
    page = pages.Page(*o.size, len(o.views), len(subjects), coloring.norm is not None, bool(legend[0]), has_axes)
    boxes = {}
    with screen():
        for row, (view, focus, zoom) in enumerate(zip(o.views, o.focus, o.zoom)):
            extent = extent_of(subjects, view, focus, zoom)
            for column, subject in enumerate(subjects):
                box = boxes[column] = page.box(row, column, (extent[1] - extent[0]) / (extent[3] - extent[2]) if has_axes else None)
                seen = fitted(extent, *box[2:])
                page.add_panel(box, draw(subject, view, seen, *box[2:], coloring), seen, view, subject.mesh.length_unit)
    for column, subject in enumerate(subjects):
        for remark in dict.fromkeys(subject.remarks):
            warn(remark)
        page.add_title(column, boxes[column][0], o.label[column] if o.label else subject.mesh.name, counts(subject))
    if coloring.norm is not None:
        page.add_bar(coloring, title_of(o, subjects), boxes[len(subjects) - 1][0] + boxes[len(subjects) - 1][2])
    if legend[0]:
        page.add_legend(*legend)
    picture = io.BytesIO()
    page.save(picture)
    report = {"picture": o.output, "width": o.size[0], "height": o.size[1], "meshes": [
        {"file": s.mesh.file, "cells": len(s.mesh.cells), "boundary_triangles": len(s.mesh.faces),
         "patches": s.mesh.patches} for s in subjects]}
    if coloring.seen is not None:
        report["field"] = {"name": o.field, "min": coloring.seen[0], "max": coloring.seen[1]}
    if coloring.classes is not None:
        report["field"]["values"] = [int(value) for value in coloring.classes]
    return picture.getvalue(), report


def run(arguments, version):
    import command_line
    o = command_line.read(arguments, version)
    check_files(o)
    try:
        import matplotlib, numpy, vtk  # noqa: F401, E401: named here so that a missing package is one clear message
    except ImportError as missing:
        raise Refused(f"expected the Debian packages python3-vtk9, python3-matplotlib and python3-h5py, "
                      f"found no module {missing.name}") from None
    with warnings.catch_warnings(record=True) as noticed:  # of signs that the font has not
        warnings.simplefilter("always", UserWarning)
        picture, report = make(o)
    for text in dict.fromkeys(str(one.message) for one in noticed if issubclass(one.category, UserWarning)):
        warn(text)
    write_whole(o.output, picture)
    report = {"report": {"tool": "pamr-picture", "version": version, "commit": "", "format": 1, "inputs": o.meshes}} | report
    text = as_unicode(json.dumps(report, indent=2, ensure_ascii=False))
    if o.json == "-":
        say(text, is_report=True)
    elif o.json:
        write_whole(o.json, (text + "\n").encode())
    if not o.quiet:
        cells = ", ".join(f"{m['cells']:,}" for m in report["meshes"])
        line = f"{one_line(o.output)}: {o.size[0]} x {o.size[1]} pixels, {cells} cells"
        if o.json == "-":
            tell(line)
        else:
            say(line)


def main(arguments, version):
    """The exit code, as of all tools. One process draws: of an MPI job the first."""
    if any(os.environ.get(name, "0") != "0" for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")):
        return 0
    files.keep_standard_streams()
    for number in SIGNALS:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:  # nohup
            signal.signal(number, interrupt)
    if sys.stdout is not None:
        sys.stdout.reconfigure(errors="surrogateescape")  # names of files, whatever their bytes
    try:
        run(arguments, version)
        for number in SIGNALS:  # what comes now changes nothing that is done
            signal.signal(number, signal.SIG_IGN)
        return 0
    except Refused as wrong:
        warn(f"{wrong}{files.complete_text()}", "error")
        return 2
    except MemoryError:
        warn(f"out of memory{files.complete_text()}", "error")
        return 3
    except Exception as wrong:  # a defect: one line, like the other tools
        warn(f"internal: {type(wrong).__name__}: {wrong}{files.complete_text()}", "error")
        if os.environ.get("PAMR_TRACE"):
            raise
        return 3
