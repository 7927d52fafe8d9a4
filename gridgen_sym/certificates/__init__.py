"""Certificates: proofs, in exact arithmetic, that no valid grid has given boundary nodes."""

from .certificate import Certificate as Certificate
from .proofs import certificates as certificates
from .proofs import sliver_certificate as sliver_certificate
