"""Your own functional
===================

One formula, and every solver has it at once.

The density is a function of the metric: g11 and g22 are the squared lengths of a cell's edges, g12 is their inner
product, J the cell's area. Arguments after the metric are parameters.
"""

import gridgen_sym as gg


def smooth(m, k=0.1):
    """Winslow's smoothness with a little orthogonality."""
    return (m.g11 + m.g22) / m.J + k * m.g12**2 / m.J**2


gg.define("smooth", smooth)

start = gg.domain("swan", 21, 21)
newton = gg.optimize(start, "smooth", parameters={"k": 0.5})
local = gg.optimize(start, "smooth", "local", parameters={"k": 0.5}, tolerance=1e-8)

assert newton.converged
assert newton.quality.valid
# Both methods minimize the same energy.
assert abs(local.energy / newton.energy - 1) < 1e-8
print(newton.quality)
gg.plot_grids([("the start", start), ("smooth", newton.grid)], "smooth.png")
