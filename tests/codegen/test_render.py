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
from support import BUILTIN as FUNCTIONALS
from support import COMMITTED, DERIVED, case_name, derived_kernel, rendered

from gridgen_sym.backends.c.loader import PARTS
from gridgen_sym.backends.c.printer import CPrinter
from gridgen_sym.backends.numpy.printer import NumpyPrinter
from gridgen_sym.codegen import render as render_module
from gridgen_sym.codegen.backend import BUILTIN, find_backend
from gridgen_sym.codegen.facts import KernelFacts, kernel_name
from gridgen_sym.codegen.generate import SHARED, committed_variants, sources
from gridgen_sym.codegen.render import environment, template_variables
from gridgen_sym.functionals import functional
from gridgen_sym.resources import resource_folder

#: Templates that are filled once for each kernel, with the printers, and once for all.
KERNEL_TEMPLATES = {"c/kernel.c.jinja": CPrinter, "numpy/kernel.py.jinja": NumpyPrinter}
#: Templates of what programs of users include or import, filled once for each kernel, without the printers.
INTERFACES = ("c/interface.h.jinja", "numpy/interface.py.jinja")
SHARED_TEMPLATES = tuple(f"{path}.jinja" for path in SHARED)
COMPILER = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)] or [COMPILER]
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-c")
HEADERS = resource_folder("generated") / "c"
#: Warnings on the flow of values need the optimizer; without OpenMP the same flow is only read.
MODES = {"openmp": ("-O1", "-fopenmp"), "serial": ("-fsyntax-only", "-Wno-unknown-pragmas")}
TEMPLATES = resource_folder("templates")


