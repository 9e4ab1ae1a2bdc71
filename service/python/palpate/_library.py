"""The shared library: where it is, its structs and functions as palpate.h has them, errors as exceptions."""
from __future__ import annotations

import ctypes
import os
import pathlib
import sysconfig
import threading
from typing import Any, Callable, Optional, TypeVar

SONAME = 'libpalpate.so.0'
_Result = TypeVar('_Result')


class PalpateError(RuntimeError):
    """What went wrong, in the sentence of the command line.

    `code` is its exit code: 1 a fault of palpate, 2 a wrong call, 3 a bad value, 4 no usable device; 64:
    cancelled."""

    def __init__(self, code: int, sentence: str) -> None:
        super().__init__(sentence)
        self.code = code

    def __reduce__(self) -> Any:
        return PalpateError, (self.code, str(self))


_PROGRESS = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double)
_NOTE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p)


class Watch(ctypes.Structure):
    _fields_ = [
        ('size', ctypes.c_size_t),
        ('cancel', ctypes.POINTER(ctypes.c_int32)),
        ('progress', _PROGRESS),
        ('note', _NOTE),
        ('context', ctypes.c_void_p),
    ]


def pointers(name: str, columns: tuple[str, ...]) -> type[ctypes.Structure]:
    """A struct of palpate.h that is a size and pointers to columns."""
    fields = [('size', ctypes.c_size_t), *((column, ctypes.c_void_p) for column in columns)]
    return type(name, (ctypes.Structure,), {'_fields_': fields})


def _candidates() -> list[str]:
    if os.environ.get('PALPATE_LIBRARY'):  # a file: nothing else will do
        return [os.environ['PALPATE_LIBRARY']]
    here = pathlib.Path(__file__).parent
    # A wheel has it inside, a build tree in lib beside python, an installed prefix in lib or its folder for
    # this architecture, above lib/python3/dist-packages; and else the loader knows.
    places = [here / SONAME, here.parent.parent / 'lib' / SONAME]
    if here.parent.name == 'dist-packages':
        lib = here.parents[2]
        places += [lib / SONAME, lib / (sysconfig.get_config_var('MULTIARCH') or '') / SONAME]
    return [*(str(place) for place in places if place.is_file()), SONAME]


def _load() -> ctypes.CDLL:
    candidates = _candidates()
    try:
        return ctypes.CDLL(candidates[0])
    except OSError as fault:
        raise ImportError(
            f'{candidates[0]} can\'t be loaded ({fault}); PALPATE_LIBRARY may name the file'
        ) from None


library = _load()
_POINTER, _SIZE, _TEXT, _DOUBLE, _INT = (
    ctypes.c_void_p,
    ctypes.c_size_t,
    ctypes.c_char_p,
    ctypes.c_double,
    ctypes.c_int32,
)
_WATCH, _OUT = ctypes.POINTER(Watch), ctypes.POINTER(ctypes.c_void_p)
# Name: what it returns, what it takes. Those that can fail return a code and take the place for an error
# last.
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    'version': (_TEXT, []),
    'error_sentence': (_TEXT, [_POINTER]),
    'error_free': (None, [_POINTER]),
    'source_new': (_POINTER, []),
    'source_free': (None, [_POINTER]),
    'source_file': (_INT, [_POINTER, _TEXT, _OUT]),
    'source_text': (_INT, [_POINTER, _TEXT, _TEXT, _OUT]),
    'source_mesh': (_INT, [_POINTER, _TEXT, _POINTER, _SIZE, _POINTER, _SIZE, _OUT]),
    'source_engine': (_INT, [_POINTER, _TEXT, _OUT]),
    'source_profile': (_INT, [_POINTER, _TEXT, _OUT]),
    'source_all_samples': (_INT, [_POINTER, _INT, _OUT]),
    'source_cache': (_INT, [_POINTER, _INT, _OUT]),
    'scene_open': (_INT, [_POINTER, _WATCH, _OUT, _OUT]),
    'scene_close': (None, [_POINTER]),
    'scene_engine': (_TEXT, [_POINTER]),
    'scene_hash': (_TEXT, [_POINTER]),
    'scene_description': (_TEXT, [_POINTER]),
    'scene_triangle_count': (_SIZE, [_POINTER, _INT]),
    'scene_triangles': (_INT, [_POINTER, _INT, _POINTER, _OUT]),
    'query': (_INT, [_POINTER, _POINTER, _SIZE, _POINTER, _WATCH, _OUT]),
    'touches': (_INT, [_POINTER, _POINTER, _SIZE, _DOUBLE, _POINTER, _WATCH, _OUT]),
    'clearance': (_INT, [_POINTER, _POINTER, _SIZE, _DOUBLE, _POINTER, _WATCH, _OUT]),
    'first_contact': (_INT, [_POINTER, _POINTER, _POINTER, _SIZE, _DOUBLE, _POINTER, _WATCH, _OUT]),
    'contact_at': (_INT, [_POINTER, _POINTER, _OUT, _OUT]),
    'contact_free': (None, [_POINTER]),
    'contact_list': (ctypes.POINTER(ctypes.c_uint32), [_POINTER, _INT, ctypes.POINTER(_SIZE)]),
    'contact_json': (_TEXT, [_POINTER]),
    'generate': (_INT, [_TEXT, ctypes.c_uint64, ctypes.c_uint64, _TEXT, _OUT]),
}
for _name, (_returns, _takes) in _FUNCTIONS.items():
    _function = getattr(library, 'palpate_' + _name)
    _function.restype, _function.argtypes = _returns, _takes


