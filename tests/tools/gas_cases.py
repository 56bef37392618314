# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of pamr-dsmc for a cube that a stream of nitrogen passes."""

NITROGEN = """
[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
"""


def gas_in_a_cube(species=NITROGEN, rotation="", per_cell=8.0, transient=10, sampling=20, end="", **sides):
    """The case. `sides` has the boundary of each side as the text of a table; the others are inflow."""
    boundary = {side: 'kind = "inflow"' for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")} | sides
    return species + "[gas]\nfractions = { N2 = 1.0 }\n" + rotation + """[stream.free]
density = 1e20
temperature = 300.0
speed = 400.0
[boundary]
""" + "".join(f"{side} = {{ {text} }}\n" for side, text in boundary.items()) + f"""[particles]
per_cell = {per_cell}
[domain]
unit = 1.0
[time]
step = 5e-5
[run]
transient = {transient}
sampling = {sampling}
{end}"""
