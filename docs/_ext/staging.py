"""The examples as sphinx-gallery wants them: the first line of the docstring becomes a title with a line under it."""

import ast
import re
import shutil
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parent.parent
EXAMPLES = DOCS.parent / "examples"
STAGED = DOCS / "_staged" / "examples"


def stage() -> list[Path]:
    """Copy the examples with their headers; files that did not change keep their time, so they are not run again."""
    wanted = {
        STAGED / path.relative_to(EXAMPLES): path for path in EXAMPLES.rglob("*") if path.suffix in (".py", ".rst")
    }
    for old in [path for path in STAGED.rglob("*") if path.is_file() and path not in wanted]:
        old.unlink()
    for target, path in wanted.items():
        text = path.read_text(encoding="utf-8")
        text = titled(text) if path.suffix == ".py" else text
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")
            shutil.copystat(path, target)
    return [STAGED]


def titled(source: str) -> str:
    """A script with a heading for a docstring's first sentence: its part before the colon, the rest as a paragraph.

    A docstring whose second line underlines the first is left alone.
    """
    module = ast.parse(source)
    docstring = ast.get_docstring(module, clean=False)
    if docstring is None:
        raise ValueError("an example needs a docstring")
    first, _, rest = docstring.partition("\n\n")
    lines = first.splitlines()
    if len(lines) > 1 and re.fullmatch(r"([=\-~^])\1{2,}", lines[1].strip()):
        return source
    head, colon, tail = " ".join(lines).partition(": ")
    title = head.rstrip(".")
    after = f"{tail[:1].upper()}{tail[1:]}\n\n" if colon else ""
    heading = f"{title}\n{'=' * len(title)}\n\n{after}"
    code = "\n".join(source.splitlines()[module.body[0].end_lineno or 0 :])
    return f'"""\n{heading}{rest.rstrip()}\n"""\n{code}\n'


def figure_style(gallery_conf: dict[str, Any], fname: str) -> None:
    """Figures look like those of the reports."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    from cayley.report import style

    plt.close("all")
    mpl.rcdefaults()
    mpl.rcParams.update(style._PARAMETERS)
    mpl.rcParams.update({"figure.dpi": 110, "savefig.dpi": 110, "font.size": 9.5, "axes.titlesize": 9.5})
    mpl.rcParams["axes.prop_cycle"] = mpl.cycler(color=[*style.AXES, "#CC79A7", "#E69F00", "#56B4E9"])
