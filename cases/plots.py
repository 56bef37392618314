# SPDX-License-Identifier: GPL-3.0-or-later
"""How the plots of the cases look: one figure with axes, written as .svg or .png with the same bytes each time."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.figure

INK = "#222936"
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00")  # Okabe and Ito: told apart by all eyes
MARKS = ("o", "s", "^", "D", "v")
matplotlib.rcParams.update({"svg.hashsalt": "pamr", "svg.fonttype": "none", "font.size": 10, "text.color": INK,
                            "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
                            "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.6, "axes.axisbelow": True,
                            "legend.frameon": False, "errorbar.capsize": 2})


def new_plot(x_label, y_label, size=(7.2, 4.4)):
    """A figure and its axes."""
    figure = matplotlib.figure.Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    return figure, axes


def save(figure, name):
    if not name.endswith((".svg", ".png")):
        raise SystemExit(f"{name}: expected the name of a picture that ends in .svg or .png")
    figure.savefig(name, dpi=150, metadata={"Date": None} if name.endswith(".svg") else {"Software": None})
