# SPDX-License-Identifier: GPL-3.0-or-later
"""The error bars of pamr-pb: a bar that is printed holds the truth, a bar that would not is withheld with its reason."""
import json
import math
import pathlib
import re
import subprocess
import sys

import h5py

CASES = pathlib.Path(__file__).resolve().parents[2] / "cases"
sys.path.append(str(CASES / "charged-sphere"))
import shell  # noqa: E402
from pb_cases import MAGNESIUM, SALT, SEA, between, boundary, cell, cube, goals_of, integrate, pressure, solve, source, stated
from tool_run import of_full_level, of_one_process, prepare_alone, run, run_tests

prepare_alone("pamr-mesh")
BOX = "of it for the box"


def plates(low, high, ions=SALT):
    """Plates at z = 0 and 1 with these potentials: charge of the lower one, force on it and energy, by shooting with the
    method of Runge and Kutta."""

    def slopes(psi, slope):
        psi, slope = max(-60, min(60, psi)), max(-1e9, min(1e9, slope))
        return slope, source(ions, psi), slope * slope / 2 + pressure(ions, psi)

    def shoot(slope, n=400):
        psi, energy = float(low), 0.0
        for i in range(n):
            # Steps that grow with the distance from the lower plate, whose layer is the thinner one.
            h = ((i + 1) ** 2 - i ** 2) / n ** 2
            a = slopes(psi, slope)
            b = slopes(psi + h / 2 * a[0], slope + h / 2 * a[1])
            c = slopes(psi + h / 2 * b[0], slope + h / 2 * b[1])
            d = slopes(psi + h * c[0], slope + h * c[1])
            psi, slope, energy = (value + h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k])
                                  for k, value in enumerate((psi, slope, energy)))
            if abs(psi) > 50:
                break
        return psi, energy

    steep, flat = -3 * math.cosh(low), 3 * math.cosh(low)
    for _ in range(60):
        middle = (steep + flat) / 2
        steep, flat = (steep, middle) if shoot(middle)[0] > high else (middle, flat)
    return {"charge": -steep, "force-z": steep ** 2 / 2 - pressure(ions, low), "energy": shoot(steep)[1]}


def graded_box(name, thickness):
    """A column of bricks 0 < x < 20 whose first one has this thickness; those that follow are each 1.4 times as thick, up to 0.1."""
    ends, thick = [0.0], thickness
    while ends[-1] < 20:
        ends.append(ends[-1] + min(thick, 0.1))
        thick *= 1.4
    ends = [20 * x / ends[-1] for x in ends]
    n = len(ends) - 1
    subprocess.run([sys.executable, "-B", CASES / "box_mesh.py", "box.msh", str(n), "1", "1", "0", str(n), "0.1"], check=True)
    head, nodes, rest = re.split(r"(?<=\$Nodes\n)|(?=\$EndNodes)", pathlib.Path("box.msh").read_text())
    count, *nodes = nodes.splitlines()
    words = [line.split() for line in nodes]
    nodes = [f"{node} {ends[round(float(x))]!r} {y} {z}" for node, x, y, z in words]
    pathlib.Path("box.msh").write_text(head + "\n".join([count, *nodes, rest]))
    run("pamr-convert", "box.msh", name, "--force", "--quiet")
    return name


@of_one_process
def test_a_wall_keeps_its_charge_beside_a_very_large_one():
    for order, potential in ((1, 18), (2, 18), (1, 40), (1, 49)):
        density = 2 * math.sinh(potential / 2)
        mesh = graded_box("box.hdf", 0.3 / density)
        exact = 0.01 * (2 * math.sinh(0.005) - 8 * math.exp(-20))  # all but 4 exp(-x) of the potential falls in the wall's layer
        for kind, value in (("charge", density), ("potential", potential)):
            text = f'[solver]\norder = {order}\n[estimator]\ngoal = "charge"\ngoal_patch = "xmax"\n'
            report, _ = solve(text + boundary(xmin=(kind, value), xmax=("potential", 0.01)), mesh)
            goal = goals_of(report)["charge"]
            assert goal["error_bar"] is not None, (order, potential, kind, goal)
            assert abs(goal["corrected"] - exact) < goal["error_bar"] < 0.01 * exact, (order, potential, kind, goal, exact)


