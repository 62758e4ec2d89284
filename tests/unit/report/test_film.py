"""Films."""

import pytest
from matplotlib import animation
from PIL import Image


def test_gif(crane, tmp_path):
    """Half a second of the run in a second at four pictures a second: nine pictures."""
    path = crane.animate(tmp_path / "crane.gif", speed=0.5, fps=4)
    with Image.open(path) as film:
        assert film.n_frames == 9
        assert film.info["duration"] == 250


def test_mp4_without_ffmpeg(crane, tmp_path, monkeypatch):
    monkeypatch.setattr(animation.FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(RuntimeError, match="needs the program ffmpeg"):
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
