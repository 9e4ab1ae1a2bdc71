# mypy: ignore-errors
"""Hashes of poses and of answers. They are of numbers, not of files: compression and machine leave them as
they are."""
import hashlib
import json

import numpy


def of_array(values):
    return hashlib.sha256(_bytes(values)).hexdigest()


def of_columns(columns):
    """Of columns {name: array}, in the order of their names, with types and shapes."""
    digest = hashlib.sha256()
    for name in sorted(columns):
        values = columns[name]
        digest.update(f'{name} {values.dtype.newbyteorder("<").str} {values.shape};'.encode())
        digest.update(_bytes(values))
    return digest.hexdigest()


def of_sweep(question, records):
    """Of a whole sweep: what was asked, and all chunks' poses and answers in the order of their numbers.
    Neither engine nor version nor who did what is in it."""
    digest = hashlib.sha256(json.dumps(question, sort_keys=True).encode())
    for record in records:
        digest.update('{chunk} {start} {poses} {posed} {answers};'.format(**record).encode())
    return digest.hexdigest()


def _bytes(values):
    return numpy.ascontiguousarray(values, dtype=values.dtype.newbyteorder('<')).view(numpy.uint8).data
