"""Pages that derive themselves: one for each functional, for the paper, for the command line, written when asked.

Nothing imports this package but the command line and the site's `docs/conf.py`. Every page is Markdown made from
derived data and a template in `templates/docs`; Sphinx turns it into HTML, for the whole site or for one page.
"""
