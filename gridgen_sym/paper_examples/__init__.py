"""The numerical examples of the paper (its Section 3), run again: pictures, a table, its claims beside the numbers.

case -> the grids and what is measured of them       adaptive    -> Section 3.1
claim -> what the paper says, decided by numbers      comparisons -> Sections 3.2 to 3.5
report -> `results.md` and the text for the screen    run         -> all of it
"""

from .case import Case as Case
from .claim import Claim as Claim
from .report import Example as Example
from .run import run as run
