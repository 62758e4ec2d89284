"""Films."""

import sys

import pytest
from PIL import Image


def test_gif(crane, tmp_path):
    """Half a second of the run in a second at four pictures a second: nine pictures."""
    path = crane.animate(tmp_path / "crane.gif", speed=0.5, fps=4)
    with Image.open(path) as film:
        assert film.n_frames == 9
        assert film.info["duration"] == 250


def test_mp4(crane, tmp_path):
    """The program is that of the extra "film", and reads what it wrote: a second at eight pictures a second."""
    program = pytest.importorskip("imageio_ffmpeg", reason='the extra "film" is not installed')
    path = crane.animate(tmp_path / "crane.mp4", speed=1.0, fps=8)
    frames, seconds = program.count_frames_and_secs(str(path))
    assert frames == 9
    assert seconds == pytest.approx(9 / 8, abs=0.01)


def test_mp4_without_ffmpeg(crane, tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(RuntimeError, match=r"needs the program ffmpeg.*pip install 'cayley\[film\]'.*give a \.gif"):
        crane.animate(tmp_path / "crane.mp4")


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("a.avi", {}, "must end in .gif or .mp4"),
        ("a.gif", {"fps": 0}, "fps is 0"),
        ("a.gif", {"speed": -1.0}, "speed is -1"),
    ],
)
def test_refused(crane, tmp_path, name, options, told):
    with pytest.raises(ValueError, match=told):
        crane.animate(tmp_path / name, **options)
