# SPDX-License-Identifier: GPL-3.0-or-later
"""Heat between two diffuse plates at any rarefaction, from the linearized model equation of Shakhov: within 2 % of the Boltzmann
equation. Source: E. M. Shakhov, "Generalization of the Krook kinetic relaxation equation", Fluid Dynamics 3 (1968)."""
import numpy as np


def heat_between_plates(rarefaction, n_places=401, n_speeds=80):
    """Heat flux over its free-molecular value; rarefaction: distance x pressure / (viscosity x sqrt(2RT)). Characteristics with
    sources linear between places, moments iterated; velocities in sqrt(2RT), reduced over the two directions along the plates."""
    t, weight = np.polynomial.legendre.leggauss(n_speeds)
    t, weight = 0.5 * (t + 1), 0.5 * weight
    c = 4.5 * t**3
    weight = np.exp(-c * c) / np.sqrt(np.pi) * weight * 13.5 * t * t
    a = rarefaction / (n_places - 1) / c
    kept = np.exp(-a)
    near = np.where(a < 1e-3, a / 2 - a * a / 6, 1 - (1 - kept) / a)
    far = 1 - kept - near
    density, temperature, heat = np.zeros(n_places), 0.5 * (0.5 - np.linspace(0, 1, n_places)), np.full(n_places, 0.3)
    wall = [-0.25, 0.25]  # density of what leaves the warm plate at 0 and the cold one at 1
    before = 0.0
    while abs(heat.mean() - before) > 1e-9:
        before = heat.mean()
        flights = []
        for side, sign in ((0, 1), (1, -1)):
            n, warmth, q = (one[::sign, None] for one in (density, temperature, heat))
            normal = n + warmth * (c * c - 0.5) + 4 / 15 * q * sign * c * (c * c - 1.5)
            along = warmth + 4 / 15 * q * sign * c
            h, g = np.empty_like(normal), np.empty_like(along)
            h[0], g[0] = wall[side] + 0.5 * sign * (c * c - 0.5), 0.5 * sign
            for i in range(1, n_places):
                h[i] = kept * h[i - 1] + far * normal[i - 1] + near * normal[i]
                g[i] = kept * g[i - 1] + far * along[i - 1] + near * along[i]
            flights.append((h[::sign], g[::sign]))
        (h, g), (h_back, g_back) = flights
        root = np.sqrt(np.pi)
        wall = [2 * root * (weight * c * h_back[0]).sum() - 0.25, 2 * root * (weight * c * h[-1]).sum() + 0.25]
        density = (weight * (h + h_back)).sum(1)
        temperature = 2 / 3 * (weight * ((c * c - 0.5) * (h + h_back) + g + g_back)).sum(1)
        heat = (weight * c * ((c * c - 1.5) * (h - h_back) + g - g_back)).sum(1)
    return heat.mean() * np.sqrt(np.pi)
