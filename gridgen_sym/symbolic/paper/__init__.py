"""The paper: its printed equations and claims compared with the derivation."""

from .verify import Verdict as Verdict
from .verify import verify as verify
