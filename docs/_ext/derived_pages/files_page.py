"""The tables of the formats of grids and of outlines in `docs/reference/files.md`, written from their registries.

`python docs/_ext/derived_pages/files_page.py` writes it anew; building the site does so, too.
"""

from __future__ import annotations

from pathlib import Path

from gridgen_sym.documentation.functional_page import write_if_changed
from gridgen_sym.io import known_formats
from gridgen_sym.io.format import Format
from gridgen_sym.outlines import outline_formats

#: What stands around the table.
_BEGIN, _END = "<!-- The table of formats: written by docs/_ext/derived_pages/files_page.py. -->", "<!-- End. -->"
_BEGIN_OUTLINES = "<!-- The table of outlines: written by docs/_ext/derived_pages/files_page.py. -->"
_HEAD = ("suffix", "format", "written", "read", "blocks", "names", "needs", "shown by")


def table_of_formats() -> str:
    """Return the table in Markdown: a row for each format, then the words that select a variant."""
    rows = [_HEAD, ("---",) * len(_HEAD), *map(_row, known_formats().values())]
    text = _lines(rows)
    forms = [
        (f"`{word}`", form.name, meaning) for form in known_formats().values() for word, meaning in form.forms.items()
    ]
    if forms:
        text += "\n" + _lines([("form", "of", "what it selects"), ("---",) * 3, *forms])
    return text


def _row(form: Format) -> tuple[str, ...]:
    """Return what the table says of a format."""
    reads = ", ".join(filter(None, (form.dimensions, form.reads))) if form.decode else "no"
    return (
        " ".join(f"`{suffix}`" for suffix in form.suffixes),
        form.name,
        (form.writes or "yes") if form.encode else "no",
        reads,
        "several" if form.several else "one",
        "in the file" if form.names else "`.nmf`",
        f"{form.extra[1]} (extra `{form.extra[0]}`)" if form.extra else "",
        f"`{form.test}`",
    )


def table_of_outlines() -> str:
    """Return the table of the files of outlines in Markdown."""
    rows: list[tuple[str, ...]] = [("suffix", "format", "read", "needs", "shown by"), ("---",) * 5]
    for form in outline_formats().values():
        needs = f"{form.package} (extra `geo`)" if form.package else ""
        rows.append(
            (" ".join(f"`{one}`" for one in form.suffixes), form.name, form.description, needs, f"`{form.test}`")
        )
    return _lines(rows)


def _lines(rows: list[tuple[str, ...]]) -> str:
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |\n" for row in rows)


def with_table(page: str) -> str:
    """Return the text of the page with the present tables."""
    for mark, table in ((_BEGIN, table_of_formats()), (_BEGIN_OUTLINES, table_of_outlines())):
        before, begin, rest = page.partition(mark)
        _, end, after = rest.partition(_END)
        if not (begin and end):
            raise ValueError(f"the page of files has no lines '{mark}' and '{_END}'")
        page = f"{before}{begin}\n\n{table}\n{end}{after}"
    return page


def write_files_page(folder: Path) -> None:
    """Write the table into the page in a folder."""
    page = folder / "files.md"
    write_if_changed(page, with_table(page.read_text(encoding="utf-8")))


if __name__ == "__main__":
    write_files_page(Path(__file__).parents[2] / "reference")
