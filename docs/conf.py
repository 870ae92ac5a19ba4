"""The documentation as a site, which is built without the network."""

import ast
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any, get_args

from docutils import nodes
from numpydoc.xref import DEFAULT_LINKS
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.ext import autosummary
from sphinx.pycode import ModuleAnalyzer

from analysis.problem.quantities import QUANTITIES, Quantity
from validation.parser.commands import Command, commands

ROOT = Path(__file__).parent.parent

project = "tippedisk"
version = release = version_of(project)
extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx-mathjax-offline",  # MathJax beside the pages
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
]
exclude_patterns = ["_templates"]
templates_path = ["_templates"]
html_theme = "furo"
html_title = "The tippedisk"
html_show_sourcelink = html_show_copyright = False

# Links of the pages must lead somewhere. Docstrings set code in single backticks, which is a link
# where it is a public name.
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]
default_role = "py:obj"
smartquotes = False

autodoc_typehints = "none"  # docstrings say more
autodoc_member_order = "bysource"
maximum_signature_line_length = 99
autodoc_default_options = {
    "members": True,
    "inherited-members": "object, BaseException",
    "no-value": True,
}
numpydoc_show_class_members = False
autosummary.WELL_KNOWN_ABBREVIATIONS += ("Eq.", "Eqs.", "Sect.")  # end no sentence

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "off"

BESIDE = {
    "README.md": "index",
    "CONTRIBUTING.md": "project/contributing",
    "CHANGELOG.md": "project/changelog",
    "CITATION.cff": "project/citing",
}
"""Pages by the files beside `docs/` that they include."""


def setup(app: Sphinx) -> None:
    """Tell Sphinx what this site has of its own."""
    app.connect("source-read", _with_lists)
    app.connect("doctree-read", _lead_inside)
    app.connect("autodoc-process-signature", _without_signature, priority=1)
    app.connect("autodoc-process-docstring", _describe_constant, priority=1)


def _lead_inside(_: Sphinx, page: nodes.document) -> None:
    """Let links to files beside `docs/` lead to the pages that include them."""
    for link in page.findall(addnodes.pending_xref):
        name = Path(link["reftarget"]).name
        target = BESIDE.get(name) or BESIDE.get(f"{name}.md")
        if target and link["reftype"] == "myst":
            link["refdomain"], link["reftarget"], link["reftargetid"] = "doc", target, None


# --- Quantities and commands --------------------------------------------------------------------


def _with_lists(_: Sphinx, page: str, source: list[str]) -> None:
    """Add to their pages the quantities as they are declared, and the commands as they parse."""
    if page == "scenario":
        columns = ("key", "option", "unit", "default", "meaning (what is allowed)")
        source[0] += f"\n{_table(columns, map(_described, QUANTITIES.values()))}\n"
    if page == "commands":
        source[0] += "".join(map(_section, commands()))


def _table(columns: Sequence[str], rows: Iterable[Iterable[str]]) -> str:
    ruled = (columns, ["---"] * len(columns), *rows)
    return "\n".join(f"| {' | '.join(row)} |" for row in ruled)


def _described(quantity: Quantity) -> tuple[str, ...]:
    allowed = f" ({quantity.allowed})" if quantity.allowed else ""
    told = (quantity.unit, quantity.shown_default, f"{quantity.meaning}{allowed}")
    return f"`{quantity.key}`", f"`{quantity.flag}`", *told


def _section(command: Command) -> str:
    parser = command.parser()
    about = (
        f"```text\n{each}\n```" if "\n  " in f"\n{each}" else each
        for each in (parser.description or "").split("\n\n")
    )
    rows = [
        (_called(each), _meaning(each))
        for each in parser.actions
        if each.dest not in QUANTITIES and each.dest != "help"
    ]
    text = [f"## {command.name}", *about, f"```text\n{parser.usage}\n```"]
    text.append(_table(("option", "meaning"), rows))
    known = [QUANTITIES[each.dest] for each in parser.actions if each.dest in QUANTITIES]
    if tables := dict.fromkeys(each.table for each in known):
        named = ", ".join(f"`{each}`" if each else "those before the tables" for each in tables)
        text.append(f"Also those of [the scenario](scenario.md): {named}.")
    return "\n\n" + "\n\n".join(text) + "\n"


def _called(action: Any) -> str:
    value = "" if action.nargs == 0 or action.choices else f" {action.metavar}"
    return ", ".join(f"`{name}{value}`" for name in action.option_strings) or f"`{action.metavar}`"


def _meaning(action: Any) -> str:
    text = (action.help or "").replace("%%", "%").replace("|", "\\|")
    choices = [str(each) for each in action.choices or ()]
    return text if all(each in text for each in choices) else f"{text}: {', '.join(choices)}"


# --- Constants ----------------------------------------------------------------------------------


def _homes() -> Iterator[tuple[str, str]]:
    """Public names of the packages, and modules that they are imported from."""
    for package, file in (
        ("analysis", "analysis/api.py"),
        ("mbs_models", "mbs_models/__init__.py"),
    ):
        for node in ast.parse((ROOT / file).read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                yield from ((f"{package}.{each.name}", str(node.module)) for each in node.names)


HOMES = dict(_homes())

# Types in docstrings link to what is public. The usual links lead to other projects.
DEFAULT_LINKS.clear()
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"
numpydoc_xref_aliases = {name.rpartition(".")[2]: name for name in HOMES}


def _without_signature(_: Sphinx, what: str, *__: Any) -> tuple[()] | None:
    """Let constants have none, though some are types that could be called."""
    return () if what == "data" else None


def _describe_constant(
    _: Sphinx, what: str, name: str, value: Any, __: Any, lines: list[str]
) -> None:
    """Describe a constant by the text below it, which Sphinx looks for in the package alone."""
    if what != "data" or name not in HOMES:
        return
    texts = ModuleAnalyzer.for_module(HOMES[name]).find_attr_docs()
    about = texts.get(("", name.rpartition(".")[2]), [])
    values = value if isinstance(value, dict | tuple) else get_args(value)
    plain = [f"``{each!r}``" for each in values if isinstance(each, str | int | tuple)]
    lines[:] = [*about, "", f"{', '.join(plain)}." if plain else ""]
