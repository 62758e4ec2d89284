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


Folder = Annotated[Path, typer.Argument(metavar="DIR", help="A folder with run.zarr, or such a store itself.")]


@app.command()
def report(
    folder: Folder,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="The report; DIR/report.html if not given.", show_default=False),
    ] = None,
) -> None:
    """Write the HTML report of a run that is on the disk: one file that needs no network.

    Exit codes: 0 done, 2 something is wrong with the input.
    """
    from cayley.cli.look import write

    raise typer.Exit(write(folder, out))


@app.command()
def view(
    folder: Folder,
    port: Annotated[int, typer.Option(help="Of the server on this machine; 0: any that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
) -> None:
    """Watch a run in a browser, also one in progress: a server on this machine alone follows its store.

    Exit codes: 0 ended by Ctrl+C, 2 something is wrong with the input.
    """
    from cayley.cli.look import view

    raise typer.Exit(view(folder, port=port, browser=browser))


@app.command()
def cite() -> None:
    """Print how to cite the library and the paper it began with."""
    from cayley.report.cite import citation

    for reference in citation():
        typer.echo(reference)
