"""The same minimum by other programs: one thread, the same start and functional, the same energy gap.

Every solver runs in a process of its own, with a time limit, after a run on a small grid that compiles and loads what
it needs. Its clock stops while the energy is compared with the best one known.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from measure import FOLDER, Series, Table, plot, start_grid

import gridgen_sym as gg

#: Relative distance to the best energy at which a solver's clock is read.
GAP = 1e-12
PEERS = {
    "gridgen_sym": "`gridgen_sym.optimize`, Newton with multigrid",
    "numba_superlu": "Newton, sparse direct (SciPy's SuperLU), kernels by hand in Numba",
    "mfem_tmop": "PyMFEM's TMOP, tuned",
    "newton_cg": "SciPy's Newton-CG on the generated energy, gradient and Hessian",
    "l_bfgs_b": "SciPy's L-BFGS-B on the generated energy and gradient",
}
_LABELS = {
    "gridgen_sym": "gridgen_sym",
    "numba_superlu": "Numba + SuperLU",
    "mfem_tmop": "PyMFEM TMOP",
    "newton_cg": "SciPy Newton-CG",
    "l_bfgs_b": "SciPy L-BFGS-B",
}
_WARM = 9
_HEADER = ("solver", "nodes", "cpu seconds", "wall seconds", "times slower", "gap reached", "outcome")


def best_energy(size: int) -> float:
    """Return the lowest energy found of the Winslow grid of `wavy`: a sum over the index, as in all peers."""
    start = start_grid("wavy", size)
    return gg.optimize(start, "winslow", tolerance=1e-12, spacing="index", progress=False).energy


def worker(peer: str, size: int, best: float) -> None:
    """Run one solver in this process and print what it did, as JSON."""
    from peer_clock import Clock
    from peer_solvers import solve

    solve(peer, start_grid("wavy", _WARM), Clock(-np.inf))
    clock = Clock(best * (1 + GAP))
    message = solve(peer, start_grid("wavy", size), clock)
    print(json.dumps({**clock.told(best), "message": message}))


def race(peer: str, size: int, best: float, limit: float) -> dict[str, object]:
    """Run one solver in a process with one thread; return what it tells, or why it told nothing."""
    single = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    command = [sys.executable, str(FOLDER / "peers.py"), "--peer", peer, "--size", str(size), "--best", repr(best)]
    try:
        told = subprocess.run(
            command, capture_output=True, text=True, timeout=limit, env={**os.environ, **single}, check=False
        )
    except subprocess.TimeoutExpired:
        return {"message": f"not within {limit:.0f} s"}
    if told.returncode != 0:
        return {"message": (told.stderr.strip().splitlines() or ["failed"])[-1]}
    answer: dict[str, object] = json.loads(told.stdout.strip().splitlines()[-1])
    return answer


def run(quick: bool, picture: Path | None = None) -> list[Table]:
    """Race all solvers; one that does not finish a size in time is not tried on larger ones."""
    table = Table("The same energy by other programs", _TEXT, _HEADER)
    limits = {64: 30.0, 128: 40.0, 256: 60.0} if quick else {64: 60.0, 128: 120.0, 256: 200.0}
    left, series = dict(PEERS), {}
    own = 0.0
    for size, limit in limits.items():
        best = best_energy(size)
        for peer, name in list(left.items()):
            told = min((race(peer, size, best, limit) for _ in range(3 if peer == "gridgen_sym" else 1)), key=_seconds)
            if "cpu" not in told:
                table.add(name, f"{size}²", "", "", "", f"{told['gap']:.0e}" if "gap" in told else "", told["message"])
                del left[peer]
                continue
            seconds = _seconds(told)
            own = seconds if peer == "gridgen_sym" else own
            table.add(name, f"{size}²", seconds, told["wall"], seconds / own, f"{told['gap']:.0e}", "reached")
            x, y = series.setdefault(_LABELS[peer], ([], []))
            x.append(size * size)
            y.append(seconds)
    if picture:
        panel: Series = series
        plot(picture, [(f"winslow on wavy, relative energy gap {GAP:.0e}", panel)], "nodes", "cpu seconds, one thread")
    return [table]


def _seconds(told: dict[str, object]) -> float:
    return float(str(told.get("cpu", np.inf)))


_TEXT = (
    "Winslow's functional on `wavy`, from the same transfinite grid, one thread each: processor seconds until the "
    "relative energy gap to the best grid known is 1e-12. Compilation and imports are not counted. TMOP has shape "
    "metric 2 with ideal targets of unit size and Gauss–Lobatto points at the corners, which is the same sum; partial "
    "assembly, MINRES with Jacobi, adaptive tolerance. A solver that misses the gap is not tried on larger grids."
)

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="shorter time limits")
    parser.add_argument("--peer", choices=PEERS, help="run one solver in this process")
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--best", type=float, help="the best energy known")
    options = parser.parse_args()
    if options.peer:
        worker(options.peer, options.size, options.best or best_energy(options.size))
    else:
        for result in run(options.quick):
            print(result.markdown())
