# mypy: ignore-errors
"""A sweep's results on disk: a Zarr group with a column an array, and a marker for each chunk that is done.

    OUT.zarr/.zattrs          what was asked, by whom; in the end the sweep's hash
    OUT.zarr/COLUMN/NUMBER    a chunk's answers: a chunk of the sweep is a chunk of the array, so nobody shares a file
    OUT.zarr/poses/NUMBER     its poses, where they came as an array
    OUT.zarr/.sweep/NUMBER    its marker, made after all its data is on the disk, by one rename

A chunk without a marker is asked again, whatever there is of it. The same chunk written twice has the same
bytes. """
import contextlib
import errno
import fcntl
import json
import os
import pathlib
import uuid

import numpy
import zarr

from . import digest
from .words import refuse

MARKERS = '.sweep'


class Full(Exception):
    """The disk has no room left; its words are a sentence."""


class _Durable(zarr.DirectoryStore):
    """Zarr's folder of files, each on the disk before it gets its name."""

    @staticmethod
    def _tofile(a, fn):
        with open(fn, 'wb') as file:
            file.write(a)
            file.flush()
            os.fsync(file.fileno())


class Store:
    """The results in folder `path`. Workers and the driver each open one of their own."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self._group = None

    @property
    def group(self):
        if self._group is None:
            self._group = zarr.open_group(_Durable(str(self.path)), mode='r+')
        return self._group

    @contextlib.contextmanager
    def mine(self):
        """Makes the folder where there is none, and lets nobody else's sweep go on in it meanwhile."""
        if self.path.exists() and not self.path.is_dir():
            refuse(f'{self.path} is a file; a sweep needs a folder')
        if self.path.exists() and any(self.path.iterdir()) and not (self.path / MARKERS).is_dir():
            refuse(f'{self.path} is there and is no sweep; name another folder or remove it')
        try:
            with self._room():
                (self.path / MARKERS).mkdir(parents=True, exist_ok=True)
                lock = open(self.path / MARKERS / 'lock', 'w')
        except OSError as error:
            refuse(f"{self.path}: a sweep can't write there ({error.strerror})")
        with lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                refuse(f'{self.path}: another sweep is writing here')
            yield

    def begin(self, question, about, columns, chunks, rows):
        """Sets the arrays up, or goes on with those that the same question was asked of. Within mine().

        question : what the answers depend on. about : what else is worth knowing. columns : {name: array of
        one answer or more}, for their types. rows : poses (N, 7) that the store keeps for the workers, or
        None."""
        with self._room():
            root = _Durable(str(self.path))
            if not (self.path / '.zgroup').exists():
                zarr.open_group(root, mode='a')
            self._group = zarr.open_group(root, mode='r+')
            found = self._group.attrs.asdict()
            for key, value in question.items():
                if 'question' in found and found['question'].get(key) != value:
                    what, its, ours = _differing(key, found['question'].get(key), value)
                    refuse(
                        f'{self.path} holds another sweep: its {what} is {_short(its)},'
                        f' this one\'s is {_short(ours)}; name another folder'
                    )
            if 'question' not in found:
                kept = {'poses': rows[:1].astype(numpy.float64)} if rows is not None else {}
                for name, values in {**columns, **kept}.items():
                    self._group.create_dataset(
                        name,
                        shape=(chunks.poses, *values.shape[1:]),
                        chunks=(chunks.size, *values.shape[1:]),
                        dtype=values.dtype,
                        overwrite=True,
                    )
                for number in range(chunks.count) if rows is not None else ():
                    start, n = chunks.span(number)
                    self._group['poses'][start : start + n] = rows[start : start + n]
                # Last, so that a folder whose making was cut short is made again.
                self._group.attrs.update({'question': question, **about})

    def write(self, record, columns):
        """Puts a chunk's answers on the disk, then its marker. Full: there is no room, and no marker."""
        start, n = record['start'], record['poses']
        with self._room():
            for name, values in columns.items():
                self.group[name][start : start + n] = values
            self._file(f'{MARKERS}/{record["chunk"]}', json.dumps(record))

    def done(self):
        """{number: record} of the chunks that are done."""
        return {
            int(file.name): json.loads(file.read_text())
            for file in (self.path / MARKERS).iterdir()
            if file.name.isdigit()
        }

    def faulty(self, records, columns):
        """The numbers of the chunks whose answers are not what their markers say; their markers are gone
        after this."""
        wrong = []
        for record in records:
            span = slice(record['start'], record['start'] + record['poses'])
            try:
                same = (
                    digest.of_columns({name: self.group[name][span] for name in columns}) == record['answers']
                )
            except (ValueError, RuntimeError, OSError):  # what can't be decoded
                same = False
            if not same:
                (self.path / MARKERS / str(record['chunk'])).unlink()
                wrong.append(record['chunk'])
        return wrong

    def finish(self, **results):
        """Writes the results among the attributes and clears away what killed workers left half written."""
        with self._room():
            self.group.attrs.update(results)
        for left in self.path.rglob('*.partial'):
            left.unlink(missing_ok=True)

    def _file(self, name, text):
        path = self.path / name
        part = path.with_name(f'{path.name}.{uuid.uuid4().hex}.partial')
        try:
            with open(part, 'w') as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)

    @contextlib.contextmanager
    def _room(self):
        try:
            yield
        except OSError as error:
            # EFBIG: a limit on a file's size (ulimit -f), which is no room either.
            if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
                raise Full(f'{self.path}: no room to write ({error.strerror})') from error
            raise


def _differing(name, one, other):
    """The first part of two values that differs, by its name."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted({*one, *other}):
            if one.get(key) != other.get(key):
                return _differing(f'{name} {key}', one.get(key), other.get(key))
    return name, one, other


def _short(value):
    text = json.dumps(value)
    return text if len(text) <= 90 else text[:90] + ' …'
