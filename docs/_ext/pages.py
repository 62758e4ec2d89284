"""Pages that are made before the build: twins of the documents outside docs/, and the reference from the public names.

Links in Markdown are written as GitHub follows them, from file to file; here they are sent to pages of the site.
"""

import ast
import importlib
import inspect
import os
import re
import sys
import textwrap
from pathlib import Path
from typing import Any

import docstrings
import numpy as np

import cayley

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
ABOUT, API = DOCS / "about", DOCS / "api"
TWINS = {
    "changelog": "CHANGELOG.md",
    "contributing": "CONTRIBUTING.md",
    "benchmarks": "benchmarks/README.md",
}
"""Pages of the site that are documents elsewhere in the repository."""
INSTEAD = {
    ROOT / "README.md": DOCS / "index.md",
    ROOT / "examples": DOCS / "gallery" / "index.rst",
    DOCS / "adr": DOCS / "decisions.md",
}
"""What has no page of its own, and the page that says the same."""

GROUPS: dict[str, tuple[str, ...]] = {
    "Models": ("Material", "Section", "Rod", "Body", "PointMass", "LagrangianPart", "ground", "Model"),
    "Contact": ("Contact", "Plane", "Sphere", "Capsule", "Cylinder", "Box", "Mesh"),
    "Running": (
        "simulate",
        "resume",
        "Trajectory",
        "SimulationError",
        "Interrupted",
        "WriteError",
        "DamageWarning",
        "ContactDepthWarning",
    ),
    "Statics and vibration": (
        "equilibrium",
        "Equilibrium",
        "EquilibriumError",
        "settle",
        "Settled",
        "SettleError",
        "trace",
        "Path",
        "buckling",
        "modes",
        "Modes",
        "campbell",
        "frequency_response",
        "matrices",
    ),
    "Files": ("export", "cite"),
    "Lagrangians": (
        "lagrangian",
        "Lagrangian",
        "compile",
        "integrate",
        "Rotation",
        "Vector",
        "Interval",
        "dot",
        "cross",
        "norm",
        "where",
        "rate",
        "E1",
        "E2",
        "E3",
    ),
}
"""What stands together in the reference; other public names come on the page "More", families on pages of their own."""


def make(app: Any) -> None:
    """Write the pages; those that did not change keep their time."""
    wanted = {ABOUT / f"{name}.md": (ROOT / path).read_text(encoding="utf-8") for name, path in TWINS.items()}
    wanted |= reference()
    for old in [path for folder in (ABOUT, API) for path in folder.glob("*") if path not in wanted]:
        old.unlink()
    for path, text in wanted.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def reference() -> dict[Path, str]:
    """The pages of the API: one for each group of names and for each family, and their list."""
    grouped = {name for names in GROUPS.values() for name in names}
    rest = [n for n in cayley.__all__ if n not in grouped and n not in cayley._MODULES and not n.startswith("__")]
    groups = {title: tuple(n for n in names if n in cayley.__all__) for title, names in GROUPS.items()}
    groups |= {"More": tuple(rest)} if rest else {}
    pages = {slug(title): _group_page(title, names) for title, names in groups.items()}
    pages |= {name: _family_page(name) for name in cayley._MODULES}
    return {API / f"{name}.rst": text for name, text in pages.items()} | {API / "index.rst": _list(groups)}


def slug(title: str) -> str:
    """Name of a group's page."""
    return title.lower().replace(" ", "-")


def _group_page(title: str, names: tuple[str, ...]) -> str:
    return "\n".join([_heading(title), *(_entry(name, getattr(cayley, name)) for name in names)])


def _family_page(name: str) -> str:
    module = importlib.import_module(f"cayley.{cayley._MODULES[name]}")
    sys.modules[f"cayley.{name}"] = module  # so that entries are named as users write them
    summary = (module.__doc__ or "").strip().partition("\n")[0]
    entries = [_entry(f"{name}.{own}", getattr(module, own)) for own in public(module)]
    return "\n".join([_heading(f"cayley.{name}"), summary, "", *entries])


