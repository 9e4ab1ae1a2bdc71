# mypy: ignore-errors
"""A sweep's poses cut into chunks, and which of them two engines answer."""
import hashlib
import math

# Long enough that a scheduler has little to do, short enough that a lost one costs seconds (chosen).
SIZE = 1 << 16
MOST_OF_A_CHUNK = 1 << 24  # poses; a chunk's column is compressed as one piece below 2 GiB
MOST_CHUNKS = 10**7  # each has a file for its marker (chosen)


class Chunks:
    """`count` chunks of `size` poses, the last of what is left."""

    def __init__(self, poses, size=SIZE):
        self.poses, self.size = poses, size
        self.count = -(-poses // size)

    def span(self, number):
        """First pose of chunk `number`, and how many."""
        start = number * self.size
        return start, min(self.size, self.poses - start)

    def asked_twice(self, share):
        """The numbers of the chunks that a second engine answers too: those with the smallest hashes, at
        least one unless `share` is 0. They depend on nothing but the count of chunks, so that a sweep that
        goes on asks the same ones."""
        wanted = min(self.count, math.ceil(self.count * share))
        return frozenset(sorted(range(self.count), key=_lot)[:wanted])


def _lot(number):
    return hashlib.sha256(b'chunk %d' % number).digest()
