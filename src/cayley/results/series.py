"""Series over time: xarray's DataArray that NumPy's reductions accept."""

from typing import Any

import numpy as np
import xarray as xr


class Series(xr.DataArray):
    """A DataArray whose values NumPy may reduce: np.ptp(run.energy) works, where a plain one is refused.

    It stays a Series under selection and arithmetic.
    """

    __slots__ = ()

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Apply a ufunc as xarray does; its reductions act on the bare values."""
        if method != "reduce":
            return super().__array_ufunc__(ufunc, method, *inputs, **options)
        plain = [value.values if isinstance(value, xr.DataArray) else value for value in inputs]
        return getattr(ufunc, method)(*plain, **options)
