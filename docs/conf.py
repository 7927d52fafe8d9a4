"""Settings of the site: those of every page, and what the site alone has."""

import os
import sys
from pathlib import Path

# Before NumPy is loaded: for small systems, as in the gallery, the threads of BLAS wait longer than they work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

from derived_pages.gallery import gallery_settings

from gridgen_sym.documentation.settings import settings

globals().update(settings())
extensions += [  # noqa: F821 - of the settings
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "derived_pages.site",
]
exclude_patterns = ["_build", "gallery/*.ipynb", "gallery/*.py", "gallery/*.py.md5", "gallery/*.zip"]
sphinx_gallery_conf = gallery_settings(Path(__file__).parent)
# Times of computation say nothing on a page that is built anywhere.
suppress_warnings = ["config.cache"]
napoleon_use_ivar = True
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_typehints_format = "short"
