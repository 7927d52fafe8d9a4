"""Fields and targets
=====================

A density may name fields of its own: here a symmetric matrix M(x, y), the metric in which lengths are measured. The map
to the domain is harmonic in it (A. S. Dvinsky, Journal of Computational Physics 95, 1991), and grid lines gather where
M is large across them. A target says in the logical square what edges should be like, for any functional. Writes
`fields.png` and `targets.png`.
"""

import numpy as np

import gridgen_sym as gg

gg.define(
    "harmonic",
    "(M11*(x_xi**2 + x_eta**2) + 2*M12*(x_xi*y_xi + x_eta*y_eta) + M22*(y_xi**2 + y_eta**2))"
    "/(sqrt(M11*M22 - M12**2)*J)",
    fields={"M": "symmetric"},
)
start = gg.domain("wavy", 41, 41)
plain = gg.optimize(start, "winslow")

# ---- a metric that is large across the line y = 0.3 + 0.4 x ----


def across(x, y):
    """Return M11, M12 and M22 of M = I + w n n', where n is normal to the line and w large near it."""
    n = np.array((-0.4, 1.0)) / np.hypot(0.4, 1.0)
    w = 15 * np.exp(-((distance(x, y) / 0.1) ** 2))
    return 1 + w * n[0] ** 2, w * n[0] * n[1], 1 + w * n[1] ** 2


def distance(x, y):
    """Return the signed distance from the line."""
    return (y - 0.3 - 0.4 * x) / np.hypot(0.4, 1.0)


gathered = gg.optimize(start, "harmonic", fields={"M": gg.Field(across, mode="differentiated")})
near = [int((np.abs(distance(*grid.planes)) < 0.05).sum()) for grid in (plain.grid, gathered.grid)]
print(f"nodes within 0.05 of the line: {near[0]}, with the metric {near[1]}")
assert gathered.converged
assert gathered.quality.valid
assert near[1] > 1.3 * near[0]
gg.plot_grids([("winslow", plain.grid), ("harmonic in M", gathered.grid)], "fields.png")

# ---- edges along eta that grow from 0.005 at the bottom to 0.065 at the top ----

layered = gg.optimize(start, "winslow", target=gg.Target(0.03, "0.005 + 0.06*eta"))
leaning = gg.optimize(start, "winslow", target=gg.Target("0.005 + 0.06*abs(xi - 0.5)", 0.03, angle=70))


def first_cells(grid: gg.Grid) -> float:
    """Return the mean height of the cells at the bottom."""
    return float(np.hypot(*(grid.xy[:, 1] - grid.xy[:, 0]).T).mean())


print(f"cells at the bottom: {first_cells(plain.grid):.4f}, with the target {first_cells(layered.grid):.4f}")
for result in (layered, leaning):
    assert result.converged
    assert result.quality.valid
assert first_cells(layered.grid) < 0.6 * first_cells(plain.grid)
gg.plot_grids([("small at the bottom", layered.grid), ("small in the middle, 70 degrees", leaning.grid)], "targets.png")
