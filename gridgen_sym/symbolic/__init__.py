"""Mathematics: derive everything from a functional's density, classify it, and check the paper against it.

`coordinates` names the symbols, and `definiteness` decides the signs of expressions. `derive` has the discrete and
the continuous side, `classify` says what kind of functional it is, `report` writes it all down, and `paper` compares
the printed equations of the paper. Each imports only what stands before it in this list.
"""

from .classify import Classification as Classification
from .classify import classify as classify
from .classify import equation_words as equation_words
from .classify.ellipticity import Ellipticity as Ellipticity
from .classify.equidistribution import EquidistributionLaw as EquidistributionLaw
from .classify.equidistribution import equidistribution as equidistribution
from .coordinates import Variant as Variant
from .definiteness import Definiteness as Definiteness
from .derive.continuous import EulerLagrange as EulerLagrange
from .derive.continuous import euler_lagrange as euler_lagrange
from .derive.discrete import CornerModel as CornerModel
from .derive.discrete import corner_model as corner_model
from .derive.discrete import has_barrier as has_barrier
from .derive.reduction import Reduction as Reduction
from .paper import Verdict as Verdict
from .paper import verify as verify
from .report import derive_latex as derive_latex
from .report import derive_text as derive_text


def __getattr__(name: str) -> type[EquidistributionLaw]:
    """Return the law of equidistribution by its old name, which the measurement in `adaptation` has as well."""
    if name != "Equidistribution":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import warnings

    text = "symbolic.Equidistribution is deprecated: the class is called EquidistributionLaw"
    warnings.warn(text, DeprecationWarning, stacklevel=2)
    return EquidistributionLaw
