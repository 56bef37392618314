# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-picture: from the command line to the file."""
import errno
import io
import json
import os
import shutil
import signal
import sys

from refused import Refused

TOOL = "pamr-picture"


unfinished = []  # files and folders that an interrupt removes


def interrupt(_number, _frame):
    """Ends the process here: an exception could be lost in a destructor. The screen ends with its parent."""
    os.write(2, f"{TOOL}: interrupted: outputs that were not complete are removed\n".encode())
    for path in unfinished:
        if os.path.isdir(path):
            shutil.rmtree(path, ignore_errors=True)
        elif os.path.exists(path):
            os.unlink(path)
    os._exit(6)


def is_same_file(a, b):
    """By `.` and `..`, symbolic or hard links; they need not exist. As tools/cli/files.cpp has it."""
    def entry(path):
        return os.path.join(os.path.realpath(os.path.dirname(path) or "."), os.path.basename(path))
    return (entry(a) == entry(b) or os.path.realpath(a) == os.path.realpath(b)
            or os.path.exists(a) and os.path.exists(b) and os.path.samefile(a, b))


def is_device(path):
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


def check_output(path, inputs, outputs, force):
    """Refuses what cannot become this output; before work starts, for each output."""
    for kind, others in (("input", inputs), ("output", outputs)):
        for other in others:
            if is_same_file(path, other):
                raise Refused(f"{path}: expected an output of its own, found the same file as the {kind} {other}")
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        raise Refused(f"{path}: expected a file to write, found a folder")
    if not os.path.isdir(folder):
        raise Refused(f"{path}: expected an existing folder to write into, found none named {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise Refused(f"{path}: the folder {folder} cannot be written")
    if os.path.exists(path) and not force:
        raise Refused(f"{path}: the output file exists already (--force replaces it)")


def check_outputs(o):
    check_output(o.output, o.meshes, [], o.force)
    if is_device(o.output):
        raise Refused(f"{o.output}: expected a regular file to replace, found a device or pipe")
    if o.json and o.json != "-" and not is_device(o.json):
        check_output(o.json, o.meshes, [o.output], True)


def say(text):
    """Prints a line that has to arrive. Where there is no standard output nobody listens."""
    try:
        print(text, flush=True)
    except OSError as wrong:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # else Python tries once more when it ends
        if wrong.errno != errno.EBADF:
            raise Refused(f"standard output: not all that was printed could be written: {wrong.strerror}") from None


def write_whole(path, content):
    """All of it or nothing arrives under the name; a device or pipe is written directly."""
    if is_device(path):
        try:
            with open(path, "wb") as device:
                device.write(content)
        except OSError as wrong:
            raise Refused(f"{path}: cannot be written: {wrong.strerror}") from None
        return
    partial = f"{path}.{os.getpid()}.partial"
    unfinished.append(partial)
    try:
        with open(partial, "xb") as file:
            if os.path.exists(path):  # who could not read the old one cannot read the new one
                os.fchmod(file.fileno(), os.stat(path).st_mode & 0o777)
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except OSError as wrong:
        raise Refused(f"{path}: cannot be written: {wrong.strerror}") from None
    finally:
        if os.path.exists(partial):
            os.unlink(partial)


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
    if o.title:
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
        return [], [], []
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
    check_outputs(o)
    try:
        import matplotlib, numpy, vtk  # noqa: F401, E401: named here so that a missing package is one clear message
    except ImportError as missing:
        raise Refused(f"expected the Debian packages python3-vtk9, python3-matplotlib and python3-h5py, "
                      f"found no module {missing.name}") from None
    picture, report = make(o)
    write_whole(o.output, picture)
    report = {"report": {"tool": "pamr-picture", "version": version, "commit": "", "format": 1, "inputs": o.meshes}} | report
    if o.json == "-":
        say(json.dumps(report, indent=2))
    elif o.json:
        write_whole(o.json, (json.dumps(report, indent=2) + "\n").encode())
    if not o.quiet:
        cells = ", ".join(f"{m['cells']:,}" for m in report["meshes"])
        line = f"{o.output}: {o.size[0]} x {o.size[1]} pixels, {cells} cells"
        if o.json == "-":
            print(line, file=sys.stderr)
        else:
            say(line)


def main(arguments, version):
    """The exit code, as of all tools. One process draws: of an MPI job the first."""
    if any(os.environ.get(name, "0") != "0" for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK")):
        return 0
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1):
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:  # nohup
            signal.signal(number, interrupt)
    try:
        run(arguments, version)
        return 0
    except Refused as wrong:
        print(f"{TOOL}: error: {' '.join(str(wrong).split())}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"{TOOL}: error: out of memory", file=sys.stderr)
        return 3
    except Exception as wrong:  # a defect: one line, like the other tools
        print(f"{TOOL}: error: internal: {type(wrong).__name__}: {wrong}", file=sys.stderr)
        if os.environ.get("PAMR_TRACE"):
            raise
        return 3
