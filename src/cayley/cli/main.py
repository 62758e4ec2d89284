"""The command `cayley`. What is heavy loads inside the commands: the help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    help="Variational Lie-group integrators from a Lagrangian: run rods from scenario files.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        import cayley

        typer.echo(f"cayley {cayley.__version__}")
        raise typer.Exit


@app.callback()
def cayley(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Variational Lie-group integrators from a Lagrangian: run rods from scenario files."""


@app.command()
def run(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="FILE.toml|NAME", help="A scenario file, or the name of a shipped one: leitz2014, rubber_pendulum."
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where results go; runs/NAME if not given.", show_default=False)
    ] = None,
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write the HTML report.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Run a scenario: results as a Zarr store, a table of conserved quantities, an HTML report.

    Exit codes: 0 done, 2 something is wrong with the input, 3 the run stopped on the way.
    """
    from cayley.cli.execute import execute

    raise typer.Exit(execute(scenario, out=out, report=report, quiet=quiet))


@app.command()
def statics(
    scenario: Annotated[
        str, typer.Argument(metavar="FILE.toml|NAME", help="A scenario file, or the name of a shipped one.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where results go; runs/NAME if not given.", show_default=False)
    ] = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the deformed shape.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Find the equilibrium of a scenario: ends, reactions and largest moments, a Zarr store, a picture.

    Exit codes: 0 done, 2 something is wrong with the input, 3 no equilibrium was found.
    """
    from cayley.cli.statics import statics

    raise typer.Exit(statics(scenario, out=out, picture=picture, quiet=quiet))


@app.command()
def advise(
    scenario: Annotated[
        str, typer.Argument(metavar="FILE.toml|NAME", help="A scenario file, or the name of a shipped one.")
    ],
    accuracy: Annotated[
        float | None,
        typer.Option(
            metavar="NUMBER",
            help="Largest position error over the extent of the model; that of the file, or 1e-3.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Compare rules for a scenario without running it: step, steps, expected time and error of each.

    Exit codes: 0 done, 2 something is wrong with the input or no rule reaches the accuracy.
    """
    from cayley.cli.advise import advise

    raise typer.Exit(advise(scenario, accuracy=accuracy))


@app.command()
def cite() -> None:
    """Print how to cite the library and the paper it began with."""
    from cayley.report.cite import citation

    for reference in citation():
        typer.echo(reference)
