"""The gallery: the scripts of `examples/`, run in a copy of the folder, with the pictures that they write."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def gallery_settings(docs: Path) -> dict[str, Any]:
    """Copy the examples to a scratch folder, so that their files do not go into the repository, and return settings.

    Args:
        docs: folder of the site's sources; the examples stand beside it.
    """
    scratch = docs / "_build" / "examples"
    shutil.rmtree(scratch, ignore_errors=True)
    shutil.copytree(docs.parent / "examples", scratch, ignore=shutil.ignore_patterns("__pycache__", "README.md"))
    return {
        "examples_dirs": [str(scratch)],
        "gallery_dirs": ["gallery"],
        "filename_pattern": r"plot_",
        "within_subsection_order": "FileNameSortKey",
        "image_scrapers": (f"{__name__}.scrape_pictures",),
        "abort_on_example_error": True,
        "capture_repr": (),
        "download_all_examples": False,
        "write_computation_times": False,
        "show_memory": False,
        "show_signature": False,
        "min_reported_time": 3600,
        "remove_config_comments": True,
    }


def scrape_pictures(block: object, variables: Mapping[str, Any], settings: Mapping[str, Any]) -> str:
    """Move the pictures that a script has written to the gallery, and return the text that shows them."""
    from sphinx_gallery.scrapers import figure_rst

    shown = []
    for picture in sorted(Path(variables["src_file"]).parent.glob("*.png")):
        target = next(variables["image_path_iterator"])
        shutil.move(picture, target)
        shown.append(target)
    return str(figure_rst(shown, settings["src_dir"]))
