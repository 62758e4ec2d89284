"""Functions of which a store has the values."""

import numpy as np


class Sampled:
    """A function of the time, or of the place along a part, of which the values that were looked at are left.

    Args:
        name: name of the function.
        places: times of the saved frames [s], or coordinates of the nodes [m], shape (m,), rising.
        values: there, shape (m, k).
        what: "load", "position" or what else it is.
        variable: "t", or "s" along a part.
    """

    sampled = True  # a joint does not ask for its value at t = 0, which need not be there

    def __init__(
        self, name: str, places: np.ndarray, values: np.ndarray, what: str = "load", variable: str = "t"
    ) -> None:
        """Hold the table."""
        self.__name__, self.places, self.values, self.what, self.variable = name, places, values, what, variable

    def __call__(self, place: float) -> np.ndarray:
        """The value at the time of a frame, or at a node.

        Raises:
            ValueError: for another place; nothing is interpolated, for a run that goes on must not differ silently.
        """
        where = float(place)
        k = int(np.searchsorted(self.places, where))
        if k == len(self.places) or self.places[k] != where:
            known, unit = {"t": ("saved frames", "s"), "s": ("nodes", "m")}[self.variable]
            raise ValueError(
                f"the {self.what} function {self.__name__} is not in the store, only its values at the {known}, "
                f"and {self.variable} = {where:g} {unit} is none of them; open the run with model=... to give the "
                "function again"
            )
        return self.values[k].copy()
