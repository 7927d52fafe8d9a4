"""Mathematics: derive everything from a functional's density, classify it, and check the paper against it.

`coordinates` names the symbols; `discrete` derives a corner's energy, gradient and Hessians, `continuous` the
Euler–Lagrange equations; `reduction` and `definiteness` decide what they are worth; `classify` says what kind of
functional it is; `verify` compares the printed equations of the paper; `report` writes it all down.
"""

from .classify import Classification as Classification
from .classify import classify as classify
from .continuous import EulerLagrange as EulerLagrange
from .continuous import euler_lagrange as euler_lagrange
from .coordinates import Variant as Variant
from .definiteness import Definiteness as Definiteness
from .discrete import CornerModel as CornerModel
from .discrete import corner_model as corner_model
from .discrete import has_barrier as has_barrier
from .ellipticity import Ellipticity as Ellipticity
from .equidistribution import Equidistribution as Equidistribution
from .equidistribution import equidistribution as equidistribution
from .reduction import Reduction as Reduction
from .report import derive_latex as derive_latex
from .report import derive_text as derive_text
from .verify import Verdict as Verdict
from .verify import verify as verify
