"""Find `templates/` and `generated/`, which are at the top of the repository and inside the wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).parent


def resource_folder(name: str) -> Path:
    """Return the folder `templates` or `generated`, in an installed wheel or in a checkout.

    Raises:
        FileNotFoundError: if neither place has it, with both places named.
    """
    packaged, checkout = _PACKAGE / name, _PACKAGE.parent / name
    for folder in (packaged, checkout):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(
        f"gridgen_sym's folder '{name}' is missing: looked in {packaged} and {checkout}. "
        "Reinstall the package, or run from a complete checkout."
    )


def is_checkout() -> bool:
    """Return whether the package runs from a checkout, whose files may change, and not as it was built."""
    return not (_PACKAGE / "generated").is_dir()
