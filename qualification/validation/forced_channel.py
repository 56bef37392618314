#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow between two diffuse walls, driven by a force, by particles without a mesh or this project's code: how far variable hard
spheres are from the equation of Bhatnagar, Gross and Krook (BGK) at the same viscosity.

Usage: forced_channel.py [DELTA [STEPS]]

Heights, v = sqrt(2 k T / m) and masses are 1. A small force a does to a channel without ends what a pressure gradient does, so
that the reduced flow rate is G = mean velocity / a (for BGK that of ducts.flow_of_bgk). At delta = 0.1 also the flow between an
inlet and an outlet that are 20 heights apart. +- is 95 % of 20 parts."""
import math
import sys

import numpy as np

FORCE, CELLS, PARTICLES = 0.05, 20, 50000


def leaving(draw, wall):
    """Velocities of molecules that leave walls at 0 and 1."""
    c = draw.normal(size=(len(wall), 3)) / math.sqrt(2)
    c[:, 1] = np.where(wall == 0, 1, -1) * np.sqrt(-np.log(1 - draw.random(len(wall))))
    return c


def fly(draw, x, y, c, left, length=math.inf):
    """Straight flights from wall to wall, for the time `left` of each. Yields who stays between the ends."""
    stays, moving = np.ones(len(y), dtype=bool), np.arange(len(y))
    while len(moving):
        wall = np.where(c[moving, 1] > 0, 1.0, 0.0)
        time = np.minimum((wall - y[moving]) / c[moving, 1], left[moving])
        x[moving] += c[moving, 0] * time
        y[moving] += c[moving, 1] * time
        left[moving] -= time
        stays[moving] = (length == math.inf) | ((x[moving] >= 0) & (x[moving] <= length))
        on = (left[moving] > 0) & stays[moving]
        moving, wall = moving[on], wall[on]
        y[moving] = wall
        c[moving] = leaving(draw, wall)
    return stays


def collide(draw, cell, n_cells, c, wanted, power):
    """Pairs of each cell by Bird's no-time-counter scheme; `wanted`: expected collisions of a pair with relative speed 1."""
    counts = np.bincount(cell, minlength=n_cells)
    order = np.argsort(cell, kind="stable")
    first = np.cumsum(counts) - counts
    most = 6.0  # relative speed, above that one pair of 1e7
    pairs = np.repeat(np.arange(n_cells), draw.poisson(0.5 * counts * (counts - 1) * wanted * most**power))
    a, b = (order[first[pairs] + (draw.random(len(pairs)) * counts[pairs]).astype(np.int64)] for _ in range(2))
    g = np.linalg.norm(c[a] - c[b], axis=1)
    hit = np.flatnonzero(draw.random(len(g)) * most**power < g**power)
    # A particle collides once a step at most: pairs that share one with another pair are left out, and `wanted` makes up for it.
    times = np.bincount(a[hit], minlength=len(c)) + np.bincount(b[hit], minlength=len(c))
    alone = hit[(times[a[hit]] == 1) & (times[b[hit]] == 1) & (a[hit] != b[hit])]
    a, b, g = a[alone], b[alone], g[alone]
    middle, cosine, turn = 0.5 * (c[a] + c[b]), 2 * draw.random(len(a)) - 1, 2 * np.pi * draw.random(len(a))
    sine = np.sqrt(1 - cosine**2)
    half = 0.5 * g[:, None] * np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=1)
    c[a], c[b] = middle + half, middle - half
    return len(alone) / max(len(hit), 1)


def relax(draw, cell, n_cells, c, probability):
    """BGK: some take a velocity of the Maxwellian of their cell; `probability` of each particle."""
    counts = np.maximum(np.bincount(cell, minlength=n_cells), 1)
    mean = np.stack([np.bincount(cell, c[:, i], n_cells) / counts for i in range(3)], axis=1)
    spread = sum(np.bincount(cell, c[:, i]**2, n_cells) / counts - mean[:, i]**2 for i in range(3)) / 3
    some = np.flatnonzero(draw.random(len(c)) < probability)
    c[some] = mean[cell[some]] + np.sqrt(spread[cell[some]])[:, None] * draw.normal(size=(len(some), 3))


def pair_rate(delta, omega):
    """Collisions a second of a pair with relative speed 1, times the density: the cross section follows from the viscosity
    (G. A. Bird, Molecular Gas Dynamics, 1994, equation 3.62)."""
    return delta * 15 / 4 * math.sqrt(math.pi / 2) * 2**(omega - 0.5) / math.gamma(4.5 - omega)


def mean_of(parts):
    """Mean of a series and its bound of 95 %."""
    groups = np.mean(np.reshape(parts[len(parts) % 20:], (20, -1)), axis=1)
    return groups.mean(), 2.09 * groups.std(ddof=1) / math.sqrt(20)


