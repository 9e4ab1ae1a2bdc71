"""A whole task, as `palpate run` does it."""
from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from ._library import PalpateError, library


class Run:
    """What a run left in its folder (docs/CONTROL.md)."""

    def __init__(self, folder: Union[str, os.PathLike[str]]) -> None:
        self.folder = pathlib.Path(folder)
        #: summary.json, read.
        self.summary: dict[str, Any] = json.loads((self.folder / 'summary.json').read_text())

    @property
    def trace(self) -> NDArray[Any]:
        """trace.csv, a row a tick, as a structured array: run.trace['time_s']."""
        return np.genfromtxt(
            self.folder / 'trace.csv', delimiter=',', names=True, dtype=None, encoding='utf-8'
        )


def program() -> str:
    """The program `palpate`: beside the library that is loaded, else on the PATH. Raises PalpateError."""
    here = pathlib.Path(library._name)
    beside = here.resolve().parent.parent / 'bin' / 'palpate'
    found = os.environ.get('PALPATE_PROGRAM') or (
        str(beside) if here.is_absolute() and beside.is_file() else shutil.which('palpate')
    )
    if found is None:
        raise PalpateError(
            2, 'the program palpate, which does runs, is not on the PATH; PALPATE_PROGRAM may name it'
        )
    return found


def run(
    scene: str,
    out: Union[str, os.PathLike[str]],
    engine: str,
    pace: str,
    device: Optional[str],
    duration: Optional[float],
    overwrite: bool,
) -> Run:
    command = [program(), 'run', scene, '--out', os.fspath(out), '--pace', pace, '--backend', engine]
    command += ['--device', device] if device is not None else []
    command += ['--duration', repr(duration)] if duration is not None else []
    command += ['--overwrite'] if overwrite else []
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f'palpate run ended with code {done.returncode}'])[-1]
        raise PalpateError(done.returncode, last.removeprefix('palpate: '))
    return Run(out)