@of_one_process
def test_a_bar_of_first_order_holds_the_truth_between_plates_or_is_withheld():
    exact = {pair: plates(*pair) for pair in ((4, 4), (6, -3), (3, 0), (2, -1))}
    assert abs(exact[4, 4]["charge"] - 6.20889126) < 1e-6 and abs(exact[6, -3]["charge"] - 21.4530878) < 1e-4
    n_printed = 0
    for (low, high), n, quadrature in (((4, 4), 12, "nodal"), ((6, -3), 12, "nodal"), ((3, 0), 12, "nodal"),
                                       ((2, -1), 9, "nodal"), ((4, 4), 12, "gauss"), ((2, -1), 12, "gauss")):
        text = (f'[solver]\nquadrature = "{quadrature}"\n[estimator]\ngoals = ["force-z", "charge", "energy"]\n'
                'goal_patch = "zmin"\n' + boundary(zmin=("potential", low), zmax=("potential", high)))
        report, printed = solve(text, cube(n))
        ratio = report["layers"]["zmin"]["ratio"]
        for name, goal in goals_of(report).items():
            where = (low, high, n, quadrature, name, goal)
            is_sound = ratio <= 0.2 if name == "charge" else quadrature == "nodal" or name == "energy"
            assert (goal["error_bar"] is not None) == is_sound, where
            assert (goal["error_withheld"] is None) == is_sound, where
            if not is_sound:
                assert "order = 2" in goal["error_withheld"], where
                assert "no error bar: " + goal["error_withheld"] in " ".join(printed.out.split()), where
                continue
            n_printed += 1
            assert abs(goal["corrected"] - exact[low, high][name]) < goal["error_bar"], (where, exact[low, high][name])
        best = report["best"]["zmin"]["charge"]
        assert (best["error"], best["error_withheld"]) == (goals_of(report)["charge"]["error_bar"],
                                                           goals_of(report)["charge"]["error_withheld"])
        assert report["best"]["zmax"]["charge"]["error"] is None and "error_withheld" not in report["best"]["zmax"]["charge"]
        # A charge that is not a goal has its warning in the line of its value.
        line = printed.out.split("patch zmax: area")[1].split("best charge")[1].split("\n  best")[0]
        assert ("too large: cells" in " ".join(line.split())) == (report["layers"]["zmax"]["ratio"] > 0.2), line
        assert report["beyond_error_bars"] is None and BOX not in printed.out
    assert n_printed == 13


@of_one_process
def test_bars_of_first_order_hold_where_few_cells_are_in_a_layer():
    # Cells of 0.5 to 1 layers: the energy has no bar of charges, and all cells err alike. At 1 and -1 with two cells between the
    # plates the integrand of the force's correction is 0 at all nodes.
    for n, low, high in ((2, 2.5, 2.5), (4, 4, 4), (9, 5.5, 5.5), (12, 5, 5), (2, 1, -1), (2, 2.5, -2.5)):
        text = ('[estimator]\ngoals = ["force-z", "energy"]\ngoal_patch = "zmin"\n'
                + boundary(zmin=("potential", low), zmax=("potential", high)))
        exact = plates(low, high)
        for name, goal in goals_of(solve(text, cube(n))[0]).items():
            error = abs(goal["corrected"] - exact[name])
            assert error < goal["error_bar"] < 0.4 * abs(exact[name]), (n, low, high, name, goal, exact[name])


@of_one_process
def test_a_bar_on_a_coarse_mesh_says_so():
    # Between plates at 1 and 0.3 the stress of the field is nearly that of the ions: shares are large beside the force.
    says = "coarse mesh: compare two levels"
    text = ('[estimator]\ngoals = ["force-z", "energy"]\ngoal_patch = "zmin"\n'
            + boundary(zmin=("potential", 1), zmax=("potential", 0.3)))
    for n, coarse in ((2, {"force-z"}), (12, set())):
        report, printed = solve(text, cube(n))
        lines = [" ".join(line.split()) for line in printed.out.replace("\n    ", " ").split("\n")]
        for name, goal in goals_of(report).items():
            share = goal["error_bound"] / abs(goal["corrected"])
            assert goal["error_bar"] is not None and goal["coarse"] == (name in coarse) == (share > 0.1), (n, name, goal)
            of_goal = [line for line in lines if line.startswith((f"goal {name} ", f"best {name} ")) and "no goal" not in line]
            assert of_goal and all((says in line) == (name in coarse) for line in of_goal), (of_goal, printed.out)