def public(module: Any) -> list[str]:
    """Public names of a family that are at home in it or named by it."""
    listed = getattr(module, "__all__", None)
    if listed is not None:
        return [name for name in listed if not isinstance(getattr(module, name), str | int | float)]
    body = ast.parse(inspect.getsource(module)).body
    defined = [node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    values = [t.id for node in body if isinstance(node, ast.Assign) for t in node.targets if isinstance(t, ast.Name)]
    return [name for name in [*values, *defined] if not name.startswith("_") and not name.isupper()]


def _directive(value: Any) -> str:
    if isinstance(value, type):
        return "autoexception" if issubclass(value, BaseException) else "autoclass"
    return "autofunction" if callable(value) and hasattr(value, "__name__") else "autodata"


def _entry(name: str, value: Any) -> str:
    """One public name; a plain array has no docstring of its own, a Lagrangian has that of its function."""
    if isinstance(value, cayley.Lagrangian):
        lines = docstrings.as_rst(inspect.cleandoc(value.function.__doc__ or "").splitlines())
        text = textwrap.indent("\n".join(lines), "    ")
        return f".. py:data:: cayley.{name}\n    :type: Lagrangian\n\n{text}\n"
    if isinstance(value, np.ndarray):
        return f".. py:data:: cayley.{name}\n    :value: {tuple(float(x) for x in value)}\n\n    A unit vector.\n"
    directive = _directive(value)
    return f".. {directive}:: cayley.{name}\n" + ("    :no-value:\n" if directive == "autodata" else "")


def _list(groups: dict[str, tuple[str, ...]]) -> str:
    lines = [_heading("API reference")]
    lines += [
        "Everything public is an attribute of ``cayley``, imported as ``cy`` throughout. Each entry has its formula,",
        "shapes, SI units, errors and source; *[source]* beside it shows the code.",
        "",
    ]
    for title, names in groups.items():
        links = ", ".join(f":py:obj:`{name} <cayley.{name}>`" for name in names)
        lines += [f":doc:`{title} <{slug(title)}>`", f"    {links}", ""]
    for name, home in cayley._MODULES.items():
        module = importlib.import_module(f"cayley.{home}")
        links = ", ".join(f":py:obj:`{n} <cayley.{name}.{n}>`" for n in public(module))
        lines += [f":doc:`cayley.{name} <{name}>`", f"    {links}", ""]
    tree = "\n".join(f"    {slug(name)}" for name in (*groups, *cayley._MODULES))
    return "\n".join([*lines, ".. toctree::", "    :hidden:", "", tree, ""])


def _heading(title: str) -> str:
    return f"{title}\n{'=' * len(title)}\n"


def read(app: Any, docname: str, content: list[str]) -> None:
    """Send the links of a Markdown page to pages of the site, and what is no page to the page of the file."""
    twin = docname.removeprefix("about/")
    home = ROOT / TWINS[twin] if docname.startswith("about/") else DOCS / f"{docname}.md"
    if not home.exists() or docname.startswith("gallery/"):
        return
    here = (DOCS / docname).parent
    content[0] = re.sub(
        r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))",
        lambda m: m[1] + target(m[2], home.parent, here) + m[3],
        content[0],
    )


def target(link: str, home: Path, here: Path) -> str:
    """A link of a document in the folder home, for a page that Sphinx sees in the folder here."""
    if re.match(r"[a-z]+:", link):
        return link
    path = (home / link).resolve()
    twin = next((ABOUT / f"{name}.md" for name, other in TWINS.items() if path == ROOT / other), None)
    path = twin or INSTEAD.get(path, path)
    if not (path.is_relative_to(DOCS) and path.suffix in (".md", ".rst", ".png", ".svg")):
        return f"source:{path.relative_to(ROOT).as_posix()}" if path.exists() else link
    return Path(os.path.relpath(path, here)).as_posix()


def setup(app: Any) -> dict[str, bool]:
    """Pages first, links as they are read."""
    app.connect("builder-inited", make)
    app.connect("source-read", read)
    return {"parallel_read_safe": True}
