"""Adapting to real terrain
========================

Two rasters of elevations that come with Matplotlib: the sea floor around Vancouver Island, land taken as zero, and the
Jacksboro fault in Tennessee (US Geological Survey, public domain). A grid represents a raster bilinearly between its
nodes; the error, a root mean square in meters, is measured against every point of the raster. On a rectangle the smooth
grid is the uniform one. At sea, nodes go to the coast, the canyons and the continental slope: for the error of 65 x 65
nodes about 90 x 90 uniform ones are needed, twice as many. The land at Jacksboro is as rough on one side of the fault
as on the other: there, no density of nodes gains much, as the numbers show.
"""

import numpy as np
from matplotlib import cbook
from matplotlib.colors import LightSource
from matplotlib.figure import Figure
from scipy.ndimage import gaussian_filter

import gridgen_sym as gg


def sea_floor():
    """Return kilometers east and north, and meters of height (nx, ny)."""
    with cbook.get_sample_data("topobathy.npz") as raster:
        longitude, latitude, height = (raster[name].astype(float) for name in ("longitude", "latitude", "topo"))
    return *kilometers(longitude, latitude), np.minimum(height.T, 0)


def fault():
    """Return the same of the fault; this raster begins in the north."""
    with cbook.get_sample_data("jacksboro_fault_dem.npz") as raster:
        height, step = raster["elevation"].astype(float)[::-1].T, float(raster["dx"])
    return *kilometers(step * np.arange(len(height)), 36.45 + step * np.arange(len(height.T))), height


def kilometers(longitude, latitude):
    """Return distances from the south-west corner, the meridians drawn parallel."""
    degree = 111.32
    return (longitude - longitude[0]) * degree * np.cos(np.radians(latitude.mean())), (latitude - latitude[0]) * degree


figure = Figure(figsize=(11, 5.2), layout="constrained")
print("raster          nodes   uniform  adapted  ratio  folded")
for k, (name, read) in enumerate({"sea floor": sea_floor, "Jacksboro fault": fault}.items()):
    x, y, height = read()
    raster = gg.raster_field(x, y, height)
    # Second derivatives are needed: a spline of the raster, without the noise from one point to the next.
    smooth = gg.raster_field(x, y, gaussian_filter(height, 1), smooth=True)
    for nodes in (17, 33, 65):
        square = gg.domain("square", nodes, nodes)
        uniform = gg.Grid.from_planes(square.x * x[-1], square.y * y[-1])
        result = gg.adapt(uniform, smooth)
        before, after = (
            gg.interpolation_error(grid, raster) / np.sqrt(x[-1] * y[-1]) for grid in (uniform, result.grid)
        )
        folded = result.quality.folded_cells
        print(f"{name:<15} {nodes:>2}^2  {before:>7.1f}  {after:>7.1f}  {after / before:>5.2f}  {folded:>6}")
        assert folded == 0
        assert after < before
    axes = figure.add_subplot(1, 2, k + 1)
    shade = LightSource(azdeg=315, altdeg=45).hillshade(height.T, vert_exag=0.003, dx=x[1], dy=y[1])
    box = (0, x[-1], 0, y[-1])
    axes.imshow(
        height.T,
        origin="lower",
        extent=box,
        **({"cmap": "Blues_r", "vmin": -500} if k == 0 else {"cmap": "gist_earth"}),
    )
    axes.imshow(shade, origin="lower", extent=box, cmap="gray", alpha=0.35)
    gg.plot_grid(result.grid, ax=axes)
    axes.set_title(f"{name}: {nodes} x {nodes} nodes, {after / before:.2f} of the uniform grid's error", fontsize=9)
    axes.set(xlabel="km", ylabel="km")
    if name == "sea floor":
        assert after < 0.75 * before
figure.savefig("terrain.png", dpi=150)