def spheres(inner, outer, ions, radii=(1.0, 3.0)):
    """Spheres of these radii with these potentials: charge of the inner one, of the outer one, energy of an octant."""
    exact = between(("potential", inner), ("potential", outer), ions, radii)
    return exact | dict(zip(("charge", "of outer"), exact["charge"]))


def shell_with_sheet(n, layers):
    """Octants of spheres of radius 1 and 3, and of a sheet of radius 2 between them, with n edges along each side."""
    points, cells, neighbors, names = shell.shell(1.0, 3.0, n, layers, 1)
    radius = [math.sqrt(sum(x * x for x in point)) for point in points]
    corners = [[int(node) for j, node in enumerate(cell) if j != i] for cell in cells for i in range(4)]
    faces = {tuple(sorted(face)): 6 for face in corners if all(abs(radius[node] - 2) < 1e-9 for node in face)}
    faces.update({tuple(face): -int(patch) for face, patch in zip(corners, neighbors.ravel()) if patch < 0})
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "6",
             *(f'2 {i} "{name}"' for i, name in enumerate([*names, "sheet"], 1)), "$EndPhysicalNames", "$Nodes", len(points),
             *(f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points.tolist(), 1)), "$EndNodes", "$Elements",
             len(faces) + len(cells)]
    groups = [(2, patch, face) for face, patch in faces.items()] + [(4, 7, cell) for cell in cells.tolist()]
    lines += [f"{i} {kind} 2 {group} {group} " + " ".join(str(node + 1) for node in nodes)
              for i, (kind, group, nodes) in enumerate(groups, 1)]
    pathlib.Path("shell.msh").write_text("\n".join(map(str, lines)) + "\n$EndElements\n")
    pathlib.Path("shell.toml").write_text("".join(
        f'[[surface]]\nname = "{name}"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = {r}\n'
        for name, r in (("sphere", 1), ("sheet", 2), ("outer", 3))))
    run("pamr-convert", "shell.msh", f"shell{n}.hdf", "--surfaces", "shell.toml", "--force", "--quiet", serial=True)
    return f"shell{n}.hdf"


def test_bars_hold_beside_a_curved_sheet_at_a_potential():
    sphere, sheet, outer = 0.5, 1.0, -0.5
    low, high = spheres(sphere, sheet, SALT, (1.0, 2.0)), spheres(sheet, outer, SALT, (2.0, 3.0))
    exact = {"charge": low["of outer"] + high["charge"], "energy": low["energy"] + high["energy"]}
    for n, layers in ((3, 6), (4, 4)):  # with edges that are straightened, and without
        mesh = shell_with_sheet(n, layers)
        for order, kind in ((2, "potential"), (1, "potential"), (2, "charge")):
            goals = ["charge", "energy"] if kind == "potential" else ["energy"]
            text = (f'[solver]\norder = {order}\n[estimator]\ngoals = {json.dumps(goals)}\ngoal_patch = "sheet"\n'
                    + boundary(sphere=("potential", sphere), sheet=(kind, sheet), outer=("potential", outer)))
            for name, goal in goals_of(solve(text, mesh)[0]).items():
                if order == 1 or kind == "charge":
                    assert "the curvature of patch sheet" in goal["error_withheld"], goal
                    continue
                error = abs(goal["corrected"] - exact[name])
                assert error < goal["error_bar"] < 0.02 * abs(exact[name]), (n, name, goal, exact)