def call(name: str, *arguments: Any) -> None:
    """Calls a function that can fail, without the interpreter's lock. Raises PalpateError."""
    error = ctypes.c_void_p()
    code = getattr(library, 'palpate_' + name)(*arguments, ctypes.byref(error))
    if code == 0:
        return
    sentence = library.palpate_error_sentence(error).decode()
    library.palpate_error_free(error)
    raise PalpateError(code, sentence)


def text(name: str, *arguments: Any) -> str:
    """Calls a function that gives text."""
    said: bytes = getattr(library, 'palpate_' + name)(*arguments)
    return said.decode()


def obeying(work: Callable[[], _Result], cancel: ctypes.c_int32) -> _Result:
    """Does long work so that Ctrl-C ends it: signals reach the main thread alone, and only between two of its
    own instructions, so there another thread does the work meanwhile. `cancel` is what the work's watch looks
    at."""
    if threading.current_thread() is not threading.main_thread():
        return work()
    results: list[_Result] = []
    faults: list[BaseException] = []
    finished = threading.Event()

    def serve() -> None:
        try:
            results.append(work())
        except BaseException as thrown:  # raised again by the thread that asked
            faults.append(thrown)
        finished.set()

    threading.Thread(target=serve, name='palpate', daemon=True).start()
    try:
        finished.wait()
    except BaseException:
        cancel.value = 1
        while not finished.is_set():  # whatever else comes must wait: the library still writes
            try:
                finished.wait()
            except BaseException:
                continue
        raise
    if faults:
        raise faults[0]
    return results[0]


def watch(
    cancel: ctypes.c_int32,
    progress: Optional[Callable[[str, float], Any]] = None,
    note: Optional[Callable[[str], Any]] = None,
    faults: Optional[list[BaseException]] = None,
) -> Watch:
    """A watch over `cancel`. What the callables raise ends the work and is kept in `faults`; `progress` ends
    it by giving False, too."""
    kept: list[BaseException] = [] if faults is None else faults

    def on_progress(_context: Any, what: bytes, done: float) -> int:
        try:
            return 1 if progress(what.decode(), done) is False else 0  # type: ignore[misc]
        except BaseException as thrown:
            kept.append(thrown)
            return 1

    def on_note(_context: Any, sentence: bytes) -> None:
        try:
            if note is not None:
                note(sentence.decode())
        except BaseException as thrown:
            kept.append(thrown)
            cancel.value = 1

    # The library tells every few poses: nobody is called who has nothing to hear.
    told = _PROGRESS(on_progress) if progress is not None else _PROGRESS(0)  # null
    return Watch(ctypes.sizeof(Watch), ctypes.pointer(cancel), told, _NOTE(on_note), None)
