"""Screed from Python: runs with the same bits as the program's, recorded runs as arrays, robots with their firmware in
thousands of worlds, environments for learning. docs/python.md has examples."""

from . import _library
from ._library import BusyError, Error, InputError
from .environments import ParallelEnv, VectorEnv, vec_env
from .runs import Run, Session, sim
from .worlds import World, Worlds, prepare

__version__ = _library.library.soil_version().decode()
__all__ = ["BusyError", "Error", "InputError", "ParallelEnv", "Run", "Session", "VectorEnv", "World", "Worlds",
           "prepare", "sim", "vec_env"]
