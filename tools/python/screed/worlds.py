"""Worlds of robots with their firmware in the loop, in the stand-in: one, or many at once."""

from __future__ import annotations

import ctypes as c
import os
from typing import Any, Mapping, Sequence

import numpy as np

from . import _library as lib
from .runs import settings


def prepare(experiment: str | os.PathLike, set: Mapping[str, Any] | None = None) -> bytes:
    """The world of an experiment as bytes, of any seed (`screed prepare`)."""
    given = lib.Bytes()
    lib.library.prepare(os.fspath(experiment).encode(), *lib.texts(settings(None, set)), c.byref(given))
    return lib.take(given)


def actions(control: int, values, count: int) -> np.ndarray:
    """The same control for so many robots, with two values for each."""
    values = np.asarray(values, float)
    if values.shape != (count, 2):
        raise lib.InputError(f"actions of shape {values.shape}; allowed: {(count, 2)}")
    array = np.zeros(count, lib.ACTION)
    array["control"] = control
    array["values"] = values
    return array


class World(lib.Handle):
    """A world: `World("level_bed", seed=3)`; `prepare()`'s bytes do as well."""

    _free = "world_destroy"

    def __init__(self, experiment: str | os.PathLike | bytes, *, seed: int = 1, set: Mapping[str, Any] | None = None):
        prepared = experiment if isinstance(experiment, bytes) else prepare(experiment, set)
        self._handle = lib.library.world_create(prepared, len(prepared), seed)
        self.robots: int = lib.library.world_robots(self._handle)
        self._bed, spacing = lib.Rectangle(), c.c_double()
        lib.library.world_bed(self._handle, c.byref(self._bed), c.byref(spacing))
        self.spacing = spacing.value

    def reset(self, seed: int) -> None:
        """As it was made, of another seed."""
        lib.library.world_reset(self._handle, seed)

    @property
    def time(self) -> float:
        """That it has lived, s."""
        ticks = c.c_uint64()
        lib.library.world_ticks(self._handle, c.byref(ticks))
        return ticks.value / 100

    def advance(self, ticks: int, *, command=None, duty=None) -> None:
        """Goes on by so many ticks of 10 ms.

        command: (speed m/s, yaw rate rad/s) for each robot, over the radio to its firmware, which executes it with
        the algorithm "drive".  duty: (left, right), -1..1, for the motors in place of the firmware's.  Neither: what
        was said last.
        """
        array = None
        if command is not None:
            array = actions(lib.COMMAND, command, self.robots)
        elif duty is not None:
            array = actions(lib.DUTY, duty, self.robots)
        lib.library.world_advance(self._handle, ticks, lib.address(array))

    def _rows(self, table: int) -> np.ndarray:
        rows = np.empty(self.robots, lib.dtype_of(table))
        for robot in range(self.robots):
            lib.library.world_row(self._handle, robot, table, rows[robot:].ctypes.data)
        return rows

    @property
    def frames(self) -> np.ndarray:
        """The newest of each robot, as Session.frames has them."""
        return self._rows(lib.FRAMES)

    @property
    def samples(self) -> np.ndarray:
        return self._rows(lib.SAMPLES)

    def level(self, transport: bool = False) -> np.void:
        """How level the ground is: level_deviation, relief, roughness, m, and with `transport` W1 and the square of
        W2, which take some 20 ms."""
        level = np.empty(1, lib.LEVEL)
        lib.library.world_level(self._handle, transport, lib.address(level))
        return level[0]

    @property
    def ground(self) -> np.ndarray:
        """Heights, m; [0, 0] is the south-west corner, rows go north."""
        heights = np.empty((self._bed.nodes_y, self._bed.nodes_x))
        lib.library.world_heights(self._handle, c.byref(self._bed), lib.address(heights))
        return heights


class Worlds(lib.Handle):
    """Many worlds of one experiment, each with a seed, advanced by several threads."""

    _free = "worlds_destroy"

    def __init__(self, experiment: str | os.PathLike | bytes, seeds: Sequence[int], *,
                 set: Mapping[str, Any] | None = None, threads: int | None = None):
        prepared = experiment if isinstance(experiment, bytes) else prepare(experiment, set)
        its = np.ascontiguousarray(seeds, np.uint64)
        if its.ndim != 1:
            raise lib.InputError(f"seeds of shape {its.shape}; allowed: one for each world")
        self._handle = lib.library.worlds_create(prepared, len(prepared), lib.address(its), len(its),
                                                 threads or min(256, len(os.sched_getaffinity(0))))
        self.count = len(its)
        self.robots: int = lib.library.worlds_robots(self._handle)
        self._rows = {}

    def reset(self, which, seeds, ticks: int = 0) -> None:
        """Those where `which` is true, with their seeds of `seeds`; then they live so many ticks alone."""
        which = np.ascontiguousarray(which, bool)
        seeds = np.ascontiguousarray(seeds, np.uint64)
        for name, array in (("which", which), ("seeds", seeds)):
            if array.shape != (self.count,):
                raise lib.InputError(f"{name} of shape {array.shape}; allowed: {(self.count,)}")
        lib.library.worlds_reset(self._handle, lib.address(which), lib.address(seeds), ticks)

    def advance(self, ticks: int, told: np.ndarray | None = None) -> None:
        """All by so many ticks; `told`: of actions(), for each robot of each world."""
        if told is not None and (told.dtype != lib.ACTION or told.shape != (self.count * self.robots,)):
            raise lib.InputError(f"actions of shape {told.shape}; allowed: {(self.count * self.robots,)}")
        told = None if told is None else np.ascontiguousarray(told)
        lib.library.worlds_advance(self._handle, ticks, lib.address(told))

    def rows(self, table: int) -> np.ndarray:
        """The newest of each robot of each world; the same array each time, in which they are replaced."""
        if table not in self._rows:
            self._rows[table] = np.zeros((self.count, self.robots), lib.dtype_of(table))
        rows = self._rows[table]
        lib.library.worlds_rows(self._handle, table, lib.address(rows))
        return rows

    def level(self, transport: bool = False) -> np.ndarray:
        levels = np.empty(self.count, lib.LEVEL)
        lib.library.worlds_level(self._handle, transport, lib.address(levels))
        return levels
