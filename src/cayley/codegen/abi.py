"""What the compiled time loop takes, in the order of its arguments."""

ARGUMENTS = (
    *("step", "step_setup", "held", "held_setup", "kick", "kick_setup"),  # addresses of kernels
    *("predict", "predict_setup"),  # those of the predictor, 0 where no forces need one
    *("data", "blocks", "rows", "lanes", "kept"),  # array of blocks, its shape, rows that are saved
    *("uniforms", "width", "timed"),  # uniform inputs of the three kernels, whether they change with time
    *("spans", "tiles", "depth"),  # (first block, last block, held) of tiles; steps a tile takes together
    *("fixed", "fixed_count"),  # (block, row, lane) of momenta that stay zero
    *("table", "columns", "entries", "entry_count", "scales", "places"),  # time-dependent loads; (scale, lever) of each
    *(
        "stride",
        "saves",
        "frames",
        "clock",
        "failed",
    ),  # steps between saves; (origin, step, first number); save failed at
)
"""What the driver takes, as an array of 64-bit integers: numbers, and addresses of arrays."""

ENTRY = ("block", "lane", "row", "turn", "form", "column", "tile")
"""What an entry of a load says; forms: 0 as given, 1 space to body, 2 body to space, 3 and 4 the same by a matrix; with
LEVER added, then crossed with the lever of the entry from the left: the moment of a force off the node."""
LEVER = 8
