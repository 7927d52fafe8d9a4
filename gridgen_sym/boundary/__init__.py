"""Boundaries: outlines and classical domains, curves, corners, the sampling of sides, and exact predicates."""

from .corners import CornerChoice as CornerChoice
from .domains import domain as domain
from .domains import domain_description as domain_description
from .domains import domain_names as domain_names
from .outline import Outline as Outline
from .wall import Wall as Wall
from .wall import first_height as first_height
