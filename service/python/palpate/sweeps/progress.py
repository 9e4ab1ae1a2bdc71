# mypy: ignore-errors
"""Says how far a sweep is: one line that stays where it is on a terminal, else a line now and then."""
import sys
import time


class Progress:
    """Prints to `out`; each is told of chunks as they come. `done`: poses that earlier runs left done."""

    def __init__(self, poses, done, out=None):
        self.poses, self.done, self.before = poses, done, done
        self._out = out or sys.stderr
        self._live = self._out.isatty()
        self._began = self._said = time.monotonic()

    def begin(self):
        """The time runs from here on: the workers are there."""
        self._began = time.monotonic()

    @property
    def seconds(self):
        return time.monotonic() - self._began

    @property
    def rate(self):
        """Poses a second of this run."""
        return (self.done - self.before) / max(self.seconds, 1e-9)

    def advance(self, poses):
        self.done += poses
        now = time.monotonic()
        if now - self._said >= (0.5 if self._live else 30):
            self._said = now
            self._print(self.line())

    def line(self):
        left = (self.poses - self.done) / self.rate if self.done > self.before else None
        return (
            f'{self.done:,} of {self.poses:,} poses ({100 * self.done / self.poses:.1f} %),'
            f' {self.rate:,.0f} a second'
            + (f', {_span(left)} left' if left is not None and self.done < self.poses else '')
        )

    def note(self, sentence):
        """A line of its own."""
        if self._live:
            self._out.write('\r\033[K')
        self._out.write(f'palpate-sweep: {sentence}\n')
        self._out.flush()

    def end(self):
        if self._live:
            self._out.write('\r\033[K')
            self._out.flush()

    def _print(self, line):
        self._out.write(f'\r\033[K{line}' if self._live else f'palpate-sweep: {line}\n')
        self._out.flush()


def _span(seconds):
    if seconds < 100:
        return f'{seconds:.0f} s'
    if seconds < 6000:
        return f'{seconds / 60:.0f} min'
    return f'{seconds / 3600:.1f} h'
