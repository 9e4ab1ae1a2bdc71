"""A scene: a tool, a mock-up, and questions about poses of the tool."""
from __future__ import annotations

import copy
import ctypes
import json
import os
import time
from typing import Any, Callable, Iterable, Mapping, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import PalpateError, call, library, obeying, text, watch
from .columns import Columns, Distances, Motions
from .contact import Contact
from .run import Run, run

Progress = Callable[[int, int], Any]
#: Vertices (V, 3) and faces (F, 3), or anything that has `vertices` and `faces`, as a trimesh has.
MeshLike = Any

_UNFELT_SECONDS = 0.1  # without a look at signals (chosen: a hand does not feel it)
_TELL_SECONDS = 0.1  # between two words of progress


class _Handle:
    """The library's scene: closed once nobody uses it any more."""

    def __init__(self, pointer: int) -> None:
        self.pointer = pointer

    def __del__(self, close: Any = library.palpate_scene_close) -> None:
        close(self.pointer)


class Scene:
    """A scene, prepared; asked by any thread. `with Scene(…) as scene:` closes it at the end; so does losing
    the last reference.

    source: path of a scene file; or a dict with its content, in which "mesh" may be (vertices, faces) in
    place of a file's name; or None. tool, static: in place of `source`, a mesh each, or for `static` a list
    of them: (vertices (V, 3), faces (F, 3)), or what has them. units: of these meshes: 'm', 'mm', 'cm' or
    'in'. engine: 'auto' (the quicker of gpu and cpu on a GPU, else cpu), 'gpu', 'cpu' or 'ref'; all give the same answers. profile:
    'refined' or 'paper' in place of the scene's. all_samples: what a tolerance needs. cache: keep what
    preparing worked out. folder: where the files lie that a dict names; the working directory by default.
    progress: called as progress(what, done), done from 0 to 1, by another thread; False ends the opening.
    Raises PalpateError."""

    def __init__(
        self,
        source: Union[str, os.PathLike[str], Mapping[str, Any], None] = None,
        *,
        tool: MeshLike = None,
        static: MeshLike = None,
        units: str = 'm',
        engine: str = 'auto',
        profile: Optional[str] = None,
        all_samples: bool = False,
        cache: bool = True,
        folder: Union[str, os.PathLike[str], None] = None,
        progress: Optional[Callable[[str, float], Any]] = None,
    ) -> None:
        meshes_given = tool is not None or static is not None or units != 'm'
        if source is not None and meshes_given:
            raise PalpateError(2, 'tool, static and units are in place of a source, and there is one')
        if source is None and (tool is None or static is None):
            raise PalpateError(2, 'a scene is a file, a dict, or tool and static')
        if source is None:
            bodies = static if isinstance(static, list) else [static]
            if not bodies:
                raise PalpateError(2, 'static is an empty list: a scene has one mesh or more')
            source = {
                'tool': {'mesh': tool, 'units': units},
                'static': [{'mesh': body, 'units': units} for body in bodies],
            }
        if isinstance(source, Mapping):
            folder = os.path.abspath(folder) if folder is not None else os.getcwd()
            written, meshes = _without_meshes(source)
            self._made_of: dict[str, Any] = {'text': json.dumps(written), 'folder': folder, 'meshes': meshes}
        else:
            self._made_of = {'file': os.path.abspath(source)}
        self._options: dict[str, Any] = {
            'engine': engine,
            'profile': profile,
            'all_samples': all_samples,
            'cache': cache,
        }
        self._open(progress)

    def _open(self, progress: Optional[Callable[[str, float], Any]]) -> None:
        self._rates: dict[str, float] = {}  # poses a second, by question
        #: What a user should know of this scene, a sentence each.
        self.notes: list[str] = []
        source = library.palpate_source_new()
        try:
            _fill(source, self._made_of, self._options)
            out, cancel, faults = ctypes.c_void_p(), ctypes.c_int32(), []  # type: ignore[var-annotated]
            seen = watch(cancel, progress, self.notes.append, faults)
            try:
                obeying(lambda: call('scene_open', source, ctypes.byref(seen), ctypes.byref(out)), cancel)
            except PalpateError:
                if faults:
                    raise faults[0] from None
                raise
        finally:
            library.palpate_source_free(source)
        self._handle: Optional[_Handle] = _Handle(out.value or 0)
        self._description = json.loads(text('scene_description', out))

    # ---- what it is -----------------------------------------------------------------------------------

    @property
    def engine(self) -> str:
        """'gpu', 'cpu' or 'ref': who answers batches."""
        return str(self._description['engine'])

    @property
    def hash(self) -> str:
        """32 hexadecimal digits that stand for all that decides this scene's answers, wherever its files
        lie."""
        return str(self._description['hash'])

    @property
    def description(self) -> dict[str, Any]:
        """Engine, device, profile, start pose, bodies with their parts, plan, memory: docs/LIBRARY.md. A
        copy."""
        return copy.deepcopy(self._description)

    @property
    def start(self) -> NDArray[np.float64]:
        """Where the tool begins: a pose (7,)."""
        return np.array(self._description['start'])

    @property
    def file(self) -> Optional[str]:
        """The scene file, or None."""
        return self._made_of.get('file')

    def triangles(self, body: str = 'static') -> NDArray[np.float64]:
        """Corners of all triangles of 'static' (world, m) or 'tool' (its own frame, m), as the engines see
        them: (T, 3, 3)."""
        number = {'static': 0, 'tool': 1}.get(body)
        if number is None:
            raise PalpateError(2, f"the body is {body!r}; it must be 'static' or 'tool'")
        handle = self._asked()
        corners = np.empty((library.palpate_scene_triangle_count(handle.pointer, number), 3, 3))
        call('scene_triangles', handle.pointer, number, corners.ctypes.data)
        return corners

    def part_of(self, body: str, triangle: int) -> str:
        """Path of the part of 'static' or 'tool' that a triangle belongs to; '' where it is in none."""
        for part in self._description[body]['parts']:
            if part['first_triangle'] <= triangle < part['first_triangle'] + part['triangles']:
                return str(part['path'])
        return ''

    # ---- questions ------------------------------------------------------------------------------------

    def query_batch(
        self,
        poses: ArrayLike,
        columns: Optional[Iterable[str]] = None,
        *,
        out: Optional[Mapping[str, NDArray[Any]]] = None,
        progress: Optional[Progress] = None,
    ) -> Columns:
        """Contact, force and torque at poses (N, 7): x y z (m) qx qy qz qw, world from tool.

        columns: names of those that are wanted (palpate.COLUMNS); all by default. Without force, torque, tool
        and evaluations it takes a fraction of the time. out: arrays of these names to write into. progress:
        called as progress(done, all) about ten times a second; False ends it. Raises PalpateError; a batch
        that was ended leaves nothing of use."""
        asked, shape = _poses(poses)
        found = Columns(shape, columns, out)
        self._answer(
            'query',
            len(asked),
            progress,
            lambda handle, first, count, eye: call(
                'query', handle, _row(asked, first), count, ctypes.byref(found._at(first)), eye
            ),
        )
        return found

    def touches(
        self, poses: ArrayLike, tolerance: float = 0.0, *, progress: Optional[Progress] = None
    ) -> NDArray[np.bool_]:
        """Whether tool and mock-up touch, containment included: bool (N,) for poses (N, 7).

        tolerance (m): contact no deeper does not count; above 0 the scene must have been opened with
        all_samples=True."""
        asked, shape = _poses(poses)
        found = np.empty(shape, np.bool_)
        self._answer(
            'touches',
            len(asked),
            progress,
            lambda handle, first, count, eye: call(
                'touches', handle, _row(asked, first), count, tolerance, found.ctypes.data + first, eye
            ),
        )
        return found

    def clearance(
        self, poses: ArrayLike, within: Optional[float] = None, *, progress: Optional[Progress] = None
    ) -> Distances:
        """The exact smallest distance at poses (N, 7), where, and between which triangles.

        within (m): what is further is inf; None: what the lattice reaches, description['reach'] from
        description['origin'] along each axis, about as far as the scene is large. Poses with a vertex of the
        tool beyond that are inf, too."""
        asked, shape = _poses(poses)
        found = Distances(shape)
        reach = float('inf') if within is None else within
        self._answer(
            'clearance',
            len(asked),
            progress,
            lambda handle, first, count, eye: call(
                'clearance', handle, _row(asked, first), count, reach, ctypes.byref(found._at(first)), eye
            ),
        )
        return found

    def first_contact(
        self,
        start: ArrayLike,
        goal: ArrayLike,
        tolerance: float = 0.0,
        *,
        progress: Optional[Progress] = None,
    ) -> Motions:
        """When a tool that moves on the screw from `start` to `goal` first touches; never late. Poses (7,) or
        (N, 7) either."""
        (first_poses, begins), (last_poses, ends) = _poses(start), _poses(goal)
        try:
            shape = np.broadcast_shapes(begins, ends)
        except ValueError:
            raise PalpateError(
                2, f'starts of the shape {begins} and goals of the shape {ends} do not go together'
            ) from None
        begin = np.broadcast_to(first_poses.reshape(*begins, 7), (*shape, 7))
        end = np.broadcast_to(last_poses.reshape(*ends, 7), (*shape, 7))
        (first_poses, _), (last_poses, _) = _poses(begin), _poses(end)
        found = Motions(shape)
        self._answer(
            'first_contact',
            len(first_poses),
            progress,
            lambda handle, first, count, eye: call(
                'first_contact',
                handle,
                _row(first_poses, first),
                _row(last_poses, first),
                count,
                tolerance,
                ctypes.byref(found._at(first)),
                eye,
            ),
        )
        return found

    def wrench(self, pose: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Force (3,; N) and torque (3,; N·m, about the tool's centre of mass) on the tool at one pose, world
        axes."""
        found = self.query_batch(pose, ('force', 'torque'))
        return found.force, found.torque

    def query(self, pose: ArrayLike) -> Contact:
        """All that is known of one pose: lists of triangles, parts, areas, force and torque."""
        asked, _ = _poses(pose)
        if len(asked) != 1:
            raise PalpateError(2, f'query is for one pose and got {len(asked)}; query_batch is for many')
        handle, out = self._asked(), ctypes.c_void_p()
        call('contact_at', handle.pointer, asked.ctypes.data, ctypes.byref(out))
        try:
            return Contact(json.loads(text('contact_json', out)))
        finally:
            library.palpate_contact_free(out)

    def run(
        self,
        out: Union[str, os.PathLike[str]],
        *,
        pace: str = 'asap',
        device: Optional[str] = None,
        duration: Optional[float] = None,
        overwrite: bool = False,
    ) -> Run:
        """Lets the program do the scene's whole task, as `palpate run` does, and gives what it left in the
        folder `out`.

        pace: 'asap' or 'real'. device: in place of the scene's. duration: s; the whole path by default. The
        scene must be one of a file."""
        if self.file is None:
            raise PalpateError(2, 'a run needs a scene of a file: its device and path stand there')
        return run(self.file, out, self._options['engine'], pace, device, duration, overwrite)

    # ---- how ------------------------------------------------------------------------------------------

    def close(self) -> None:
        """Gives its memory back once no call is under way. What is asked afterwards is refused."""
        self._handle = None

    def __enter__(self) -> 'Scene':
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        bodies = self._description
        return (
            f"<palpate.Scene {self.hash[:8]}: mock-up of {bodies['static']['triangles']} triangles, tool of "
            f"{bodies['tool']['triangles']}, engine {self.engine}>"
        )

    def __getstate__(self) -> Any:
        return self._made_of, self._options, self.hash

    def __setstate__(self, state: Any) -> None:
        """Opens the scene again, where the pickle is read. Raises PalpateError where its files have another
        content there."""
        self._made_of, self._options, wanted = state
        self._open(None)
        if self.hash != wanted:
            raise PalpateError(
                3,
                (
                    f'{self.file or "the scene"} has changed since it was pickled: its hash is'
                    f' {self.hash} instead of {wanted}'
                ),
            )

    def _asked(self) -> _Handle:
        handle = self._handle
        if handle is None:
            raise PalpateError(2, 'the scene is closed')
        return handle

    def _answer(
        self,
        question: str,
        count: int,
        progress: Optional[Progress],
        ask: Callable[[int, int, int, Any], None],
    ) -> None:
        """Asks `count` poses. What takes longer than a hand feels is asked beside this thread, which then sees
        signals."""
        handle = self._asked()  # it lives as long as this call
        rate, first = self._rates.get(question), 0
        if rate is None or count <= rate * _UNFELT_SECONDS:
            first = 1 if rate is None else count  # one pose tells how long the others take
            begin = time.perf_counter()
            ask(handle.pointer, 0, min(first, count), None)
            self._learn(question, min(first, count), time.perf_counter() - begin)
        if first < count:
            self._answer_long(handle, question, first, count, progress, ask)
        if progress is not None and progress(count, count) is False:
            raise PalpateError(64, f'cancelled after {count} of {count}')

    def _answer_long(
        self,
        handle: _Handle,
        question: str,
        first: int,
        count: int,
        progress: Optional[Progress],
        ask: Callable[[int, int, int, Any], None],
    ) -> None:
        cancel, faults = ctypes.c_int32(), []  # type: ignore[var-annotated]
        begin = told = time.perf_counter()

        def tell(_what: str, done: float) -> Any:
            nonlocal told
            now = time.perf_counter()
            if progress is None or now - told < _TELL_SECONDS:
                return True
            told = now
            return progress(first + int(done * (count - first)), count)

        seen = watch(cancel, tell if progress is not None else None, None, faults)
        try:
            obeying(lambda: ask(handle.pointer, first, count - first, ctypes.byref(seen)), cancel)
        except PalpateError:
            if faults:
                raise faults[0] from None
            raise
        self._learn(question, count - first, time.perf_counter() - begin)

    def _learn(self, question: str, count: int, seconds: float) -> None:
        """How many poses a second; a short piece says little of how long a long one takes."""
        if count > 0:
            rate = count / max(seconds, 1e-6)
            self._rates[question] = (
                rate if seconds >= _UNFELT_SECONDS else min(rate, 8 * count / _UNFELT_SECONDS)
            )


def _row(poses: NDArray[np.float64], first: int) -> int:
    return int(poses.ctypes.data) + 56 * first


def _poses(poses: ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Poses as the library wants them, (N, 7) without gaps, and the shape of the answers."""
    array = np.ascontiguousarray(poses, np.float64)
    if array.ndim == 0 or array.shape[-1] != 7:
        raise PalpateError(2, f'poses have the shape {array.shape}; (N, 7) is wanted: x y z qx qy qz qw')
    return array.reshape(-1, 7), array.shape[:-1]


def _mesh(mesh: MeshLike) -> Optional[tuple[NDArray[np.float64], NDArray[np.uint32]]]:
    """(vertices, faces) of a mesh in memory; None: a file's name."""
    if isinstance(mesh, (str, bytes)) or mesh is None:
        return None
    try:
        vertices, faces = (
            (mesh.vertices, mesh.faces) if hasattr(mesh, 'vertices') and hasattr(mesh, 'faces') else mesh
        )
        # Copies: who hands them over may go on with them.
        corners, indices = np.array(vertices, np.float64, order='C'), np.asarray(faces)
    except (TypeError, ValueError):
        raise PalpateError(
            3, f'a mesh is a file, or vertices (V, 3) and faces (F, 3); this one is a {type(mesh).__name__}'
        ) from None
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise PalpateError(3, f'the vertices of a mesh have the shape {corners.shape}; (V, 3) is wanted')
    if indices.ndim != 2 or indices.shape[1] != 3 or not np.issubdtype(indices.dtype, np.integer):
        raise PalpateError(
            3,
            (
                f'the faces of a mesh are {indices.dtype} of the shape {indices.shape}; whole numbers (F, 3)'
                ' are wanted'
            ),
        )
    if indices.size and (indices.min() < 0 or indices.max() >= len(corners)):
        raise PalpateError(
            3,
            (
                f'a face of a mesh has the index {indices.max() if indices.min() >= 0 else indices.min()}; '
                f'there are {len(corners)} vertices'
            ),
        )
    return corners, np.array(indices, np.uint32, order='C')


def _without_meshes(
    scene: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, tuple[NDArray[np.float64], NDArray[np.uint32]]]]:
    """The scene with a name in place of each mesh in memory, and these."""
    meshes: dict[str, tuple[NDArray[np.float64], NDArray[np.uint32]]] = {}

    def named(body: Any, name: str) -> Any:
        if not isinstance(body, Mapping) or 'mesh' not in body:
            return body
        mesh = _mesh(body['mesh'])
        if mesh is None:
            return dict(body)
        meshes[name] = mesh
        return {**body, 'mesh': name}

    out = dict(scene)
    if 'tool' in out:
        out['tool'] = named(out['tool'], 'tool')
    if isinstance(out.get('static'), (list, tuple)):
        out['static'] = [named(body, f'static {i}') for i, body in enumerate(out['static'])]
    return out, meshes


def _fill(source: int, made_of: Mapping[str, Any], options: Mapping[str, Any]) -> None:
    if 'file' in made_of:
        call('source_file', source, os.fsencode(made_of['file']))
    else:
        call('source_text', source, made_of['text'].encode(), os.fsencode(made_of['folder']))
        for name, (vertices, faces) in made_of['meshes'].items():
            call(
                'source_mesh',
                source,
                name.encode(),
                vertices.ctypes.data,
                len(vertices),
                faces.ctypes.data,
                len(faces),
            )
    call('source_engine', source, options['engine'].encode())
    if options['profile'] is not None:
        call('source_profile', source, options['profile'].encode())
    call('source_all_samples', source, int(options['all_samples']))
    call('source_cache', source, int(options['cache']))