def compile_strictly(source, folder, *flags, compiler=COMPILER):
    command = [compiler, *STRICT, *flags, f"-I{HEADERS}", "-o", str(folder / "object.o"), str(source)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize("name", [*FUNCTIONALS, "area_winslow_differentiated", "winslow_target_regularized"])
def test_committed_c_compiles_without_a_warning(name, tmp_path):
    path = HEADERS / f"{name}.c"
    told = compile_strictly(path, tmp_path, *MODES["openmp"])
    assert told.returncode == 0, told.stderr


@pytest.mark.slow
@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("path", sorted(HEADERS.glob("*.c")), ids=lambda path: path.stem)
def test_every_compiler_reads_committed_c_without_a_warning(path, compiler, tmp_path):
    told = compile_strictly(path, tmp_path, *MODES["serial"], compiler=compiler)
    assert told.returncode == 0, told.stderr


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("part", [None, *(macro for macro, _ in PARTS if macro != "MIXED")])  # Not committed.
@pytest.mark.parametrize("name", ["winslow", "area_winslow_regularized", "area_differentiated"])
def test_parts_compile_without_a_warning_of_either_compiler(name, part, compiler, tmp_path):
    """A part leaves much unused; Clang warns of unused inline functions, and GCC of unused static ones."""
    if not shutil.which(compiler):
        pytest.skip(f"there is no {compiler}")
    path = resource_folder("generated") / "c" / f"{name}.c"
    flags = (f"-DPARTS=PART_{part}",) if part else ()
    told = compile_strictly(path, tmp_path, *MODES["serial"], *flags, compiler=compiler)
    assert told.returncode == 0, told.stderr


@pytest.mark.slow
@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
@pytest.mark.parametrize(
    "case", [*DERIVED, ("winslow", "target+mixed"), ("area", "differentiated+mixed")], ids=case_name
)
def test_derived_c_compiles_without_a_warning(case, tmp_path):
    source = tmp_path / "kernel.c"
    source.write_text(rendered(*case, "c"))
    told = compile_strictly(source, tmp_path, *MODES["openmp"])
    assert told.returncode == 0, told.stderr


@pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
def test_the_strict_flags_object_to_a_loss_of_precision(tmp_path):
    source = tmp_path / "lossy.c"
    source.write_text("float lossy(double a);\nfloat lossy(double a) { return a; }\n")
    assert "-Werror" in compile_strictly(source, tmp_path).stderr


def test_every_committed_kernel_has_its_files():
    suffixes = {name: find_backend(name).suffix for name in BUILTIN} | {"facts": ".json"}
    for folder, suffix in suffixes.items():
        found = {path.relative_to(HEADERS.parent).as_posix() for path in (HEADERS.parent / folder).glob(f"*{suffix}")}
        assert found - set(SHARED) == {f"{folder}/{kernel_name(*case)}{suffix}" for case in COMMITTED}


@pytest.mark.parametrize("case", [("winslow", "plain"), ("area", "frozen"), ("knupp", "plain")], ids=case_name)
def test_facts_come_back_from_their_text(case):
    facts = derived_kernel(*case).facts
    assert KernelFacts.from_json(facts.to_json()) == facts
    assert facts.name == kernel_name(*case)
    assert ("semidefinite_hessian_vector" in facts.functions) is facts.polyconvex
    assert facts.parameters == tuple(functional(case[0]).parameters)


# ---- the bytes ----


def test_rendering_again_gives_the_same():
    for name in BUILTIN:
        assert rendered("area", "frozen", name) == rendered("area", "frozen", name)


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
    given = set(template_variables(derived_kernel("winslow", "plain"), CPrinter()))
    for folder in ("c", "numpy"):
        (template,) = (TEMPLATES / folder).glob(f"{stem}.*")
        assert names_from_outside(f"{folder}/{template.name}") <= given


def test_twin_templates_of_a_kernel_use_the_same_variables_and_all_of_them():
    given = set(template_variables(derived_kernel("winslow", "plain"), CPrinter()))
    for entry in KERNEL_TEMPLATES:
        assert names_from_outside(entry) == given


def test_shared_templates_know_of_no_kernel():
    for entry in SHARED_TEMPLATES:
        assert names_from_outside(entry) == {"version"}


def test_interfaces_are_made_of_facts_alone():
    for entry in INTERFACES:
        assert names_from_outside(entry) <= {"facts", "version"}


def test_every_template_is_used():
    reached = set()
    folders = (TEMPLATES.parent / "gridgen_sym", TEMPLATES.parent / "docs" / "_ext")
    code = [path.read_text(encoding="utf-8") for folder in folders for path in folder.rglob("*.py")]
    pages = {f"docs/{name}" for text in code for name in re.findall(r'"(\w+\.(?:md|html)\.jinja)"', text)}
    waiting = [*KERNEL_TEMPLATES, *INTERFACES, *SHARED_TEMPLATES, *pages]
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


@pytest.mark.parametrize("entry", KERNEL_TEMPLATES)
@pytest.mark.parametrize("missing", ["facts", "programs", "version"])
def test_a_template_without_one_of_its_variables_is_an_error(entry, missing):
    variables = template_variables(derived_kernel("area", "frozen"), KERNEL_TEMPLATES[entry]())
    del variables[missing]
    with pytest.raises(jinja2.UndefinedError, match=missing):
        environment().get_template(entry).render(variables)


def test_a_kernel_is_immutable():
    with pytest.raises(dataclasses.FrozenInstanceError):
        derived_kernel("area", "plain").facts.name = "other"


def test_render_is_the_only_module_that_opens_templates():
    users = [
        path.name
        for path in sorted(resource_folder("templates").parent.joinpath("gridgen_sym").rglob("*.py"))
        if 'resource_folder("templates")' in path.read_text(encoding="utf-8")
    ]
    assert "render.py" in users
    # The key of what is derived covers the templates' bytes; the settings name the folder of styles; a page that shows
    # a grid is put together of files that are no templates of Jinja's.
    assert set(users) <= {"render.py", "kept_texts.py", "settings.py", "view.py"}
    assert render_module.environment().undefined is jinja2.StrictUndefined
