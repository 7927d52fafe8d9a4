"""A clock that stands still while the energy is looked at, and remembers when it was low enough."""

from __future__ import annotations

import time


class Clock:
    """Measures wall and processor time until an energy is reached."""

    def __init__(self, target: float) -> None:
        """Set the energy to reach; the clock stands until `start`."""
        self._target = target
        self._wall = self._cpu = 0.0
        self._begin: tuple[float, float] | None = None
        self._reached: tuple[float, float] | None = None
        self._lowest = float("inf")

    def start(self) -> None:
        """Run from now on."""
        self._begin = time.perf_counter(), time.process_time()

    def stop(self) -> None:
        """Stand still."""
        assert self._begin is not None
        self._wall += time.perf_counter() - self._begin[0]
        self._cpu += time.process_time() - self._begin[1]
        self._begin = None

    def look(self, energy: float) -> bool:
        """Take the present energy; return whether it is low enough. The clock must stand."""
        self._lowest = min(self._lowest, energy)
        if self._reached is None and energy <= self._target:
            self._reached = self._wall, self._cpu
        return self._reached is not None

    def told(self, best: float) -> dict[str, float]:
        """Return the gap, and the seconds if the energy was reached."""
        found = {"gap": self._lowest / best - 1.0}
        if self._reached is not None:
            found["wall"], found["cpu"] = self._reached
        return found
