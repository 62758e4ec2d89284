"""Malformed scenario files: one clear message each, exit code 2, no traceback, nothing written."""

import contextlib
import random
import re

import pytest
from typer.testing import CliRunner

from cayley.cli.files import TEMPLATES
from cayley.cli.main import app
from cayley.cli.problems import ScenarioError
from cayley.cli.scenario import load, shipped

MALFORMED = 500
WORDS = (
    *("rod", "section", "material", "support", "load", "joint", "body", "run", "kind", "at", "value", "length", "name"),
    *("elements", "direction", "t_end", "dt", "rule", "accuracy", "first", "second", "until", "frame", "shape"),
    *("obstacle", "contact", "on", "normal", "radius", "friction", "without", "radii", "file", "triangles"),
)
VALUES = (
    *('"clamp"', '"x"', '""', "0", "-1", "1e400", "nan", "inf", "[]", "[1]", "[1, 2, 3]", "true", "{}"),
    *("[[1, 2], [3]]", '"beam.start"', '"nowhere.end"', '"2*t"', '"__import__(1)"', '"t**t**t"', "1979-05-27"),
    *('"verlet"', "99999999999999999999", '"mesh"', '"plane"', '[["rope", "floor"]]', '"no.stl"', "{rope = 1}"),
)


def sources():
    from importlib import resources

    folder = resources.files("cayley.cli") / "templates"
    return [(folder / f"{name}.toml").read_text() for name in TEMPLATES] + [f.read_text() for f in shipped().values()]


def mutated(text, chance):
    """A valid file with some changes: characters, lines, values, keys."""
    lines = text.splitlines()
    for _ in range(chance.randint(1, 3)):
        k = chance.randrange(len(lines))
        what = chance.randrange(7)
        if what == 0:
            del lines[k]
        elif what == 1:
            lines.insert(k, chance.choice(lines))
        elif what == 2 and "=" in lines[k]:
            lines[k] = f"{lines[k].split('=')[0]}= {chance.choice(VALUES)}"
        elif what == 3 and "=" in lines[k]:
            lines[k] = f"{chance.choice(WORDS)} = {lines[k].split('=', 1)[1]}"
        elif what == 4 and lines[k]:
            at = chance.randrange(len(lines[k]))
            lines[k] = lines[k][:at] + chance.choice('[]"={}#\\\x00é\n.,') + lines[k][at + 1 :]
        elif what == 5:
            lines[k] = re.sub(r"[\d.]+", lambda _: chance.choice(("-1", "0", "1e308", "nan", "7")), lines[k])
        else:
            lines[k] = f"[{chance.choice(('', '['))}{chance.choice(WORDS)}.{chance.choice(WORDS)}]"
        lines = lines or [""]
    return "\n".join(lines)


def grown(chance):
    """A file from the grammar of TOML with words of scenarios, hardly ever a right one."""
    lines = []
    for _ in range(chance.randint(1, 8)):
        word = chance.choice(WORDS)
        lines.append(chance.choice((f"[{word}]", f"[[{word}]]", f"[{word}.{chance.choice(WORDS)}]", "")))
        lines += [f"{chance.choice(WORDS)} = {chance.choice(VALUES)}" for _ in range(chance.randint(0, 4))]
    return "\n".join(lines)


@pytest.mark.parametrize("seed", range(4))
def test_malformed_files_are_told_in_lines(seed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    chance, known, runner, found = random.Random(seed), sources(), CliRunner(), 0
    while found < MALFORMED // 4:
        text = grown(chance) if chance.random() < 0.3 else mutated(chance.choice(known), chance)
        (tmp_path / "x.toml").write_text(text, encoding="utf-8")
        with contextlib.suppress(ScenarioError):
            load("x.toml")
            continue  # the change left it right
        found += 1
        result = runner.invoke(app, ["run", "x.toml"])
        assert result.exit_code == 2, (text, result.output, result.exception)
        assert result.stdout == ""
        lines = result.stderr.splitlines()
        assert lines, text
        assert all(line.startswith("x.toml: ") for line in lines), result.stderr
        assert "Traceback" not in result.stderr
        assert [entry.name for entry in tmp_path.iterdir()] == ["x.toml"]