@of_one_process
@of_full_level
def test_bars_hold_for_unequal_and_mixed_salts():
    goals = '[estimator]\ngoals = ["force-z", "charge", "energy"]\ngoal_patch = "zmin"\n'
    for ions, low, high, order, n in ((MAGNESIUM, -2, 1, 2, 4), (MAGNESIUM, 2, 1, 2, 4), (SEA, -1.5, 0.5, 2, 4),
                                      (MAGNESIUM, -1, 0.5, 1, 12), (SEA, 1, -0.5, 1, 12)):
        exact = plates(low, high, ions)
        head = f"[solver]\norder = {order}\n" + stated(ions) + goals
        report, printed = solve(head + boundary(zmin=("potential", low), zmax=("potential", high)), cube(n))
        for name, goal in goals_of(report).items():
            if goal["error_bar"] is None:
                assert order == 1 and name == "charge", goal
                continue
            assert abs(goal["corrected"] - exact[name]) < goal["error_bar"] < 0.05 * abs(exact[name]), (ions, goal, exact)
        assert "Debye length" in printed.out and "charge +2" in printed.out, printed.out
    # An isolated plate has the charge of Grahame, and no force; a 2:1 salt by name is the same equation.
    for low in (-1.5, 2.0):
        charge = math.copysign(math.sqrt(2 * pressure(MAGNESIUM, low)), low)
        far = integrate(MAGNESIUM, (1.0, low), 2.0, -charge, 0)[0]
        head = '[electrolyte]\nsalt = "2:1"\n[solver]\norder = 2\n'
        report, _ = solve(head + goals + boundary(zmin=("potential", low), zmax=("potential", far)), cube(5))
        found = goals_of(report)
        assert abs(found["charge"]["corrected"] - charge) < found["charge"]["error_bar"] < 0.01 * abs(charge), (found, charge)
        assert abs(found["force-z"]["corrected"]) < found["force-z"]["error_bar"] < 0.05, found


@of_one_process
@of_full_level
def test_bars_hold_for_unequal_and_mixed_salts_around_a_sphere():
    exact = spheres(1, 0.798027387, SALT)
    assert abs(exact["charge"] - 18.0985233) < 1e-6 and abs(exact["energy"] - 3.84219146) < 1e-7, exact
    mesh, head = cell("salts.hdf", 0.25, 0.7), '[estimator]\ngoals = ["charge", "energy"]\ngoal_patch = "sphere"\n'
    for ions, inner, outer in ((MAGNESIUM, -1.5, 0.5), (MAGNESIUM, 2, -0.5), (SEA, 1, 0)):
        exact = spheres(inner, outer, ions)
        text = stated(ions) + "[solver]\norder = 2\n" + head
        for name, goal in goals_of(solve(text + boundary(sphere=("potential", inner), outer=("potential", outer)), mesh)[0]).items():
            assert abs(goal["corrected"] - exact[name]) < goal["error_bar"] < 2e-3 * abs(exact[name]), (ions, goal, exact)


@of_one_process
def test_the_correction_has_the_source_term_between_the_nodes():
    # With nodal quadrature sinh psi is no straight line between the nodes: left out, half of the error stayed.
    exact = plates(3, 0)["charge"]
    text = '[estimator]\ngoal = "charge"\ngoal_patch = "zmin"\n' + boundary(zmin=("potential", 3), zmax=("potential", 0))
    for n in (8, 12):
        goal = solve(text, cube(n))[0]["goal"]
        assert abs(goal["corrected"] - exact) < 0.1 * abs(goal["value"] - exact), (n, goal, exact)


@of_one_process
def test_a_charge_given_on_a_flat_wall_keeps_the_bars():
    exact = plates(2, -1)
    for order, n in ((1, 14), (2, 5)):
        text = (f'[solver]\norder = {order}\n[estimator]\ngoals = ["force-z", "energy"]\ngoal_patch = "zmin"\n'
                + boundary(zmin=("charge", exact["charge"]), zmax=("potential", -1)))
        for name, goal in goals_of(solve(text, cube(n))[0]).items():
            assert abs(goal["corrected"] - exact[name]) < goal["error_bar"], (order, name, goal, exact[name])
    # Of first order on cells that are too high it does not: the bar of the force was 1.5 times too small.
    steep = plates(6, -3)
    text = ('[estimator]\ngoals = ["force-z"]\ngoal_patch = "zmin"\n'
            + boundary(zmin=("charge", steep["charge"]), zmax=("potential", -3)))
    goal = solve(text, cube(12))[0]["goal"]
    assert goal["error_bar"] is None and "patch zmin" in goal["error_withheld"], goal


