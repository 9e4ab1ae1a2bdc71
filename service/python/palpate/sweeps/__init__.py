# mypy: ignore-errors
"""Sweeps: a scene asked at very many poses, on Dask's workers, into Zarr (docs/SWEEPS.md)."""
from .poses import Grid
from .run import Swept, sweep

__all__ = ['Grid', 'Swept', 'sweep']
