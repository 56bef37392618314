# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts panels, titles, axes and the scale of colors on one page by matplotlib."""
import math
import re

import matplotlib
matplotlib.use("Agg")
matplotlib.rcParams["text.parse_math"] = False  # a name may have a $
import matplotlib.colors
import matplotlib.figure
import matplotlib.patches
import matplotlib.textpath
import matplotlib.ticker
import numpy as np

import palettes
from files import as_unicode, one_line
from refused import Refused
from view import axis_text

DPI = 100
INK = tuple(c / 255 for c in palettes.INK)
TITLE, LEGEND, MARGIN, AXIS, BAR = 62, 34, 14, 62, 112  # pixels
TITLE_SIZE = 11  # of the scale, points


def plain(text):
    """A name of any bytes, to draw."""
    return one_line(as_unicode(text))


def wrapped(title, width):
    """The title in lines of at most so many pixels, broken after blanks and underscores; longer words stand alone."""
    title = as_unicode(title)

    def length(text):
        return matplotlib.textpath.TextPath((0, 0), text.rstrip() or " ", TITLE_SIZE).get_extents().x1 * DPI / 72
    lines = [""]
    for word in re.findall(r"[^\s_]*(?:_+|\s+|$)", title):
        if lines[-1] and length(lines[-1] + word) > width:
            lines.append("")
        lines[-1] += word
    return [line.rstrip() for line in lines if line.strip()]


class Coloring:
    """From numbers to colors, the same in all panels."""

    def __init__(self, wish, subjects, bounds, is_log, name):
        self.patches = sorted({patch for s in subjects for patch in s.patches})
        self.isolines, self.norm, self.seen, self.classes, self.has_gaps = (), None, None, None, False
        if subjects[0].values is None:
            return
        seen = np.concatenate([s.shown_numbers() for s in subjects])
        self.has_gaps = not np.isfinite(seen).all()
        seen = seen[np.isfinite(seen) & (seen > 0 if is_log else True)]
        if not len(seen):
            raise Refused(f"--field {wish.field}: expected {'positive' if is_log else 'finite'} values to draw, found none")
        self.seen = float(seen.min()), float(seen.max())
        has_scale = bounds or is_log or wish.isolines or wish.scale != 1 or name != palettes.MAPS[0]
        if not has_scale and all(s.values.is_whole for s in subjects):
            different = np.unique(seen)
            if len(different) <= len(palettes.PATCH):
                self.classes = different
                return
        low, high = bounds or self.seen
        if is_log and low <= 0:
            raise Refused(f"--range: expected positive bounds with --log, found {low:g}")
        if not bounds and low == high:
            low, high = (low * 0.9, high * 1.1) if is_log else (low - 0.5, high + 0.5)
        make = matplotlib.colors.LogNorm if is_log else matplotlib.colors.Normalize
        self.norm = make(low, high)
        self.map = matplotlib.colormaps[name]
        self.colors = self.map(np.linspace(0, 1, 256))
        self.isolines = wish.isolines
        if isinstance(wish.isolines, int):
            locator = matplotlib.ticker.LogLocator(subs=(1, 2, 5)) if is_log else matplotlib.ticker.MaxNLocator(
                wish.isolines, steps=(1, 2, 5, 10))
            self.isolines = [v for v in locator.tick_values(low, high) if low < v < high]

    def position(self, numbers):
        """0 to 1 along the map; not a number where the field has none."""
        with np.errstate(all="ignore"):
            at = np.ma.filled(self.norm(numbers).astype(float), np.nan)
            if isinstance(self.norm, matplotlib.colors.LogNorm):
                at = np.where(numbers <= 0, 0, at)
        return np.where(np.isfinite(numbers), np.clip(at, 0, 1), np.nan)

    def bytes_of(self, numbers):
        if self.classes is not None:
            return palettes.of_patches(np.searchsorted(self.classes, numbers))
        at = self.position(numbers)
        colors = (self.map(np.nan_to_num(at))[:, :3] * 255).round().astype(np.uint8)
        colors[np.isnan(at)] = palettes.NOTHING
        return colors

    def patch_color(self, name):
        return palettes.of_patches(np.array(self.patches.index(name)))


