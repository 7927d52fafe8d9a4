"""Sections of the NACA four- and five-digit families, from their numbers.

Sources: E. N. Jacobs, K. E. Ward and R. M. Pinkerton, NACA Report 460 (1933), for four digits; E. N. Jacobs and R. M.
Pinkerton, NACA Report 537 (1935), for five digits, whose constants are those of I. H. Abbott and A. E. von Doenhoff,
Theory of Wing Sections (1959), section 6.
"""

from __future__ import annotations

import re

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted

#: Coefficients of sqrt(x), x, x^2, x^3 and x^4 in half the thickness over 5 times the greatest one; with the last one
#: as published the trailing edge is 0.25 % thick for a section of 12 %, and with the other one it is sharp.
_THICKNESS = (0.2969, -0.1260, -0.3516, 0.2843)
_BLUNT, _SHARP = -0.1015, -0.1036
#: Second and third digit of five: the constants m and k1 of the camber line.
_CAMBER = {
    10: (0.0580, 361.4),
    20: (0.1260, 51.64),
    30: (0.2025, 15.957),
    40: (0.2900, 6.643),
    50: (0.3910, 3.230),
}
_DESIGN_LIFT = 0.3  # That of the published k1.


def naca_points(name: str, *, blunt: bool = False, count: int = 200) -> Array:
    """Return points (2 count + 1, 2) on a section of chord 1, from the lower side of the trailing edge to the upper.

    Args:
        name: such as `naca2412`, `NACA 23012` or `0012`.
        blunt: whether the trailing edge has its published thickness; else it is sharp.
        count: intervals on each of both sides, which are short at both ends.

    Raises:
        GridgenError: for a number that is none of both families.
    """
    found = re.fullmatch(r"(?:naca)?[ -]?(\d{4,5})", name.strip(), re.IGNORECASE)
    if not found:
        raise GridgenError(
            f"a NACA section has four or five digits, such as naca2412 or naca23012; came {quoted(name)}"
        )
    digits = found[1]
    thickness = int(digits[-2:]) / 100
    if thickness == 0:
        raise GridgenError(f"the last two digits of a NACA section are its thickness in percent; came {quoted(name)}")
    x = (1 - np.cos(np.linspace(0, np.pi, count + 1))) / 2
    last = _BLUNT if blunt else _SHARP
    half = 5 * thickness * (_THICKNESS[0] * np.sqrt(x) + np.polyval((last, *_THICKNESS[:0:-1], 0.0), x))
    line, slope = _four_digits(digits, x) if len(digits) == 4 else _five_digits(digits, x)
    sine, cosine = slope / np.hypot(1, slope), 1 / np.hypot(1, slope)
    upper = np.stack((x - half * sine, line + half * cosine), axis=-1)
    lower = np.stack((x + half * sine, line - half * cosine), axis=-1)
    return np.concatenate((lower[::-1], upper[1:]))


def _four_digits(digits: str, x: Array) -> tuple[Array, Array]:
    """Return the camber line and its slope: two parabolas that meet at the greatest camber."""
    camber, place = int(digits[0]) / 100, int(digits[1]) / 10
    if camber == 0:
        return np.zeros_like(x), np.zeros_like(x)
    if place == 0:
        raise GridgenError(f"NACA {digits} has camber at the leading edge: its second digit must be 1 to 9")
    ahead = x < place
    scale = np.where(ahead, camber / place**2, camber / (1 - place) ** 2)
    line = scale * np.where(ahead, 2 * place * x - x**2, 1 - 2 * place + 2 * place * x - x**2)
    return line, 2 * scale * (place - x)


def _five_digits(digits: str, x: Array) -> tuple[Array, Array]:
    """Return the camber line and its slope: a cubic and a straight line, without reflex."""
    if digits[0] == "0" or int(digits[1:3]) not in _CAMBER:
        known = ", ".join(f"2{key}" for key in _CAMBER)
        raise GridgenError(f"NACA {digits} has no known camber line: a section of five digits begins with {known}")
    m, k = _CAMBER[int(digits[1:3])]
    k *= 0.15 * int(digits[0]) / _DESIGN_LIFT / 6
    ahead = x < m
    line = np.where(ahead, k * (x**3 - 3 * m * x**2 + m**2 * (3 - m) * x), k * m**3 * (1 - x))
    return line, np.where(ahead, k * (3 * x**2 - 6 * m * x + m**2 * (3 - m)), -k * m**3)
