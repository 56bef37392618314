#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Charge, force and energy of a charged rod in a charged tube, where the equation is linear (lap psi = psi).

Usage: bessel.py [--shift D] [--length L]     (needs the Debian packages python3-numpy and python3-scipy)

The potential is a sum of K_n(distance from the rod's axis) cos n phi and I_n(distance from the tube's axis) cos n theta,
which solve the equation exactly; their weights are those that give the potentials of both walls at 400 points each (least
squares). Prints the rod's charge, the force on it along the shift by the Maxwell stress over a circle around it, and the
energy, the integral of (|grad psi|^2 + psi^2) / 2, of a piece of the whole tube. With no shift the first two terms are
the closed form, and the others vanish.
"""
import argparse

import numpy as np
from scipy.special import iv, ivp, kv, kvp

ROD, TUBE, AT_ROD, AT_TUBE = 1.0, 3.0, 2.0, -1.0


class Tube:
    def __init__(self, shift, terms=16, points=400):
        self.shift, self.n = shift, np.arange(terms + 1)
        angle = 2 * np.pi * np.arange(points) / points
        rod = np.column_stack([shift + ROD * np.cos(angle), ROD * np.sin(angle)])
        tube = TUBE * np.column_stack([np.cos(angle), np.sin(angle)])
        matrix = self.functions(np.concatenate([rod, tube]))
        given = np.concatenate([np.full(points, AT_ROD), np.full(points, AT_TUBE)])
        self.weight = np.linalg.lstsq(matrix, given, rcond=None)[0]
        self.misfit = abs(matrix @ self.weight - given).max()
        self.angle = angle

    def polar(self, xy):
        around_rod = xy - [self.shift, 0]
        return [(np.hypot(*p.T)[:, None], np.arctan2(p[:, 1], p[:, 0])[:, None]) for p in (around_rod, xy)]

    def functions(self, xy):
        (r, phi), (s, theta) = self.polar(xy)
        # Scaled to 1 at their walls.
        return np.hstack([kv(self.n, r) / kv(self.n, ROD) * np.cos(self.n * phi),
                          iv(self.n, s) / iv(self.n, TUBE) * np.cos(self.n * theta)])

    def gradient(self, xy):
        (r, phi), (s, theta) = self.polar(xy)
        n = self.n

        def turned(along, across, angle):
            return np.stack([along * np.cos(angle) - across * np.sin(angle),
                             along * np.sin(angle) + across * np.cos(angle)])

        inner = turned(kvp(n, r) / kv(n, ROD) * np.cos(n * phi), -n / r * kv(n, r) / kv(n, ROD) * np.sin(n * phi), phi)
        outer = turned(ivp(n, s) / iv(n, TUBE) * np.cos(n * theta), -n / s * iv(n, s) / iv(n, TUBE) * np.sin(n * theta),
                       theta)
        return np.concatenate([inner, outer], axis=2) @ self.weight  # 2 x points

    def charges(self):
        """Of the rod and the tube, per length."""
        normal = np.column_stack([np.cos(self.angle), np.sin(self.angle)])
        step = 2 * np.pi / len(self.angle)
        rod = -(self.gradient(ROD * normal + [self.shift, 0]) * normal.T).sum() * ROD * step
        tube = (self.gradient(TUBE * normal) * normal.T).sum() * TUBE * step
        return rod, tube

    def force(self, radius=1.1):
        normal = np.column_stack([np.cos(self.angle), np.sin(self.angle)])
        xy = radius * normal + [self.shift, 0]
        g, psi = self.gradient(xy), self.functions(xy) @ self.weight
        through = (g * normal.T).sum(axis=0)
        density = g[0] * through - normal[:, 0] * ((g ** 2).sum(axis=0) + psi ** 2) / 2
        return density.sum() * radius * 2 * np.pi / len(self.angle)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shift", type=float, default=0.0)
    parser.add_argument("--length", type=float, default=0.5)
    o = parser.parse_args()
    few, tube = Tube(o.shift, 12), Tube(o.shift)
    rod_charge, tube_charge = tube.charges()
    # The equation is linear: twice the energy is the sum of potential times charge.
    energy = (AT_ROD * rod_charge + AT_TUBE * tube_charge) / 2
    print(f"misfit of the potentials {tube.misfit:.1e}; with 12 terms the force differs by "
          f"{abs(few.force() - tube.force()):.1e}, over another circle by {abs(tube.force(1.3) - tube.force()):.1e}")
    print(f"charge of the rod {o.length * rod_charge:.9f}, of the tube {o.length * tube_charge:.9f}")
    print(f"force on the rod along the shift {o.length * tube.force():.9f}")
    print(f"energy {o.length * energy:.9f}")


if __name__ == "__main__":
    main()