def flow(delta, omega=None, steps=3000, dt=0.1, seed=1):
    """G of a channel without ends; omega: of variable hard spheres; none: BGK."""
    draw = np.random.default_rng(seed)
    x, y, c = np.zeros(PARTICLES), draw.random(PARTICLES), draw.normal(size=(PARTICLES, 3)) / math.sqrt(2)
    parts, done, transient = [], 1.0, steps // 5
    for step in range(steps + transient):
        c[:, 0] += FORCE * dt
        fly(draw, x, y, c, np.full(PARTICLES, dt))
        cell = np.minimum((y * CELLS).astype(np.int64), CELLS - 1)
        if omega is None:
            relax(draw, cell, CELLS, c, 1 - math.exp(-delta * dt))
        else:
            wanted = pair_rate(delta, omega) * dt * CELLS / PARTICLES / done
            done += 0.1 * (collide(draw, cell, CELLS, c, wanted, 2 - 2 * omega) - done)
        if step >= transient:
            parts.append(c[:, 0].mean() / FORCE)
    return mean_of(parts)


def entering(draw, density, speed, warmth, dt):
    """Molecules a height wide that cross an end at 0 towards larger x within dt, and how much of dt is left to them."""
    depth = 5.0 * dt
    n = draw.poisson(density * depth)
    c = math.sqrt(0.5 * (1 + warmth)) * draw.normal(size=(n, 3))
    c[:, 0] += speed
    left = dt - draw.random(n) * depth / np.maximum(c[:, 0], 1e-9)
    come = left > 0
    return draw.random(come.sum()), c[come], left[come]


def open_channel(delta, omega, drift, warmth, steps, dt=0.1, seed=1, length=20.0, density=3000):
    """Mean flow, and the fall of pressure over the middle half, between pressures of 4/3 and 2/3; what enters has the flow
    `drift`, at the second end also another temperature. `density`: particles of a square height at pressure 1."""
    draw = np.random.default_rng(seed)
    along, across = 40, 10
    n_cells = along * across
    n = int(density * length)
    x, y, c = length * draw.random(n), draw.random(n), draw.normal(size=(n, 3)) / math.sqrt(2)
    keep = draw.random(n) < (4 / 3 - 2 / 3 * x / length) / (4 / 3)
    x, y, c = x[keep], y[keep], c[keep]
    flows, falls, done, transient = [], [], 1.0, 2000
    slope = lambda p: -10 * np.polyfit((np.arange(10, 30) + 0.5) * length / along - length / 2, p[10:30], 2)[1]
    for step in range(steps + transient):
        left = np.full(len(x), dt)
        low, high = 4 / 3, 2 / 3 * (1 - warmth)
        y1, c1, left1 = entering(draw, density * low, drift / low, 0.0, dt)
        y2, c2, left2 = entering(draw, density * high, -drift / high, warmth, dt)
        c2[:, 0] *= -1
        x = np.concatenate([x, np.zeros(len(y1)), np.full(len(y2), length)])
        y, c, left = np.concatenate([y, y1, y2]), np.concatenate([c, c1, c2]), np.concatenate([left, left1, left2])
        stays = fly(draw, x, y, c, left, length)
        x, y, c = x[stays], y[stays], c[stays]
        slab = np.minimum((x * along / length).astype(np.int64), along - 1)
        cell = slab * across + np.minimum((y * across).astype(np.int64), across - 1)
        if omega is None:
            here = np.bincount(cell, minlength=n_cells)[cell] * n_cells / length / density
            relax(draw, cell, n_cells, c, 1 - np.exp(-delta * here * dt))
        else:
            wanted = pair_rate(delta, omega) * dt * n_cells / length / density / done
            done += 0.1 * (collide(draw, cell, n_cells, c, wanted, 2 - 2 * omega) - done)
        if step >= transient:
            flows.append(c[:, 0].sum() / density / length)
            energy = 2 / 3 * np.bincount(slab, (c**2).sum(axis=1), along) * along / length / density
            falls.append(slope(energy - 2 / 3 * (drift**2)))
    return mean_of(flows), mean_of(falls)


def main():
    delta = float(sys.argv[1]) if len(sys.argv) > 1 else 0.1
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 3000
    models = (("BGK", None), ("variable hard spheres, omega = .81", 0.81), ("hard spheres", 0.5))
    for name, omega in models:
        g, bound = flow(delta, omega, steps)
        print(f"delta = {delta:g}, without ends, {name}: G = {g:.4f} +- {bound:.4f}", flush=True)
    # What enters has the flow that comes out, by repetition, and at the outlet the warmth of bgk_channel.py.
    for (name, omega), drift, warmth, times in zip(models, (0.0306, 0.0295), (-0.017, -0.016), (10, 15)) if delta == 0.1 else ():
        (j, off), (fall, fall_off) = open_channel(delta, omega, drift, warmth, times * steps // 3)
        print(f"delta = {delta:g}, 20 heights, {name}: flow {j:.5f} +- {off:.5f}, fall of pressure {fall:.5f} +- {fall_off:.5f}, "
              f"G = {20 * j / fall:.4f} +- {20 * j / fall * math.hypot(off / j, fall_off / fall):.4f}", flush=True)


if __name__ == "__main__":
    main()
