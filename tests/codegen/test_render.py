"""Rendered sources: they compile without a warning, are the same bytes everywhere, and have twin templates."""

from __future__ import annotations

import dataclasses
import re
import shutil
import subprocess
from itertools import chain

import jinja2
import jinja2.meta
import pytest
from jinja2 import nodes
from support import COMMITTED, DERIVED, case_name, derived_kernel

from gridgen_sym.codegen import render as render_module
from gridgen_sym.codegen.generate import committed_variants, sources
from gridgen_sym.codegen.programs import kernel_name
from gridgen_sym.codegen.render import LANGUAGES, environment, render, template_variables
from gridgen_sym.functionals import functional
from gridgen_sym.resources import resource_folder
from gridgen_sym.runtime.load import PARTS

COMPILER = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-c")
#: Warnings on the flow of values need the optimiser; without OpenMP the same flow is only read.
MODES = {"openmp": ("-O1", "-fopenmp"), "serial": ("-fsyntax-only", "-Wno-unknown-pragmas")}
TEMPLATES = resource_folder("templates")


def compile_strictly(source, folder, *flags, compiler=COMPILER):
    command = [compiler, *STRICT, *flags, "-o", str(folder / "object.o"), str(source)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("path", sorted((resource_folder("generated") / "c").glob("*.c")), ids=lambda path: path.stem)
def test_committed_c_compiles_without_a_warning(path, mode, tmp_path):
    told = compile_strictly(path, tmp_path, *MODES[mode])
    assert told.returncode == 0, told.stderr


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("part", [None, *(macro for macro, _ in PARTS)])
@pytest.mark.parametrize("name", ["winslow", "area_winslow_regularized", "area_differentiated"])
def test_parts_compile_without_a_warning_of_either_compiler(name, part, compiler, tmp_path):
    """A part leaves much unused; Clang warns of unused inline functions, and GCC of unused static ones."""
    if not shutil.which(compiler):
        pytest.skip(f"there is no {compiler}")
    path = resource_folder("generated") / "c" / f"{name}.c"
    flags = ("-DONLY_A_PART", f"-DONLY_{part}") if part else ()
    told = compile_strictly(path, tmp_path, *MODES["serial"], *flags, compiler=compiler)
    assert told.returncode == 0, told.stderr


@pytest.mark.slow
@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize("case", DERIVED, ids=case_name)
def test_derived_c_compiles_without_a_warning(case, tmp_path):
    source = tmp_path / "kernel.c"
    source.write_text(render(derived_kernel(*case), "c").text)
    told = compile_strictly(source, tmp_path, *MODES["openmp"])
    assert told.returncode == 0, told.stderr


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
def test_the_strict_flags_object_to_a_loss_of_precision(tmp_path):
    source = tmp_path / "lossy.c"
    source.write_text("float lossy(double a);\nfloat lossy(double a) { return a; }\n")
    assert "-Werror" in compile_strictly(source, tmp_path).stderr


def test_every_committed_kernel_has_its_files():
    for language, (_, path, _) in LANGUAGES.items():
        wanted = {path.format(name=kernel_name(*case)) for case in COMMITTED}
        suffix = path.rpartition(".")[2]
        found = {f"{language}/{file.name}" for file in (resource_folder("generated") / language).glob(f"*.{suffix}")}
        assert found == wanted


# ---- the bytes ----


def test_rendering_again_gives_the_same():
    for language in LANGUAGES:
        assert render(derived_kernel("area", "frozen"), language) == render(derived_kernel("area", "frozen"), language)


def test_sources_are_plain_text_without_trailing_blanks():
    for source in sources(functional("winslow"), committed_variants(functional("winslow"))):
        assert source.text.isascii()
        assert source.text.endswith("\n")
        assert "\t" not in source.text
        assert not [line for line in source.text.splitlines() if line != line.rstrip()]


# ---- templates ----


def stems(language):
    return {path.name.partition(".")[0] for path in (TEMPLATES / language).glob("*.jinja")}


def names_from_outside(name):
    """Return the variables that a template and everything it includes or imports take from outside."""
    loader = environment().loader
    text, _, _ = loader.get_source(environment(), name)
    tree = environment().parse(text)
    needed = jinja2.meta.find_undeclared_variables(tree)
    brought = {
        alias if isinstance(alias, str) else alias[1]
        for node in tree.find_all(nodes.FromImport)
        for alias in node.names
    }
    others = [other for other in jinja2.meta.find_referenced_templates(tree) if other is not None]
    return (needed - brought).union(*(names_from_outside(other) for other in others))


def test_twin_templates_have_the_same_names():
    assert stems("c") == stems("numpy") != set()


@pytest.mark.parametrize("stem", sorted(stems("c")))
def test_twin_templates_take_variables_that_are_given(stem):
    given = set(template_variables(derived_kernel("winslow", "plain"), LANGUAGES["c"][2]()))
    for language, suffix in (("c", "c"), ("numpy", "py")):
        assert names_from_outside(f"{language}/{stem}.{suffix}.jinja") <= given


def test_twin_entry_templates_use_the_same_variables_and_all_of_them():
    given = set(template_variables(derived_kernel("winslow", "plain"), LANGUAGES["c"][2]()))
    for entry, _, _ in LANGUAGES.values():
        assert names_from_outside(entry) == given


def test_every_template_is_used():
    reached = set()
    folders = (TEMPLATES.parent / "gridgen_sym", TEMPLATES.parent / "docs" / "_ext")
    code = [path.read_text(encoding="utf-8") for folder in folders for path in folder.rglob("*.py")]
    pages = {f"docs/{name}" for text in code for name in re.findall(r'"(\w+\.(?:md|html)\.jinja)"', text)}
    waiting = [*(entry for entry, _, _ in LANGUAGES.values()), *pages]
    while waiting:
        name = waiting.pop()
        reached.add(name)
        text, _, _ = environment().loader.get_source(environment(), name)
        waiting += set(jinja2.meta.find_referenced_templates(environment().parse(text))) - reached
    assert reached == {path.relative_to(TEMPLATES).as_posix() for path in TEMPLATES.rglob("*.jinja")}


def test_templates_hold_no_algebra():
    """A name of the metric in a template would be a formula that nothing has derived."""
    for path in chain(TEMPLATES.glob("c/*"), TEMPLATES.glob("numpy/*")):
        words = path.read_text().replace("(", " ").replace("*", " ").split()
        assert not {"g11", "g22", "g12", "J", "chi"} & set(words), path


def test_a_variable_that_is_not_given_is_an_error():
    with pytest.raises(jinja2.UndefinedError, match="nothing_of_this_name"):
        environment().from_string("{{ nothing_of_this_name }}").render()


@pytest.mark.parametrize("entry", [entry for entry, _, _ in LANGUAGES.values()])
@pytest.mark.parametrize("missing", ["kernel", "programs", "weight_planes", "version"])
def test_a_template_without_one_of_its_variables_is_an_error(entry, missing):
    variables = template_variables(derived_kernel("area", "frozen"), LANGUAGES[entry.partition("/")[0]][2]())
    del variables[missing]
    with pytest.raises(jinja2.UndefinedError, match=missing):
        environment().get_template(entry).render(variables)


def test_a_kernel_is_immutable():
    with pytest.raises(dataclasses.FrozenInstanceError):
        derived_kernel("area", "plain").name = "other"


def test_render_is_the_only_module_that_opens_templates():
    users = [
        path.name
        for path in sorted(resource_folder("templates").parent.joinpath("gridgen_sym").rglob("*.py"))
        if 'resource_folder("templates")' in path.read_text(encoding="utf-8")
    ]
    assert "render.py" in users
    # The cache key of kernels derived at run time covers the templates' bytes; the settings name the folder of styles.
    assert set(users) <= {"render.py", "sources.py", "settings.py"}
    assert render_module.environment().undefined is jinja2.StrictUndefined
