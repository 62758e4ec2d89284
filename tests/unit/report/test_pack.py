"""Frames as bytes, read again as web/data.js reads them."""

import gzip
import json

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from cayley.report.pack import channels, chunk, described
from cayley.report.stage import scene

SIZES = {"i2": 2, "f4": 4, "f8": 8}


def unpacked(data, widths):
    raw = gzip.decompress(data)
    length = int.from_bytes(raw[:4], "little")
    header = json.loads(raw[4 : 4 + length])
    at, found = 4 + length, []
    for (kind, scale), width in zip(header["channels"], widths, strict=True):
        assert at % 8 == 0
        count = header["frames"] * width
        planes = np.frombuffer(raw, np.uint8, count * SIZES[kind], at).reshape(SIZES[kind], count)
        numbers = np.ascontiguousarray(planes.T).view(f"<{kind}").reshape(header["frames"], width)
        if kind == "i2":
            numbers = np.cumsum(numbers, axis=0, dtype=np.int16)  # modulo 2^16
        found.append(scale * numbers.astype(float))
        at += -(-planes.size // 8) * 8
    assert at == len(raw)
    return found


def test_all_frames_come_back(crane):
    """Times and graphs exactly, positions to 24 bits, the rest to 1/32767 of its largest value."""
    packed = scene(crane)
    own = list(channels(packed))
    found = unpacked(chunk(packed), [values[0].size for _, values in own])
    for (kind, values), read in zip(own, found, strict=True):
        flat = values.reshape(len(values), -1)
        if kind == "f8":
            assert_array_equal(read, flat)
        else:
            bound = {"f4": 6e-8, "i2": 0.51 / 32767}[kind]
            assert_allclose(read, flat, rtol=0.0, atol=bound * np.abs(flat).max() + 1e-300)


def test_a_chunk_is_a_part_of_the_frames(crane):
    packed = scene(crane)
    widths = [values[0].size for _, values in channels(packed)]
    part = unpacked(chunk(packed, 10, 15), widths)
    assert_array_equal(part[0][:, 0], packed.time[10:15])
    last = unpacked(chunk(packed, 50), widths)
    assert_array_equal(last[0][:, 0], packed.time[50:])


def test_the_rest_is_json(crane):
    about = json.loads(json.dumps(described(scene(crane))))
    assert [part["kind"] for part in about["parts"]] == ["strand", "strand", "block"]
    assert np.shape(about["parts"][0]["outlines"])[0] == 7
    assert np.shape(about["parts"][1]["outlines"]) == (1, 4, 2)