@of_one_process
@of_full_level
def test_bars_hold_where_a_charge_is_given_on_a_curved_wall():
    # A sphere at 1 in a sphere of charge density 0.5: inward integration of the spherical equation gives the charge
    # 18.0985233, the energy 3.84219146 of an octant, and 0.79802739 on the outer sphere.
    # On fewer cells (1,271) bars are up to 1.33 times too small, of given potentials up to 1.12.
    exact, mesh = {"charge": 18.0985233, "energy": 3.84219146}, cell("finer.hdf", 0.2, 0.4)
    head = '[solver]\norder = 2\n[estimator]\ngoals = ["charge", "energy"]\ngoal_patch = "sphere"\n'
    for outer in (("charge", 0.5), ("potential", 0.7980273872929314)):
        report, printed = solve(head + boundary(sphere=("potential", 1), outer=outer), mesh)
        for name, goal in goals_of(report).items():
            assert goal["error_withheld"] is None, goal
            assert abs(goal["corrected"] - exact[name]) < goal["error_bar"] < 1e-4 * exact[name], (outer, goal, exact)
        assert "+-" in printed.out


@of_one_process
@of_full_level
def test_a_body_of_facets_without_a_surface_has_no_bars_of_second_order():
    # Two concentric spheres at 1 and 0.798, as above; the facets of this mesh miss over ten of its bars.
    cell("bare.hdf", 0.25, 0.7)
    with h5py.File("bare.hdf", "r+") as file:
        surfaces = file["PAMR/patches/surfaces"]
        n = len(surfaces)
        for name, value in (("PAMR/patches/surfaces", [""] * n), ("PAMR/surfaces", "")):
            del file[name], file["PAMR/checksums"].attrs[name]
            file[name] = value
    head = '[solver]\norder = 2\n[estimator]\ngoals = ["charge", "energy"]\ngoal_patch = "sphere"\n'
    for sphere in (("potential", 1), ("charge", 1.44)):
        text = head.replace('"charge", ', "") if sphere[0] == "charge" else head
        text += boundary(sphere=sphere, outer=("potential", 0.7980273872929314))
        report, printed = solve(text, "bare.hdf")
        for goal in report["goals"]:
            assert goal["error_bar"] is None and "facets of patch sphere" in goal["error_withheld"], goal
        assert "+-" not in printed.out
    # Flat patches need no surface.
    report, _ = solve(head.replace('"sphere"', '"zmin"') + boundary(zmin=("potential", 1), zmax=("charge", 0.5)), cube(3))
    assert all(goal["error_bar"] is not None for goal in report["goals"]), report["goals"]


@of_one_process
def test_bars_of_second_order_hold_where_the_potential_is_even_about_the_middle():
    # Linear, at 1 and 0.8: a cosh, whose third order is next to nothing. The bar of the energy was a 19th of its error on
    # 6 cells, a 9th on 48.
    slope = (0.8 - math.cosh(1)) / math.sinh(1)  # psi = cosh z + slope sinh z
    exact = {"charge": -slope, "energy": 0.5 * (0.8 * (math.sinh(1) + slope * math.cosh(1)) - slope)}
    head = '[equation]\nlinear = true\n[solver]\norder = 2\n[estimator]\ngoals = ["charge", "energy"]\ngoal_patch = "zmin"\n'
    for n in (1, 2, 3):
        report, _ = solve(head + boundary(zmin=("potential", 1), zmax=("potential", 0.8)), cube(n))
        for name, goal in goals_of(report).items():
            error = abs(goal["corrected"] - exact[name])
            assert error < goal["error_bar"] < max(50 * error, 1e-8), (n, goal, exact[name])


@of_one_process
def test_bars_of_second_order_mean_something_where_a_plate_is_split_off_whose_layer_no_cell_resolves():
    # Plates at 15 and 0: 1 = integral of dpsi / sqrt(2 (cosh psi - 1) + slope^2) from 0 to 15. Bars were a million times
    # the charge, when fourth order was taken from second by the equation without a limit.
    slope = 4.534645767620099
    exact = {"charge": -slope, "force-z": -slope ** 2 / 2}
    text = ('[plate]\npatch = "zmin"\n[equation]\nsplit = true\n[solver]\norder = 2\n[estimator]\ngoals = ["charge", "force-z"]\n'
            'goal_patch = "zmax"\n' + boundary(zmin=("potential", 15), zmax=("potential", 0)))
    for name, goal in goals_of(solve(text, cube(4))[0]).items():
        assert abs(goal["corrected"] - exact[name]) < goal["error_bar"] < 0.02 * abs(exact[name]), (goal, exact[name])


