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


Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Where `cayley run` wrote, or a store NAME.zarr.")]
Report = Annotated[bool, typer.Option("--report/--no-report", help="Write the HTML report.")]
Source = Annotated[str, typer.Argument(metavar="FILE.toml|NAME", help="A scenario file, or the name of a shipped one.")]
Out = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Where results go; runs/NAME if not given.", show_default=False)
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]


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
    out: Out = None,
    report: Report = True,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Run a scenario: results as a Zarr store, a table of conserved quantities, an HTML report.

    Exit codes: 0 done, 2 something is wrong with the input, 3 the run stopped on the way, 130 stopped by hand.

    Example: cayley run leitz2014 --out runs/first
    """
    from cayley.cli.execute import Wanted, execute

    raise typer.Exit(execute(scenario, out=out, wanted=Wanted(report, quiet, as_json)))


@app.command()
def resume(
    folder: Folder,
    until: Annotated[
        float | None,
        typer.Option(metavar="TIME", help="End of the run [s]; that which was asked for.", show_default=False),
    ] = None,
    report: Report = True,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> None:
    """Go on with a run that was killed, stopped by Ctrl-C or is to be longer, as if it had never stopped.

    Exit codes: as of `cayley run`.

    Example: cayley resume runs/leitz2014 --until 5
    """
    from cayley.cli.execute import Wanted
    from cayley.cli.resume import resume

    raise typer.Exit(resume(folder, until=until, wanted=Wanted(report, quiet, as_json)))


@app.command()
def check(
    scenario: Annotated[str, typer.Argument(metavar="FILE.toml|NAME", help="A scenario file, or the name of one.")],
    as_json: AsJson = False,
) -> None:
    """Check a scenario without running it, and print its model.

    Exit codes: 0 nothing is wrong, 2 something is; one line for each problem.

    Example: cayley check mast.toml
    """
    from cayley.cli.files import check

    raise typer.Exit(check(scenario, as_json=as_json))


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files, for editors that complete and check TOML.

    Example: cayley schema > cayley.schema.json
    """
    from cayley.cli.files import schema_text

    typer.echo(schema_text())


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Of the file NAME.toml to be made.")],
    template: Annotated[
        str, typer.Option(metavar="WORD", help="cantilever, pendulum, assembly, rope, column, or a shipped scenario.")
    ] = "cantilever",
) -> None:
    """Make a scenario file to begin with.

    Example: cayley new mast --template assembly
    """
    from cayley.cli.files import new

    raise typer.Exit(new(name, template))


@app.command()
def export(
    folder: Folder,
    kind: Annotated[str, typer.Option("--to", metavar="KIND", help="csv, netcdf or vtk.")] = "csv",
    out: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Where it goes; DIR/KIND if not given.", show_default=False)
    ] = None,
) -> None:
    """Write a run for other programs: tables (csv), one file with a group for each part (netcdf), ParaView (vtk).

    Example: cayley export runs/leitz2014 --to vtk
    """
    from cayley.cli.files import export

    raise typer.Exit(export(folder, kind, out))


@app.command()
def doctor() -> None:
    """Say what this installation is, and whether it works: versions, processor, compiled engine, a small run.

    Exit codes: 0 all is well, 1 something is not.

    Example: cayley doctor
    """
    from cayley.cli.doctor import doctor

    raise typer.Exit(doctor())


@app.command()
def modes(
    scenario: Source,
    out: Out = None,
    count: Annotated[
        int | None, typer.Option(min=1, help="Number of modes; that of the file, or 10.", show_default=False)
    ] = None,
    report: Annotated[bool, typer.Option("--report/--no-report", help="Write the HTML page.")] = True,
    quiet: Quiet = False,
) -> None:
    """Find the modes of a scenario about its equilibrium: a table, a Zarr store, pictures, a page where they move.

    Exit codes: 0 done, 2 something is wrong with the input, 3 there is no equilibrium.

    Example: cayley modes rubber_pendulum --count 5 --out runs/modes
    """
    from cayley.cli.modes import modes

    raise typer.Exit(modes(scenario, out=out, count=count, report=report, quiet=quiet))


@app.command()
def advise(
    scenario: Source,
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

    Example: cayley advise rubber_pendulum --accuracy 1e-4
    """
    from cayley.cli.advise import advise

    raise typer.Exit(advise(scenario, accuracy=accuracy))


@app.command()
def report(
    folder: Folder,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="The report; DIR/report.html if not given.", show_default=False),
    ] = None,
) -> None:
    """Write the HTML report of a run that is on the disk: one file that plays it and needs no network.

    Exit codes: 0 done, 2 something is wrong with the input.

    Example: cayley report runs/leitz2014
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

    Example: cayley view runs/leitz2014
    """
    from cayley.cli.look import view

    raise typer.Exit(view(folder, port=port, browser=browser))


@app.command()
def sweep(
    scenario: Source,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=V1,V2,...", help="Values of a key; given several times, all combinations."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Where results go; runs/NAME_sweep if not given.", show_default=False),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Processes; one for each processor.", show_default=False)
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Run a scenario with many values of some of its keys: a table of outcomes and a store for each.

    Exit codes: 0 done, 2 something is wrong with the input, 3 a run stopped on the way.

    Example: cayley sweep rubber_pendulum --set material.rubber.youngs_modulus=1e6,5e6 --set run.t_end=1
    """
    from cayley.cli.execute import Wanted
    from cayley.cli.sweep import sweep

    raise typer.Exit(sweep(scenario, settings or [], out=out, workers=workers, wanted=Wanted(quiet=quiet)))


@app.command()
def trace(
    scenario: Annotated[
        str, typer.Argument(metavar="FILE.toml", help="A scenario file with a table \\[trace].", show_default=False)
    ],
    out: Out = None,
    quiet: Quiet = False,
) -> None:
    """Follow equilibria of a scenario along a parameter: limit and bifurcation points, a Zarr store, a diagram.

    Exit codes: 0 done, 2 something is wrong with the input, 3 there is no equilibrium.

    Example: cayley new column --template column; cayley trace column.toml
    """
    from cayley.cli.trace import trace

    raise typer.Exit(trace(scenario, out=out, quiet=quiet))


@app.command()
def statics(
    scenario: Source,
    out: Out = None,
    picture: Annotated[bool, typer.Option("--picture/--no-picture", help="Draw the deformed shape.")] = True,
    quiet: Quiet = False,
) -> None:
    """Find the equilibrium of a scenario: ends, reactions and largest moments, a Zarr store, a picture.

    Exit codes: 0 done, 2 something is wrong with the input, 3 no equilibrium was found.

    Example: cayley statics rubber_pendulum --out runs/rest
    """
    from cayley.cli.statics import statics

    raise typer.Exit(statics(scenario, out=out, picture=picture, quiet=quiet))


@app.command()
def cite(
    folder: Annotated[
        Path | None,
        typer.Argument(metavar="[DIR]", help="A run: BibTeX of the methods it used.", show_default=False),
    ] = None,
) -> None:
    """Print how to cite the library and the paper it began with; of a run, BibTeX of the methods it used.

    Example: cayley cite runs/leitz2014 > methods.bib
    """
    from cayley.cli.files import cite

    raise typer.Exit(cite(folder))
