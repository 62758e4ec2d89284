"""The examples as sphinx-gallery wants them: the first line of the docstring becomes a title with a line under it."""

import ast
import re
from pathlib import Path
from typing import Any

DOCS = Path(__file__).resolve().parent.parent
EXAMPLES = DOCS.parent / "examples"
STAGED = DOCS / "_staged" / "examples"


SECTIONS: dict[str, tuple[str, ...]] = {
    "Rods at rest": (
        "catenary",
        "curling_strip",
        "locking",
        "thick_beam",
        "roll_up",
        "unrolling",
        "bend_45",
        "elastica",
        "princeton",
        "composite",
        "twisted",
        "helix",
        "steady_spin",
    ),
    "Rods that buckle": (
        "buckled_rod",
        "columns",
        "clamped_branches",
        "twisted_rod",
        "right_angle_frame",
    ),
    "Frequencies": (
        "timoshenko_frequencies",
        "rotating_cantilever",
        "rotating_blade",
    ),
    "Rods in motion": (
        "rubber_pendulum",
        "paper_beam",
        "helical_spring",
        "flying_spaghetti",
        "falling_spring",
        "whip",
        "cable_in_flow",
        "tendon_finger",
        "kinematics",
    ),
    "Bodies and joints": (
        "frame_and_weight",
        "double_pendulum",
        "slider_crank",
        "four_bar",
        "kapitza",
        "free_body",
        "heavy_top_body",
    ),
    "Lagrangians of your own": (
        "heavy_top",
        "own_density_string",
        "inextensible_chain",
        "own_constraint",
        "kepler",
    ),
    "Runs and rules": ("orders", "energy_balance", "restart", "sweep"),
}
"""What stands together in the gallery, by the names of the scripts without "plot_"; all others come last."""
HEAD = """Gallery
=======

Every example is a script in the folder ``examples`` of the repository. It runs in seconds, checks its own numbers, and
is one of the tests.
"""


def stage() -> Path:
    """Copy the examples by section; files that did not change keep their time, so they are not run again."""
    scripts = {path.stem.removeprefix("plot_"): path for path in sorted(EXAMPLES.rglob("*.py"))}
    known = {name for names in SECTIONS.values() for name in names}
    sections = {**SECTIONS, "More": tuple(name for name in scripts if name not in known)}
    wanted = {STAGED / "GALLERY_HEADER.rst": HEAD}
    for k, (title, names) in enumerate(sections.items()):
        here, found = STAGED / f"{k + 1}", [name for name in names if name in scripts]
        texts = {here / f"{name}.py": titled(scripts[name].read_text(encoding="utf-8")) for name in found}
        heading = {here / "GALLERY_HEADER.rst": f"{title}\n{'-' * len(title)}\n"}
        wanted |= {**texts, **heading} if found else {}
    for old in [path for path in STAGED.rglob("*") if path.is_file() and path not in wanted]:
        old.unlink()
    for target, text in wanted.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")
    for empty in [folder for folder in STAGED.iterdir() if folder.is_dir() and not any(folder.iterdir())]:
        empty.rmdir()
    return STAGED


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


def bare_figure(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save what an example calls `figure`, if pyplot does not know it: figures of cayley.report."""
    from matplotlib.figure import Figure
    from sphinx_gallery.scrapers import figure_rst

    figure = block_vars["example_globals"].get("figure")
    if not isinstance(figure, Figure) or figure.canvas.manager is not None or hasattr(figure, "in_gallery"):
        return ""
    path = next(block_vars["image_path_iterator"])
    figure.savefig(path, dpi=110)
    figure.in_gallery = True  # type: ignore[attr-defined]
    text: str = figure_rst([path], gallery_conf["src_dir"])
    return text


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
