"""Classify: type of the equations, definiteness, bounds, invariances, equidistribution; decided, not asserted."""

from .classification import Classification as Classification
from .classification import classify as classify
from .classification import equation_words as equation_words
