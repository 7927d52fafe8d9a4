"""Grids on the ground: coordinates, boundaries, classical domains, quality, files, pictures."""

from __future__ import annotations

from .certificate import Certificate as Certificate
from .corners import CornerChoice as CornerChoice
from .domains import domain as domain
from .domains import domain_description as domain_description
from .domains import domain_names as domain_names
from .files import known_suffixes as known_suffixes
from .files import read as read
from .files import write as write
from .grid import Grid as Grid
from .grid import corner_jacobians as corner_jacobians
from .outline import Outline as Outline
from .plot import plot_grid as plot_grid
from .plot import plot_grids as plot_grids
from .plot_certificate import plot_certificates as plot_certificates
from .proofs import certificates as certificates
from .proofs import sliver_certificate as sliver_certificate
from .quality import Quality as Quality
from .quality import quality as quality
from .transfinite import transfinite as transfinite
