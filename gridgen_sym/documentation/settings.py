"""What the site and a page on its own have in common: Sphinx's settings, with mathematics that need no network."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..resources import resource_folder
from ..version import __version__


def static_folder() -> Path:
    """Return the folder of style sheets and of MathJax."""
    return resource_folder("templates") / "docs" / "static"


def settings() -> dict[str, Any]:
    """Return the settings as the names of a `conf.py`."""
    return {
        "project": "gridgen_sym",
        "author": "The gridgen_sym developers",
        "copyright": "the gridgen_sym developers, MIT license",
        "release": __version__,
        "extensions": ["myst_parser", "sphinx.ext.mathjax", "sphinx_copybutton"],
        "myst_enable_extensions": ["dollarmath", "deflist", "colon_fence", "attrs_inline"],
        "myst_heading_anchors": 3,
        "html_theme": "furo",
        "html_title": "gridgen_sym",
        "html_static_path": [str(static_folder())],
        "html_css_files": ["gridgen.css"],
        "html_favicon": str(static_folder() / "favicon.svg"),
        "html_copy_source": False,
        "html_show_sourcelink": False,
        "html_show_sphinx": False,
        "mathjax_path": "mathjax/startup.js",
        "mathjax4_config": {
            "loader": {"load": ["input/tex", "output/chtml"]},
            # Both are found beside startup.js, so that a page opens from a disk without a network.
            "output": {"fontPath": "[mathjax]/font", "displayOverflow": "linebreak"},
            "tex": {"macros": {"Bbbk": r"\mathbb{k}"}},
        },
        "pygments_style": "tango",
        "copybutton_prompt_text": "$ ",
    }
