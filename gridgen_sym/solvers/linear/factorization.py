"""Sparse factorizations that tell where there is none."""

from __future__ import annotations

from typing import Any

import numpy as np


def factorize(matrix: Any) -> Any | None:  # noqa: ANN401 - scipy.sparse has no types
    """Return SciPy's LU factors of a sparse matrix (CSC), which `solve`; None if it is singular or has no numbers."""
    from scipy.sparse.linalg import splu

    if not np.isfinite(matrix.data).all():
        return None
    try:
        # For matrices whose pattern is symmetric this order has half the factors of SciPy's default.
        return splu(matrix, permc_spec="MMD_AT_PLUS_A")
    except RuntimeError:
        return None
