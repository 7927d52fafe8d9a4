"""Adapting to sharp functions
===========================

How well does a grid represent a function, bilinearly between its nodes? The L2 error is compared at equal numbers of
nodes: on the uniform grid, on the smooth grid of Winslow's functional (on the square it is the uniform one), and on the
grid that is adapted to the function. Where the uniform grid resolves the feature at all, a third of its error or less
is left. The paper's surface is kinked rather than sharp: there is less to gain, and it has even numbers of nodes, so
that no grid has its kinks on grid lines by chance.
"""

from matplotlib.figure import Figure

import gridgen_sym as gg

#: Name: formula, domain, numbers of nodes along a side, and the largest fraction of the error left from 33 x 33 on.
CASES = {
    "tanh front": ("tanh(50*(x + y - 1))", "square", (17, 33, 65, 129), 1 / 3),
    "circular shock": ("tanh(50*(sqrt(x**2 + y**2) - 0.5))", "square", (17, 33, 65), 1 / 3),
    "ring": ("tanh(50*(sqrt((x - 0.5)**2 + (y - 0.5)**2) - 0.3))", "square", (17, 33, 65), 1 / 3),
    "two scales": ("sin(pi*x)*sin(pi*y) + tanh(60*(y - 0.5 - 0.2*sin(2*pi*x)))/2", "square", (17, 33, 65), 1 / 3),
    "ring, wavy domain": ("tanh(40*(sqrt((x - 0.5)**2 + (y - 0.5)**2) - 0.25))", "wavy", (17, 33, 65), 1 / 3),
    "the paper's surface": ("5 + 200*abs(sin(2*pi*x)*sin(2*pi*y))", "square", (18, 34, 66), 0.8),
}

panels = []
print(
    f"{'function':<20} {'nodes':>9} {'uniform':>9} {'smooth':>9} {'adapted':>9} {'ratio':>6} {'steps':>5} {'folded':>6}"
)
for name, (function, domain, sizes, most) in CASES.items():
    for nodes in sizes:
        uniform = gg.domain(domain, nodes, nodes)
        smooth = gg.optimize(uniform, "winslow").grid
        result = gg.adapt(smooth, function)
        errors = [gg.interpolation_error(grid, function) for grid in (uniform, smooth, result.grid)]
        ratio = errors[2] / min(errors[:2])
        row = " ".join(f"{error:>9.2e}" for error in errors)
        size = f"{nodes} x {nodes}"
        print(f"{name:<20} {size:>9} {row} {ratio:>6.2f} {result.iterations:>5} {result.quality.folded_cells:>6}")
        assert result.quality.folded_cells == 0
        assert ratio < (most if nodes >= 33 else 1)
        if nodes in (33, 34):
            panels.append((f"{name}: {ratio:.2f} of the error", result))

figure = Figure(figsize=(9, 6.2), layout="constrained")
for k, (title, result) in enumerate(panels):
    axes = figure.add_subplot(2, 3, k + 1)
    low, high = result.values.min(), result.values.max()
    pale = {"vmin": low - (high - low) / 2, "vmax": high + (high - low) / 2}
    axes.pcolormesh(*result.grid.planes, result.values, shading="gouraud", cmap="coolwarm", **pale)
    gg.plot_grid(result.grid, ax=axes)
    axes.set_title(title, fontsize=9)
figure.savefig("functions.png", dpi=130)