def round_length(length):
    """1, 2 or 5 times a power of ten, at most this."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))


def length_unit(mesh_unit, size):
    """A unit with handy numbers for a picture of this size, and how many of it make one of the mesh."""
    if mesh_unit == "m":
        for unit, factor in (("m", 1.0), ("mm", 1e3), ("um", 1e6), ("nm", 1e9)):
            if size * factor >= 1:
                return unit, factor
    return "" if mesh_unit == "1" else plain(mesh_unit), 1.0  # 1: lengths without a unit


class Page:
    """A picture of `width` x `height` pixels with panels in `rows` (cameras) and `columns` (meshes)."""

    def __init__(self, width, height, rows, columns, has_bar, has_legend, has_axes):
        self.width, self.height, self.rows, self.columns = width, height, rows, columns
        self.has_axes = has_axes
        self.right = BAR if has_bar else MARGIN
        self.bottom = LEGEND if has_legend else MARGIN
        self.figure = matplotlib.figure.Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")
        left, bottom = (AXIS, AXIS - 14) if has_axes else (MARGIN, 4)
        self.cell_width = (width - self.right - MARGIN // 2) // columns
        self.cell_height = (height - self.bottom - TITLE) // rows
        self.inner = (left, bottom, self.cell_width - left - 8, self.cell_height - bottom - 8)
        if min(self.inner[2:]) < 60:
            raise Refused(f"--size: expected room for the panels, found {width}x{height} for {rows} x {columns} of them")

    @staticmethod
    def fitting_height(width, rows, columns, has_bar, has_legend, aspect):
        """Of a page with axes whose panels leave no empty space above them."""
        panel = (width - (BAR if has_bar else MARGIN) - MARGIN // 2) // columns - AXIS - 8
        height = TITLE + (LEGEND if has_legend else MARGIN) + rows * int(panel / aspect + AXIS - 6)
        return min(max(height, 360), 1400)

    def box(self, row, column, aspect=None):
        """Left, bottom, width and height of a panel in pixels; with `aspect` (width over height) the largest such box."""
        left, bottom, width, height = self.inner
        x = MARGIN // 2 + column * self.cell_width + left
        y = self.bottom + (self.rows - 1 - row) * self.cell_height + bottom
        if aspect is None:
            return x, y, width, height
        fitting_width, fitting_height = min(width, int(height * aspect)), min(height, int(width / aspect))
        fitting_width, fitting_height = max(fitting_width, 2), max(fitting_height, 2)
        return x + (width - fitting_width) // 2, y + (height - fitting_height) // 2, fitting_width, fitting_height

    def axes(self, box):
        x, y, width, height = box
        return self.figure.add_axes((x / self.width, y / self.height, width / self.width, height / self.height))

    def add_panel(self, box, image, extent, view, unit):
        """Shows the pixels; with axes, or else with a bar for lengths and the directions of x, y and z."""
        axes = self.axes(box)
        name, factor = length_unit(unit, min(extent[1] - extent[0], extent[3] - extent[2]))
        scaled = [v * factor for v in extent]
        axes.imshow(image, extent=scaled, interpolation="nearest", aspect="auto")
        comma = f", {name}" if name else ""
        if self.has_axes:
            for vector, axis, label in ((view.right, axes.xaxis, axes.set_xlabel), (view.up, axes.yaxis, axes.set_ylabel)):
                letter, sign = axis_text(vector)
                label(letter + comma, color=INK, labelpad=2)
                axis.set_major_locator(matplotlib.ticker.MaxNLocator(7, steps=(1, 2, 5, 10)))
                if sign < 0:
                    axis.set_major_formatter(lambda v, _: f"{-v + 0:g}")
            axes.tick_params(labelsize=10, color=INK, labelcolor=INK)
            for spine in axes.spines.values():
                spine.set_color(INK)
                spine.set_linewidth(0.6)
            return
        axes.set_axis_off()
        self._add_length(axes, scaled, box, name)
        self._add_directions(box, view)

    def _add_length(self, axes, extent, box, unit):
        length = round_length(0.22 * (extent[1] - extent[0]))
        pixel = (extent[1] - extent[0]) / box[2]
        x1, y = extent[1] - 12 * pixel, extent[2] + 10 * pixel
        axes.plot([x1 - length, x1], [y, y], color=INK, lw=2, solid_capstyle="butt")
        axes.text(x1 - length / 2, y + 5 * pixel, f"{length:g} {unit}".strip(), ha="center", va="bottom", color=INK,
                  fontsize=10, bbox={"facecolor": "white", "alpha": 0.7, "lw": 0, "pad": 1})
        axes.set_xlim(extent[0], extent[1])
        axes.set_ylim(extent[2], extent[3])

    def _add_directions(self, box, view):
        axes = self.axes((box[0], box[1], 74, 74))
        axes.set_axis_off()
        axes.set_xlim(-1.5, 1.5)
        axes.set_ylim(-1.5, 1.5)
        for i, letter in enumerate("xyz"):
            x, y = view.right[i], view.up[i]
            if math.hypot(x, y) < 0.05:
                continue
            axes.annotate("", (x, y), (0, 0), arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1, "shrinkA": 0,
                                                          "shrinkB": 0})
            axes.text(1.28 * x, 1.28 * y, letter, ha="center", va="center", fontsize=10, color=INK)

    def add_title(self, column, left, title, below):
        """Over a column whose panels begin at this pixel."""
        x = left if self.has_axes else MARGIN + column * self.cell_width
        self.figure.text(x / self.width, 1 - 26 / self.height, plain(title), fontsize=15, weight="bold", color=INK,
                         va="center")
        self.figure.text(x / self.width, 1 - 48 / self.height, below, fontsize=11, color=INK, va="center")

    def add_bar(self, coloring, title, after):
        """The scale, right of this pixel: round numbers, the isolines on it, points where values lie beyond."""
        left = min(after + 26, self.width - BAR + 18) if self.has_axes else self.width - BAR + 18
        height = min(560, int(0.66 * (self.height - self.bottom - TITLE)))
        bottom = self.bottom + (self.height - self.bottom - TITLE - height) // 2
        axes = self.axes((left, bottom, 20, height))
        low, high = coloring.seen
        extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(
            (low < coloring.norm.vmin, high > coloring.norm.vmax), "neither")
        mappable = matplotlib.cm.ScalarMappable(coloring.norm, coloring.map)
        bar = self.figure.colorbar(mappable, cax=axes, extend=extend)
        if isinstance(coloring.norm, matplotlib.colors.LogNorm):
            decades = math.log10(coloring.norm.vmax / coloring.norm.vmin)
            bar.ax.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5) if decades < 4 else (1,)))
            bar.ax.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
            bar.ax.yaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(
                lambda v, _: f"{v:g}" if 1e-3 <= v < 1e4 else f"{v:.0e}".replace("e+0", "e").replace("e-0", "e-")))
        else:
            bar.locator = matplotlib.ticker.MaxNLocator(8, steps=(1, 2, 5, 10))
            bar.update_ticks()
        shown = [v for v in coloring.isolines if coloring.norm.vmin <= v <= coloring.norm.vmax]
        if shown:
            bar.add_lines(shown, [INK] * len(shown), [0.9] * len(shown))
        bar.outline.set_linewidth(0.6)
        bar.outline.set_edgecolor(INK)
        bar.ax.tick_params(labelsize=10, color=INK, labelcolor=INK)
        self.figure.text((left - 6) / self.width, (bottom + height + 26) / self.height,
                         "\n".join(wrapped(title, self.width - left)), fontsize=TITLE_SIZE, color=INK, va="bottom")

    def add_legend(self, names, colors, edges):
        handles = [matplotlib.patches.Patch(facecolor=np.asarray(c) / 255, edgecolor=np.asarray(e) / 255,
                                            label=plain(n)) for n, c, e in zip(names, colors, edges)]
        self.figure.legend(handles=handles, loc="lower center", ncol=min(len(handles), 10), frameon=False, fontsize=11,
                           labelcolor=INK, handlelength=1.4)

    def save(self, name):
        self.figure.savefig(name, dpi=DPI, format="png", metadata={"Software": "pamr-picture"})
