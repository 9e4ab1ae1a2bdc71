# mypy: ignore-errors
"""The questions that a sweep asks of a scene, and the other engine that is asked again."""
import functools

import numpy

from .words import refuse

ASKS = ('touches', 'clearance', 'query')
ENGINES = ('auto', 'gpu', 'cpu', 'ref')


def answer(scene, ask, within, poses):
    """The scene's answers to `ask` at poses (N, 7): {column: array (N, …)}. `within`: metres, for clearance
    alone."""
    if ask == 'touches':
        return {'touches': numpy.asarray(scene.touches(poses), dtype=bool)}
    columns = scene.clearance(poses, within=within) if ask == 'clearance' else scene.query_batch(poses)
    # Who answered a pose is no part of the answer.
    return {name: numpy.asarray(values) for name, values in columns.items() if name != 'engine'}


def first_difference(ones, others):
    """Row and column of the first answer that isn't the same bits in both, or None."""
    found = None
    for name in sorted(ones):
        one, other = (numpy.ascontiguousarray(each[name]) for each in (ones, others))
        rows = (
            one.view(numpy.uint8).reshape(len(one), -1) != other.view(numpy.uint8).reshape(len(other), -1)
        ).any(axis=1)
        if rows.any() and (found is None or rows.argmax() < found[0]):
            found = int(rows.argmax()), name
    return found


def second_engine(first, wish):
    """The engine that checks `first`: the one wished for; with 'auto' ref beside cpu, and cpu beside the
    others."""
    if wish == first:
        refuse(f'the {first} engine answers; asking it again would compare it with itself')
    return wish if wish != 'auto' else 'ref' if first == 'cpu' else 'cpu'


def maker(scene):
    """make(engine=…) gives the same scene by an engine. It travels; the scene, which is heavy, does not."""
    return functools.partial(_made, type(scene), scene.__getstate__())


def _made(kind, state, engine):
    made_of, options, wanted = state
    scene = kind.__new__(kind)
    # Opens it, and holds it against the hash wanted.
    scene.__setstate__((made_of, {**options, 'engine': engine}, wanted))
    return scene
