"""Runs of experiments, and what they have recorded, as arrays."""

from __future__ import annotations

import ctypes as c
import functools
import json
import os
import pathlib
from typing import Any, Mapping

import numpy as np

from . import _library as lib


def settings(seed: int | None, values: Mapping[str, Any] | None) -> list[str]:
    """Keys of an experiment, "section.key=value", as the library takes them."""
    words = []
    for key, value in (values or {}).items():
        if isinstance(value, bool):
            value = "true" if value else "false"
        words.append(f"{key}={value}")
    if seed is not None:
        words.append(f"experiment.seed={seed}")
    return words


class Session(lib.Handle):
    """A recorded run: `Session("out/first_drive-0001")`; of several robots one, by its number.

    Tables are structured arrays, a row a tick: `frames["x"]`; `frames.dtype.metadata["x"]` has unit and meaning.
    They are read when they are first asked for.
    """

    _free = "session_close"

    def __init__(self, run: str | os.PathLike, robot: int = 0):
        self._handle = lib.library.session_open(os.fspath(run).encode(), robot)
        self.run = pathlib.Path(run)

    def _table(self, table: int) -> np.ndarray:
        rows = np.empty(lib.library.session_rows(self._handle, table), lib.dtype_of(table))
        lib.library.session_read(self._handle, table, 0, len(rows), lib.address(rows))
        return rows

    @functools.cached_property
    def frames(self) -> np.ndarray:
        """The truth, and under est_... and odometry_... what the firmware thinks."""
        return self._table(lib.FRAMES)

    @functools.cached_property
    def samples(self) -> np.ndarray:
        """What the firmware has read of its sensors, in their counts."""
        return self._table(lib.SAMPLES)

    @functools.cached_property
    def outputs(self) -> np.ndarray:
        """What the firmware has answered."""
        return self._table(lib.OUTPUTS)

    @functools.cached_property
    def leveling(self) -> np.ndarray:
        """How level the bed was, over time."""
        return self._table(lib.LEVELING)

    @functools.cached_property
    def info(self) -> dict[str, Any]:
        """Name, text of the experiment, seed, board, program, content hash; whether the run is complete."""
        given = lib.Bytes()
        lib.library.session_info(self._handle, c.byref(given))
        return json.loads(lib.take(given))

    def _ground(self, after: int) -> np.ndarray:
        nodes, spacing = lib.Rectangle(), c.c_double()
        lib.library.session_ground(self._handle, after, c.byref(nodes), c.byref(spacing), None)
        heights = np.empty((nodes.nodes_y, nodes.nodes_x))
        lib.library.session_ground(self._handle, after, c.byref(nodes), c.byref(spacing), lib.address(heights))
        return heights

    @functools.cached_property
    def ground_before(self) -> np.ndarray:
        """Heights, m; [0, 0] is the south-west corner, rows go north."""
        return self._ground(0)

    @functools.cached_property
    def ground_after(self) -> np.ndarray:
        return self._ground(1)

    @functools.cached_property
    def spacing(self) -> float:
        """Of the ground's nodes, m."""
        nodes, spacing = lib.Rectangle(), c.c_double()
        lib.library.session_ground(self._handle, 0, c.byref(nodes), c.byref(spacing), None)
        return spacing.value

    def pandas(self, table: str = "frames"):
        """A table as a DataFrame over its time; columns of several elements become several."""
        import pandas

        rows = getattr(self, table)
        columns = {}
        for name in rows.dtype.names:
            if rows[name].ndim == 1:
                columns[name] = rows[name]
            else:
                columns.update({f"{name}_{i}": rows[name][:, i] for i in range(rows[name].shape[1])})
        return pandas.DataFrame(columns)


class Run:
    """What sim() has done: `summary` as of `screed sim --json`."""

    def __init__(self, summary: dict[str, Any]):
        self.summary = summary
        self.folder = pathlib.Path(summary["run_folder"])
        self.content_hash: str = summary["content_hash"]

    def session(self, robot: int = 0) -> Session:
        return Session(self.folder, robot)

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r}, content_hash={self.content_hash!r})"


def sim(experiment: str | os.PathLike, *, seed: int | None = None, set: Mapping[str, Any] | None = None,
        hal: str = "native", out: str | os.PathLike | None = None) -> Run:
    """Runs an experiment as `screed sim` does, with the same bits.

    experiment: a file, or the name of one that comes with Screed.  set: keys in place of the experiment's,
    {"experiment.duration": 60}.  hal: "native" (physics) or "surrogate" (the stand-in).  out: a new folder.
    """
    given = lib.Bytes()
    folder = None if out is None else os.fspath(out).encode()
    lib.library.sim(os.fspath(experiment).encode(), *lib.texts(settings(seed, set)), hal.encode(), folder,
                    c.byref(given))
    return Run(json.loads(lib.take(given)))
