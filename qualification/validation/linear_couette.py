#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shear between diffuse walls that move slowly against each other, by the linear Boltzmann equation on a grid, without chance:
for hard spheres and for the model of Bhatnagar, Gross and Krook (BGK).

Usage: linear_couette.py [DELTA]

Prints the shear over p U / v, v = sqrt(2 k T / m), at delta = height p / (viscosity v); 0.5642 without collisions. As a check
the viscosity that follows from the same matrices, over the first approximation of Chapman and Enskog: 1.016034 for hard spheres
(S. Chapman, T. G. Cowling, The Mathematical Theory of Non-Uniform Gases, 1970). The kernel of hard spheres is that of D. Hilbert
(C. Cercignani, The Boltzmann Equation and Its Applications, 1988)."""
import math
import sys

import numpy as np
from numpy.polynomial.legendre import leggauss, legder, legval

FASTEST, DEGREES = 4.5, 16


def points(n, low, high):
    x, w = leggauss(n)
    return low + (high - low) * (x + 1) / 2, (high - low) * w / 2


class Gas:
    """Collisions on a grid of speeds, lengths in units of the mean free path times a constant: of each degree of Legendre's
    polynomials a matrix of gains, less a frequency."""

    def __init__(self, model, n=40):
        self.c, self.weight = points(n, 0, FASTEST)
        self.weight *= self.c**2
        self.gains, self.frequency, self.first = getattr(self, model)()
        # of hard spheres the kernel has a kink where both speeds are one: its diagonal takes what the quadrature leaves out, so
        # that momentum is kept
        missing = self.frequency - self.gains[0] @ self.c / self.c
        self.gains = [gain + np.diag(missing) for gain in self.gains]
        shear = self.gains[1] if len(self.gains) > 1 else 0.0
        moved = np.linalg.solve(np.diag(self.frequency) - shear, 2 * self.c**2)
        self.viscosity = 4 / 15 * math.pi * (self.maxwell() * self.weight * self.c**2) @ moved

    def maxwell(self):
        return math.pi**-1.5 * np.exp(-self.c**2)

    def bgk(self):
        return [8 / 3 * math.pi * np.outer(self.c, self.c * self.maxwell() * self.weight)], np.ones_like(self.c), 0.5

    def hard_spheres(self):
        half, weight = points(200, 0, 1)  # of the sine of half the angle between two velocities, which smooths 1 / |c - w|
        c, w = self.c[:, None, None], self.c[None, :, None]
        cosine = 1 - 2 * half**2
        g = np.sqrt((c - w)**2 + 4 * c * w * half**2)
        kernel = 2 / math.pi**1.5 / g * np.exp(-((c * w * cosine - w**2) / g)**2) - math.pi**-1.5 * np.exp(-w**2) * g
        kernel *= 8 * math.pi * half * weight
        gains = [kernel @ legval(cosine, [0] * degree + [1]) * self.weight for degree in range(1, DEGREES + 1)]
        frequency = [math.exp(-x * x) / math.sqrt(math.pi) + (x + 0.5 / x) * math.erf(x) for x in self.c]
        return gains, np.array(frequency), 5 / 16 * math.sqrt(math.pi / 2)


def shear(gas, height, directions=24, layers=160):
    """Over p U / v. The solution of walls that move at -+ 1 is cos(azimuth) F(x, c, mu), F(height - x, c, -mu) = -F(x, c, mu), so that
    only mu > 0 is kept. Gains are linear in a layer; flights and gains follow each other until the shear stands."""
    mu, weight = points(directions, 0, 1)
    sine = np.sqrt(1 - mu**2)
    degrees = range(1, len(gas.gains) + 1)
    parts = [sine * legval(mu, legder([0] * degree + [1])) for degree in degrees]
    x = (1 - np.cos(np.pi * np.arange(layers + 1) / layers)) / 2 * height
    c, frequency = gas.c[:, None], gas.frequency[:, None]
    depth = np.diff(x)[:, None, None] * frequency / (c * mu)
    lost = -np.expm1(-depth)
    late = np.where(depth > 1e-3, 1 - lost / depth, depth / 2 - depth**2 / 6)
    moved = np.zeros((layers + 1, len(gas.c), directions))
    moved[0] = -c * sine
    gained = np.zeros_like(moved)
    found, before = 1.0, 0.0
    while abs(found - before) > 1e-8:
        for i in range(layers):
            moved[i + 1] = moved[i] * (1 - lost[i]) + (gained[i] * (lost[i] - late[i]) + gained[i + 1] * late[i]) / frequency
        gained = np.zeros_like(moved)
        for degree, part, gain in zip(degrees, parts, gas.gains):
            sign = -1 if degree % 2 else 1  # of F at -mu, and of the part there
            moment = (moved + sign * moved[::-1]) @ (weight * part)
            gained += (2 * degree + 1) / (2 * degree * (degree + 1)) * (moment @ gain.T)[:, :, None] * part
        flux = -2 * math.pi * (moved + moved[::-1]) @ (weight * mu * sine) @ (gas.weight * gas.c**2 * gas.maxwell())
        found, before = flux.mean(), found
    assert np.ptp(flux) < 1e-3 * found, "the shear must be the same in every layer"
    return found


def shear_of(model, delta, of_first_approximation=False):
    """At delta by the viscosity, or by its first approximation, from which the diameter of hard spheres is commonly taken."""
    gas = Gas(model)
    return shear(gas, 2 * delta * (gas.first if of_first_approximation else gas.viscosity))


def main():
    delta = float(sys.argv[1]) if len(sys.argv) > 1 else 1.0
    for model in ("bgk", "hard_spheres"):
        gas = Gas(model)
        print(f"{model}: viscosity {gas.viscosity / gas.first:.5f}, shear {shear_of(model, delta):.4f}, "
              f"with delta by the first approximation of the viscosity {shear_of(model, delta, True):.4f}")


if __name__ == "__main__":
    main()
