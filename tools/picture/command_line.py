# SPDX-License-Identifier: GPL-3.0-or-later
"""What pamr-picture is asked for."""
import argparse
import difflib
import re
import shutil

import numpy as np

import palettes
from files import say
from refused import Refused
from view import CUT_VIEWS, NAMED, Plane, unit, view_of

PURPOSE = "Makes a picture (PNG) of meshes and of fields on them, without a screen."
EXAMPLES = """examples:
  pamr-picture level0.hdf level2.hdf -o levels.png
  pamr-picture part.msh -o part.png --field patch --camera 1,-2,1
  pamr-picture flow.hdf -o density.png --cut y=0 --field n --log --isolines 5
  pamr-picture mesh.hdf -o inside.png --cut z=0.1 --whole-cells --field mean_ratio --camera 1,-1,2

Exit codes: 0 done; 2 bad usage or bad input; 3 internal failure; 6 interrupted."""


class Once(argparse.Action):
    """An option with one value, of which the last would count."""

    def __call__(self, parser, namespace, values, option_string=None):
        if getattr(namespace, self.dest) is not None:
            parser.error(f"{option_string}: expected one, found '{getattr(namespace, self.dest)}' and '{values}'")
        setattr(namespace, self.dest, values)


class Parser(argparse.ArgumentParser):
    """Ends with one line that says what is wrong, as all tools do."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.register("action", None, Once)

    def _print_message(self, message, file=None):
        say(message.rstrip("\n"))

    def error(self, message):
        unknown = re.match(r"unrecognized arguments: (.*)", message)
        if unknown:
            first = unknown.group(1).split()[0]
            near = difflib.get_close_matches(first.split("=")[0], self._option_string_actions, 1)
            message = f"unknown option {first}" + (f"; did you mean {near[0]}?" if near else "")
        message = re.sub(r"argument (?:-o/--output|(\S+)): ", lambda m: (m.group(1) or "-o") + ": ", message)
        for kind, what in (("int", "a whole number"), ("float", "a number")):
            message = message.replace(f"invalid {kind} value: ", f"expected {what}, found ")
        raise Refused(f"{message} (see {self.prog} --help)")


def numbers(text, what, count=None):
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = [float("nan")]
    if not np.isfinite(values).all() or (count and len(values) != count):
        many = f"{count or 'some'} numbers with commas between them"
        raise Refused(f"{what}: expected {'a number' if count == 1 else many}, found '{text}'")
    return values


def direction(text, what):
    """A direction: x, -z, iso, or three numbers."""
    name = text.lstrip("+-")
    if name in NAMED and text.count("-") <= 1:
        return np.array(NAMED[name], float) * (-1 if text.startswith("-") else 1)
    if not re.match(r"[-+.\d]", text):
        raise Refused(f"{what}: expected x, y, z, -x, -y, -z, iso or three numbers, found '{text}'")
    return np.array(numbers(text, what, 3))


def plane(text):
    """`y=0.2` or `NX,NY,NZ=D`: a plane, whose normal points to the camera, and the view that fits."""
    side, equals, place = text.rpartition("=")
    if not equals:
        raise Refused(f"--cut: expected a plane such as y=0.2 or 1,1,0=0.2, found '{text}'")
    offset = numbers(place, "--cut", 1)[0]
    if side in CUT_VIEWS:
        toward, up = CUT_VIEWS[side]
        return Plane(np.array(toward, float), offset * sum(toward)), view_of(toward, up)
    if side.count(",") != 2:
        raise Refused(f"--cut: expected x, y, z or three numbers before the '=', found '{side}'")
    raw = np.array(numbers(side, "--cut", 3))
    normal = unit(raw, "--cut")
    return Plane(normal, offset / np.linalg.norm(raw)), view_of(normal)


def condition(text):
    """`mean_ratio<0.2`: the field, whether values below the number are meant, and the number."""
    found = re.fullmatch(r"\s*(.+?)\s*([<>])([^<>]+)", text)
    if not found:
        raise Refused(f"--cells: expected a field, < or >, and a number, such as 'mean_ratio<0.2', found '{text}'")
    return found.group(1), found.group(2) == "<", numbers(found.group(3), "--cells", 1)[0]


def layout(prog):
    """Lines of at most 100 columns, as --help of the other tools."""
    return argparse.RawDescriptionHelpFormatter(prog, width=min(shutil.get_terminal_size().columns, 100))


def parser(version):
    line = Parser(prog="pamr-picture", description=PURPOSE, epilog=EXAMPLES, allow_abbrev=False,
                  formatter_class=layout)
    line.add_argument("meshes", nargs="+", metavar="MESH", help="a mesh or surface in any format that the tools read; "
                      "several stand side by side")
    line.add_argument("-o", "--output", required=True, metavar="PICTURE.png", help="picture to write")
    line.add_argument("--version", action="version", version=f"pamr-picture {version}")
    what = line.add_argument_group("what is shown")
    what.add_argument("--patch", action="append", metavar="NAME", help="this patch of the boundary, or these: 'face_*'; may be repeated; all: "
                      "every patch (default: every patch, and none beside --cut)")
    what.add_argument("--cut", metavar="PLANE", help="the section with a plane: x=V, y=V, z=V or NX,NY,NZ=V; what is in front "
                      "of it is taken away")
    what.add_argument("--whole-cells", action="store_true", help="with --cut: the complete cells behind the plane")
    what.add_argument("--cells", metavar="CONDITION", help="the complete cells where a field is below or above a number: "
                      "'mean_ratio<0.2', 'level>2'; with --cut those behind the plane, in place of the section")
    what.add_argument("--mirror", metavar="AXES", help="also the images in x = 0, y = 0, z = 0: x, xy, ...")
    what.add_argument("--edges", action=argparse.BooleanOptionalAction, help="edges of the cells (default: without --field)")
    colors = line.add_argument_group("colors")
    colors.add_argument("--field", metavar="NAME", help="color by this field; NAME:x or NAME:0 is a component, a vector without "
                        "one its length; also level, patch, mean_ratio, size (default: edges by level)")
    colors.add_argument("--scale", type=float, metavar="F", help="multiply the field by this")
    colors.add_argument("--title", metavar="TEXT", help="of the scale of colors")
    colors.add_argument("--range", metavar="LOW,HIGH", help="ends of the scale (default: of what is seen)")
    colors.add_argument("--log", action="store_true", help="logarithmic scale")
    colors.add_argument("--map", choices=palettes.MAPS, help="default viridis")
    colors.add_argument("--smooth", type=int, metavar="N", help="show means on the nodes, averaged N times more")
    colors.add_argument("--isolines", metavar="V,V,...", help="lines of these values, or a number of lines")
    colors.add_argument("--streamlines", metavar="FIELD", help="lines along a vector field; in the plane of a cut or flat patch")
    camera = line.add_argument_group("camera (parallel projection)")
    camera.add_argument("--camera", action="append", metavar="DIRECTION", help="where it stands: x, -x, ..., iso or X,Y,Z; "
                        "repeated: one row of pictures each (default: iso, or upright before the cut)")
    camera.add_argument("--up", metavar="DIRECTION", help="what points upward (default z)")
    camera.add_argument("--focus", action="append", metavar="X,Y,Z", help="middle of the picture (default: of what is shown); "
                        "repeated: one for each camera")
    camera.add_argument("--zoom", type=float, action="append", metavar="F", help="more than 1: nearer; repeated: one for each "
                        "camera")
    page = line.add_argument_group("page")
    page.add_argument("--size", metavar="WIDTHxHEIGHT", help="of the picture in pixels (default by the number of panels)")
    page.add_argument("--label", action="append", metavar="TEXT", help="title of a mesh, in their order")
    page.add_argument("--force", action="store_true", help="replace the picture when it exists")
    page.add_argument("--json", metavar="FILE", help="write a report in JSON to this file, - for standard output")
    page.add_argument("--quiet", action="store_true", help="no summary")
    return line


def joined(arguments):
    """`--camera -x` as `--camera=-x`: values that begin with a minus are no options."""
    result, takes = [], {"--camera", "--up", "--focus", "--range", "--isolines", "--cut", "--scale"}
    for argument in arguments:
        if result and result[-1] in takes and re.match(r"-[\d.xyzi]", argument):
            result[-1] += "=" + argument
        else:
            result.append(argument)
    return result


def size_of(text, rows, columns):
    if text is None:
        width = {1: 1000, 2: 1600}.get(columns, 640 * columns)
        height = 900 if rows * columns == 1 else 860 if columns == 2 and rows == 1 else 640 * rows
        return width, height
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    if not found or not all(100 <= int(v) <= 16000 for v in found.groups()):
        raise Refused(f"--size: expected WIDTHxHEIGHT, each from 100 to 16000 pixels, found '{text}'")
    return tuple(int(v) for v in found.groups())


def isolines(text):
    """Values, or an integer: how many."""
    if text is None:
        return ()
    return int(text) if re.fullmatch(r"[1-9]\d?", text) else sorted(numbers(text, "--isolines"))


def for_each_view(views, given, what, default):
    """One value a camera: those that were given, or one for all."""
    if len(given) not in (0, 1, len(views)):
        raise Refused(f"{what}: expected one for all cameras or one for each of the {len(views)}, found {len(given)}")
    return given if len(given) == len(views) else (given or [default]) * len(views)


def require_partners(o, arguments):
    """Refuses options that others make void."""
    if o.whole_cells and o.cut is None:
        raise Refused("--whole-cells: expected --cut beside it, found none")
    if o.whole_cells and o.cells is not None:
        raise Refused("--cells: expected no --whole-cells beside it, which shows all cells behind the plane")
    for option in ("isolines", "range", "log", "scale", "title", "map", "smooth"):
        value = getattr(o, option)
        if value is not None and value is not False and o.field in (None, "patch"):
            raise Refused(f"--{option}: expected a field with numbers (--field), found {o.field or 'none'}")
    hiding = "--cut" if o.cut is not None else "--cells"
    if o.field == "patch" and o.patch is None and not o.cut is o.cells is None:
        raise Refused(f"--field patch: expected --patch beside {hiding}, which shows no patch else, found none")
    if {"--edges", "--no-edges"} <= set(arguments):
        raise Refused("expected --edges or --no-edges, found both")


def read(arguments, version):
    """The options, checked as far as they can be without a mesh."""
    line = parser(version)
    parse = line.parse_args if "--" in arguments else line.parse_intermixed_args  # which forgets the --
    o = parse(joined(arguments))
    if not o.output.lower().endswith(".png"):
        raise Refused(f"-o: expected the name of a picture that ends in .png, found '{o.output}'")
    require_partners(o, arguments)
    if o.label is not None and len(o.label) != len(o.meshes):
        raise Refused(f"--label: expected one for each of the {len(o.meshes)} meshes, found {len(o.label)}")
    o.condition = None if o.cells is None else condition(o.cells)
    o.mirror = o.mirror or ""
    if set(o.mirror) - set("xyz") or len(set(o.mirror)) != len(o.mirror):
        raise Refused(f"--mirror: expected some of the letters x, y, z, found '{o.mirror}'")
    o.scale = 1.0 if o.scale is None else o.scale
    if not (np.isfinite(o.scale) and o.scale != 0):
        raise Refused(f"--scale: expected a number other than 0, found {o.scale:g}")
    if o.smooth is not None and not 0 <= o.smooth <= 100:
        raise Refused(f"--smooth: expected 0 to 100, found {o.smooth}")
    o.plane, cut_view = (None, None) if o.cut is None else plane(o.cut)
    up = None if o.up is None else direction(o.up, "--up")
    o.views = [view_of(direction(text, "--camera"), up) for text in o.camera or []]
    if not o.views:
        o.views = [cut_view if cut_view and up is None else view_of(cut_view.toward if cut_view else NAMED["iso"], up)]
    if o.plane is not None and o.plane.normal @ o.views[0].toward < -1e-9:
        o.plane = Plane(-o.plane.normal, -o.plane.offset)  # what is on the camera's side goes
    o.focus = for_each_view(o.views, [np.array(numbers(f, "--focus", 3)) for f in o.focus or []], "--focus", None)
    o.zoom = for_each_view(o.views, o.zoom or [], "--zoom", 1.0)
    if not all(np.isfinite(zoom) and zoom > 0 for zoom in o.zoom):
        raise Refused(f"--zoom: expected numbers above 0, found {', '.join(f'{zoom:g}' for zoom in o.zoom)}")
    o.map = o.map or palettes.MAPS[0]
    o.range = None if o.range is None else numbers(o.range, "--range", 2)
    if o.range and o.range[0] >= o.range[1]:
        raise Refused(f"--range: expected two rising numbers, found {o.range[0]:g} and {o.range[1]:g}")
    o.isolines = isolines(o.isolines)
    if o.log and not isinstance(o.isolines, int) and any(value <= 0 for value in o.isolines):
        raise Refused(f"--isolines: expected values above 0 with --log, found {o.isolines[0]:g}")
    o.size_is_given = o.size is not None
    o.size = size_of(o.size, len(o.views), len(o.meshes))
    return o