@of_one_process
def test_a_ratio_just_above_its_limit_is_printed_with_the_digits_that_show_it():
    # Cells of a height of 0.2 before a layer that is a little thinner than a Debye length: 0.20025.
    text = '[estimator]\ngoals = ["charge"]\ngoal_patch = "zmin"\n' + boundary(zmin=("potential", 0.1), zmax=("potential", 0))
    report, _ = solve(text, cube(5))
    goal, ratio = report["goals"][0], report["layers"]["zmin"]["ratio"]
    assert 0.2 < ratio < 0.2049, ratio
    printed = float(goal["error_withheld"].split(" are ")[1].split()[0])
    assert printed > 0.2 and abs(printed - ratio) < 1e-3, goal


@of_one_process
def test_unresolved_layers_of_first_order_have_no_bars_and_a_given_charge_is_not_said_to_be_wrong():
    # A sphere at 6 in an insulated one, and the charge that this makes: 299.897372, energy of an octant 78.8021188. The
    # bars were 389 +- 19, 83.8 +- 4.6 and 65.3 +- 4.4.
    mesh = cell("cell.hdf", 0.2, 0.4)
    for sphere, goals in ((("potential", 6), ["charge", "energy"]), (("charge", 23.865074560254783), ["energy"])):
        text = f'[estimator]\ngoals = {json.dumps(goals)}\ngoal_patch = "sphere"\n'
        report, printed = solve(text + boundary(sphere=sphere, outer=("charge", 0.0)), mesh)
        for goal in report["goals"]:
            assert goal["error_bar"] is None and "patch sphere are" in goal["error_withheld"], goal
        assert "layer is not resolved" in printed.err
        assert ("too large" in printed.err) == (sphere[0] == "potential"), printed.err
        assert ("charge is given" in printed.err) == (sphere[0] == "charge"), printed.err


def test_bars_beside_far_field_walls_contain_the_box():
    # Two spheres at 1 at a distance of 3, linear: 1.6435404 without walls (cases/sphere-pair/expected.csv), and walls
    # 3 Debye lengths from the middle change it by 1 %.
    pathlib.Path("pair.toml").write_text(
        '[mesh]\nshape = "sphere-pair"\nlength_unit = "1"\n[mesh.geometry]\nradius = 1.0\ndistance = 3.0\n'
        'half_length = 4.5\nwidth = 3.0\ntop = 3.0\n[mesh.sizes]\nfar = 1.0\nsphere = 0.3\n')
    run("pamr-mesh", "pair.toml", "-o", "pair.hdf", "--quiet")
    head = ('[pair]\nradius = 1.0\ndistance = 3.0\n[force]\nmidplane = "symmetry_x"\n[equation]\nlinear = true\n'
            '[solver]\norder = 2\n[estimator]\ngoals = ["midplane", "charge"]\ngoal_patch = "sphere"\n')
    for condition in ("far-field", ("potential", 0)):
        walls = {name: condition for name in ("end", "side", "lid")}
        report, printed = solve(head + boundary(sphere=("potential", 1), **walls), "pair.hdf")
        with_bar = [line for line in printed.out.splitlines() if "+-" in line or "error bar " in line and "no error" not in line]
        assert with_bar and report["beyond_error_bars"] is None, printed.out
        if condition == "far-field":
            best = report["best"]["sphere"]["force-x"]
            assert 0.001 < abs(best["value"] - 1.6435404) < best["error"] < 0.3, best
            assert 0.9 * best["error"] < best["box_error"] < best["error"], best
            assert len(with_bar) == 4 and all(BOX in line for line in with_bar), printed.out
        else:
            assert report["goal"]["box_error"] == 0 and BOX not in printed.out, printed.out


run_tests(globals())
