"""Settings of the site: those of every page, and what the site alone has."""

from gridgen_sym.documentation.settings import settings

globals().update(settings())
extensions += ["gridgen_sym.documentation.site"]  # noqa: F821 - of the settings
exclude_patterns = ["_build"]
