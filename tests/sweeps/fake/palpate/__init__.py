"""A palpate with a scene of arithmetic alone, so that what a sweep does can be tested at any speed and with
any fault.

The scene is a dict, or a file of one: `radius` (touch is nearer than that to the origin), `pause_s` (a batch
takes so long), `wrong` (a pose with this x is answered wrongly by the engine ref), `crash` (a batch with this
x ends the process), `log` (a file that gets a line for all that goes on)."""
import hashlib
import json
import os
import pathlib
import time

import numpy

__version__ = '0.fake'
__path__.append(str(pathlib.Path(__file__).resolve().parents[4] / 'service/python/palpate'))


class PalpateError(RuntimeError):
    def __init__(self, code, sentence):
        super().__init__(sentence)
        self.code = code

    def __reduce__(self):
        return PalpateError, (self.code, str(self))


class Scene:
    def __init__(self, source, engine='auto'):
        if not isinstance(source, dict):
            try:
                source = json.loads(pathlib.Path(source).read_text())
            except OSError as error:
                raise PalpateError(3, f'{source}: {error.strerror}') from error
        self._open(source, engine)

    def _open(self, source, engine):
        if engine == 'gpu':
            raise PalpateError(4, 'there is no GPU')
        self.source, self.engine = source, 'cpu' if engine == 'auto' else engine
        told = {name: source[name] for name in ('radius', 'wrong') if name in source}
        self.hash = hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:32]
        self._say('scene')

    def __getstate__(self):
        return self.source, {'engine': self.engine}, self.hash

    def __setstate__(self, state):
        self._open(state[0], state[1]['engine'])

    def touches(self, poses):
        self._say('begin')
        time.sleep(self.source.get('pause_s', 0) if len(poses) > 1 else 0)
        if len(poses) > 1 and poses[0, 0] == self.source.get('crash'):
            os._exit(1)
        touch = (poses[:, :3] ** 2).sum(axis=1) + 0.01 * poses[:, 3] < self.source['radius'] ** 2
        if self.engine == 'ref' and 'wrong' in self.source:
            touch ^= poses[:, 0] == self.source['wrong']
        self._say('end')
        return touch

    def clearance(self, poses, within=None):
        distance = numpy.maximum(0, numpy.sqrt((poses[:, :3] ** 2).sum(axis=1)) - self.source['radius'])
        return {
            'distance': distance,
            'on_static': poses[:, :3] * 0.37,
            'engine': numpy.full(len(poses), 2, numpy.uint8),
        }

    def _say(self, what):
        if 'log' in self.source:
            with open(self.source['log'], 'a') as file:
                file.write(f'{os.getpid()} {what} {self.engine}\n')
