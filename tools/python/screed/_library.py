"""The C library under the module: what it is found by, its types, and errors as exceptions."""

from __future__ import annotations

import ctypes as c
import ctypes.util
import os
import pathlib

import numpy as np


class Error(RuntimeError):
    """The library could not do it: the text says why."""


class InputError(Error, ValueError):
    """What was given is not allowed: the text says what is wrong and what is allowed."""


class BusyError(Error):
    """Another thread is at work with the same object."""


_EXCEPTIONS = {1: InputError, 2: BusyError, 3: MemoryError, 4: Error}


class _Text(c.Structure):
    _fields_ = [("status", c.c_int), ("text", c.c_char * 252)]


class Bytes(c.Structure):
    _fields_ = [("data", c.c_void_p), ("size", c.c_size_t)]


class Rectangle(c.Structure):
    _fields_ = [("x", c.c_int), ("y", c.c_int), ("nodes_x", c.c_int), ("nodes_y", c.c_int)]


class _Column(c.Structure):
    _fields_ = [("name", c.c_char_p), ("unit", c.c_char_p), ("meaning", c.c_char_p), ("type", c.c_int),
                ("count", c.c_int), ("offset", c.c_int)]


#: What screed_action and screed_level are as arrays.
ACTION = np.dtype({"names": ["control", "values"], "formats": ["i4", ("f8", 2)], "offsets": [0, 8], "itemsize": 24})
LEVEL = np.dtype([(name, "f8") for name in ("level_deviation", "relief", "roughness", "transport",
                                            "transport_squared")])
FIRMWARE, COMMAND, DUTY = range(3)
FRAMES, SAMPLES, OUTPUTS, LEVELING = range(4)

_ARRAY, _TEXT, _INT, _HANDLE, _SIZE, _U64 = c.c_void_p, c.c_char_p, c.c_int, c.c_void_p, c.c_size_t, c.c_uint64
_SETS = [c.POINTER(c.c_char_p), c.c_size_t]
# Result and arguments; the last one of a function that can fail is its error. Results: "status" raises, "handle"
# raises where it is null, "count" where it is negative.
_FUNCTIONS = {
    "free": (None, [c.POINTER(Bytes)]),
    "soil_version": (_TEXT, []),
    "table_row": (_SIZE, [_INT]),
    "table_column": (_INT, [_INT, _INT, c.POINTER(_Column)]),
    "prepare": ("status", [_TEXT, *_SETS, c.POINTER(Bytes)]),
    "sim": ("status", [_TEXT, *_SETS, _TEXT, _TEXT, c.POINTER(Bytes)]),
    "session_open": ("handle", [_TEXT, _INT]),
    "session_close": (None, [_HANDLE]),
    "session_info": ("status", [_HANDLE, c.POINTER(Bytes)]),
    "session_rows": ("count", [_HANDLE, _INT]),
    "session_read": ("status", [_HANDLE, _INT, c.c_int64, c.c_int64, _ARRAY]),
    "session_ground": ("status", [_HANDLE, _INT, c.POINTER(Rectangle), c.POINTER(c.c_double), _ARRAY]),
    "world_create": ("handle", [_TEXT, _SIZE, _U64]),
    "world_reset": ("status", [_HANDLE, _U64]),
    "world_destroy": (None, [_HANDLE]),
    "world_robots": (_INT, [_HANDLE]),
    "world_ticks": ("status", [_HANDLE, c.POINTER(_U64)]),
    "world_advance": ("status", [_HANDLE, _INT, _ARRAY]),
    "world_row": ("status", [_HANDLE, _INT, _INT, _ARRAY]),
    "world_level": ("status", [_HANDLE, _INT, _ARRAY]),
    "world_bed": ("status", [_HANDLE, c.POINTER(Rectangle), c.POINTER(c.c_double)]),
    "world_heights": ("status", [_HANDLE, c.POINTER(Rectangle), _ARRAY]),
    "worlds_create": ("handle", [_TEXT, _SIZE, _ARRAY, _SIZE, _INT]),
    "worlds_destroy": (None, [_HANDLE]),
    "worlds_robots": (_INT, [_HANDLE]),
    "worlds_reset": ("status", [_HANDLE, _ARRAY, _ARRAY, _INT]),
    "worlds_advance": ("status", [_HANDLE, _INT, _ARRAY]),
    "worlds_rows": ("status", [_HANDLE, _INT, _ARRAY]),
    "worlds_level": ("status", [_HANDLE, _INT, _ARRAY]),
}


def _find() -> c.CDLL:
    """The library of SCREED_LIBRARY, the one installed beside the module, that of the system."""
    chosen = os.environ.get("SCREED_LIBRARY")
    if chosen:
        return c.CDLL(chosen)
    for folder in list(pathlib.Path(__file__).resolve().parents)[:5]:
        for file in (folder / "lib" / "libscreed.so.0", folder / "build" / "release" / "libscreed.so.0"):
            if file.exists():
                return c.CDLL(str(file))
    return c.CDLL("libscreed.so.0")


def _wrap(name: str, result, arguments):
    function = getattr(_LIBRARY, "screed_" + name)
    function.argtypes = arguments
    if result not in ("status", "handle", "count"):
        function.restype = result
        return function
    function.argtypes = [*arguments, c.POINTER(_Text)]
    function.restype = {"status": c.c_int, "handle": c.c_void_p, "count": c.c_int64}[result]

    def call(*values):
        error = _Text()
        given = function(*values, c.byref(error))
        failed = given != 0 if result == "status" else not given if result == "handle" else given < 0
        if failed:
            raise _EXCEPTIONS[error.status](error.text.decode(errors="replace"))
        return given

    return call


_LIBRARY = _find()


class _Calls:
    """The functions of the library, without "screed_" before their names."""


for _name, (_result, _arguments) in _FUNCTIONS.items():
    setattr(_Calls, _name, staticmethod(_wrap(_name, _result, _arguments)))
library = _Calls()


class Handle:
    """Owns what the library made and `_free` gives back; also as a context."""

    _handle = None
    _free: str

    def close(self) -> None:
        """What was read stays; nothing can be asked any more."""
        handle, self._handle = self._handle, None
        getattr(library, self._free)(handle)

    def __enter__(self):
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __del__(self):
        if self._handle is not None:
            self.close()


def address(array: np.ndarray | None):
    """Of an array's first element; it must live as long as the call."""
    return None if array is None else array.ctypes.data


def take(given: Bytes) -> bytes:
    """The bytes that the library has made; they are freed."""
    try:
        return c.string_at(given.data, given.size)
    finally:
        library.free(c.byref(given))


def texts(words: list[str]):
    """As the library takes lists of texts: array and length."""
    return (c.c_char_p * len(words))(*[word.encode() for word in words]), len(words)


def dtype_of(table: int) -> np.dtype:
    """Of a table's rows; `metadata` has unit and meaning of each column."""
    kinds = ("u1", "<i2", "<u2", "<i4", "<u4", "<f8")
    fields, about = [], {}
    column = _Column()
    while library.table_column(table, len(fields), c.byref(column)):
        name, kind = column.name.decode(), kinds[column.type]
        fields.append((name, kind, (column.count,)) if column.count else (name, kind))
        about[name] = (column.unit.decode(), column.meaning.decode())
    dtype = np.dtype(fields, metadata=about)
    assert dtype.itemsize == library.table_row(table)
    return dtype
