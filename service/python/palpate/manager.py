"""A manager with the methods of trimesh.collision.CollisionManager that ask one moving mesh, or one rigid
group, against many."""
from __future__ import annotations

import hashlib
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import PalpateError
from .columns import NO_TRIANGLE
from .contact import Contact
from .poses import matrix_of_pose, pose_of_matrix
from .scene import MeshLike, Scene, _mesh

_IDENTITY = np.array([0, 0, 0, 0, 0, 0, 1.0])


class CollisionManager:
    """Named meshes in the world, and questions of a mesh that moves among them. Unlike FCL a mesh has an
    inside: what lies wholly in another touches it. The first question of a mesh prepares a scene; further
    ones, at other transforms, take microseconds.

    engine: as for Scene. Meshes: (vertices (V, 3), faces (F, 3)) in m, or what has `vertices` and `faces`, as
    a trimesh has."""

    _kept = 8  # scenes (chosen: a gripper's parts)

    def __init__(self, engine: str = 'auto') -> None:
        self._engine = engine
        self._objects: dict[str, tuple[Any, NDArray[np.float64]]] = {}
        self._scenes: dict[str, Scene] = {}

    def add_object(self, name: str, mesh: MeshLike, transform: Optional[ArrayLike] = None) -> None:
        """Puts a mesh into the world at a matrix (4, 4); a name that is there already is replaced."""
        self._objects[name] = (_arrays(mesh), _pose(transform))
        self._scenes.clear()

    def remove_object(self, name: str) -> None:
        """Takes a mesh out. Raises PalpateError where there is none of that name."""
        self._named(name)
        del self._objects[name]
        self._scenes.clear()

    def set_transform(self, name: str, transform: ArrayLike) -> None:
        """Moves a mesh of the world, for which the next question prepares anew: what moves often is better
        asked as the single mesh."""
        self._objects[name] = (self._named(name)[0], _pose(transform))
        self._scenes.clear()

    def in_collision_single(
        self,
        mesh: MeshLike,
        transform: Optional[ArrayLike] = None,
        return_names: bool = False,
        return_data: bool = False,
    ) -> Any:
        """Whether a mesh at a matrix touches any; with the set of their names and the Contact where
        wanted."""
        scene, pose = self._scene(_arrays(mesh)), _pose(transform)
        if not (return_names or return_data):
            return bool(scene.touches(pose))
        found: Contact = scene.query(pose)
        names = {name for part in found.static_parts for name in [self._name_of(part)]}
        return tuple([found.contact] + [names] * return_names + [found] * return_data)

    def min_distance_single(
        self,
        mesh: MeshLike,
        transform: Optional[ArrayLike] = None,
        return_name: bool = False,
        return_data: bool = False,
    ) -> Any:
        """The smallest distance (m) of a mesh at a matrix, 0 where it touches; with the name of the nearest,
        or of one that it touches, and the Distances. inf and None where it is farther away than the scene
        reaches, about as far as the meshes of the world and it are large (Scene.clearance)."""
        scene, pose = self._scene(_arrays(mesh)), _pose(transform)
        found = scene.clearance(pose)
        nearest = None
        if found.static_id != NO_TRIANGLE:
            nearest = self._name_of(scene.part_of('static', int(found.static_id)))
        elif return_name and found.distance == 0:
            nearest = min((self._name_of(part) for part in scene.query(pose).static_parts), default=None)
        return (
            tuple([float(found.distance)] + [nearest] * return_name + [found] * return_data)
            if return_name or return_data
            else float(found.distance)
        )

    def in_collision_other(self, other: 'CollisionManager', return_names: bool = False) -> Any:
        """Whether anything here touches anything of another manager; with the set of pairs of names where
        wanted."""
        if not return_names:
            return self.in_collision_single(other._joined())
        pairs = {
            (mine, theirs)
            for theirs, (mesh, pose) in other._objects.items()
            for mine in self.in_collision_single(mesh, matrix_of_pose(pose), return_names=True)[1]
        }
        return bool(pairs), pairs

    def min_distance_other(self, other: 'CollisionManager') -> float:
        """The smallest distance (m) between anything here and anything of another manager; inf as of
        min_distance_single()."""
        return float(self.min_distance_single(other._joined()))

    def _named(self, name: str) -> Any:
        if name not in self._objects:
            raise PalpateError(2, f'there is no object {name!r}')
        return self._objects[name]

    def _name_of(self, part: str) -> str:
        return list(self._objects)[int(part.split('/')[0].removeprefix('static '))]

    def _joined(self) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
        corners, faces, before = [], [], 0
        for (vertices, indices), pose in self._objects.values():
            matrix = matrix_of_pose(pose)
            corners.append(vertices @ matrix[:3, :3].T + matrix[:3, 3])
            faces.append(indices + np.uint32(before))
            before += len(vertices)
        if not corners:
            raise PalpateError(2, 'a manager without objects can\'t be asked')
        return np.concatenate(corners), np.concatenate(faces)

    def _scene(self, tool: tuple[NDArray[np.float64], NDArray[np.uint32]]) -> Scene:
        if not self._objects:
            raise PalpateError(2, 'a manager without objects can\'t be asked')
        key = hashlib.blake2b(tool[0].tobytes() + tool[1].tobytes()).hexdigest()
        scene = self._scenes.pop(key, None) or Scene(
            {
                'tool': {'mesh': tool},
                'static': [
                    {'mesh': mesh, 'position': pose[:3].tolist(), 'rotation': pose[3:].tolist()}
                    for mesh, pose in self._objects.values()
                ],
            },
            engine=self._engine,
        )
        self._scenes[key] = scene  # the one used last
        while len(self._scenes) > self._kept:
            del self._scenes[next(iter(self._scenes))]
        return scene


def _arrays(mesh: MeshLike) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    arrays = _mesh(mesh)
    if arrays is None:
        raise PalpateError(2, 'a mesh must be (vertices, faces), or have them')
    return arrays


def _pose(transform: Optional[ArrayLike]) -> NDArray[np.float64]:
    return _IDENTITY if transform is None else pose_of_matrix(transform)
