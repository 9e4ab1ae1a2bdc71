# mypy: ignore-errors
"""The command palpate-sweep."""
import argparse
import importlib
import os
import sys
import time

import numpy


def main(arguments=None):
    """Returns the exit code: 0 done, 1 a fault, 2 wrong usage, 3 a bad value or no room, 130 interrupted."""
    parser = _parser()
    asked = parser.parse_args(arguments)
    from palpate import PalpateError

    from .run import sweep

    try:
        client, connect = _client(asked)
        poses, count = _poses(parser, asked)
        swept = sweep(
            asked.scene,
            poses,
            out=asked.out,
            count=count,
            client=client,
            ask=asked.ask,
            within=asked.within,
            engine=asked.engine,
            again=asked.again,
            share=asked.share,
            again_poses=asked.again_poses,
            workers=asked.workers,
            size=asked.size,
            quiet=asked.quiet,
            connect=connect,
        )
    except PalpateError as error:
        print(f'palpate-sweep: {error}', file=sys.stderr)
        return getattr(error, 'code', 0) or 3
    except KeyboardInterrupt:
        print('palpate-sweep: stopped; the same command goes on from what is done', file=sys.stderr)
        return 130
    chunks = 'chunk' if swept.chunks == 1 else 'chunks'
    rate = 'nothing was left to ask' if swept.earlier == swept.chunks else f'{swept.rate:,.0f} poses a second'
    print(
        f'{swept.path}: {swept.poses:,} poses in {swept.chunks:,} {chunks}, {swept.earlier:,} of them from'
        f' before, {swept.twice:,} answered by two engines; {rate}\nhash'
        f' {swept.hash}'
    )
    return 0


def _parser():
    parser = argparse.ArgumentParser(
        'palpate-sweep',
        description=(
            'Asks a scene at very many poses and keeps the answers in a Zarr '
            'group. Cut short, the same command goes on from what is done. docs/SWEEPS.md'
        ),
    )
    parser.add_argument('scene', help='scene file')
    parser.add_argument('--out', required=True, metavar='OUT.zarr')
    parser.add_argument('--ask', choices=('touches', 'clearance', 'query'), default='touches')
    parser.add_argument(
        '--within', type=float, metavar='METRES', help='clearance: what is further is not measured'
    )
    grid = parser.add_argument_group(
        'poses on a grid', 'each axis a number, FIRST:LAST:COUNT with both ends, or A,B,C,…'
    )
    for name in ('x', 'y', 'z'):
        grid.add_argument(f'--{name}', type=_axis, metavar='METRES')
    for name in ('rx', 'ry', 'rz'):
        grid.add_argument(f'--{name}', type=_axis, metavar='DEGREES')
    other = parser.add_argument_group('other poses')
    other.add_argument('--poses', metavar='FILE.npy', help='float64 (N, 7): x y z qx qy qz qw')
    other.add_argument('--function', metavar='MODULE:NAME', help='function(start, n) -> float64 (n, 7)')
    other.add_argument('--count', type=int, help="the function's poses")
    parser.add_argument('--engine', choices=('auto', 'gpu', 'cpu', 'ref'), default='auto')
    parser.add_argument(
        '--again', choices=('auto', 'gpu', 'cpu', 'ref'), default='auto', help='the engine that checks'
    )
    parser.add_argument('--share', type=float, default=0.01, help='part of the chunks that it checks (0.01)')
    parser.add_argument(
        '--again-poses', type=int, default=1024, help='poses of such a chunk, evenly spread (1024)'
    )
    parser.add_argument('--size', type=int, default=1 << 16, help='poses in a chunk (65536)')
    parser.add_argument('--workers', type=int, help='processes on this machine')
    parser.add_argument(
        '--scheduler',
        metavar='ADDRESS',
        help="of a Dask cluster, tcp://…:8786, in place of this machine's processes",
    )
    parser.add_argument(
        '--scheduler-file', metavar='FILE', help='the same, by the file that the scheduler writes'
    )
    parser.add_argument('--quiet', action='store_true')
    return parser


def _axis(text):
    try:
        if ':' in text:
            first, last, count = text.split(':')
            return float(first), float(last), int(count)
        return [float(value) for value in text.split(',')]
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is no number, FIRST:LAST:COUNT or list of numbers"
        ) from None


def _poses(parser, asked):
    from .poses import Grid
    from .words import refuse

    axes = {name: value for name in Grid.NAMES if (value := getattr(asked, name)) is not None}
    if sum((bool(axes), asked.poses is not None, asked.function is not None)) != 1:
        parser.error('say which poses by one of axes (--x …), --poses and --function')
    if axes:
        return Grid(**axes), None
    if asked.poses is not None:
        try:
            return numpy.load(asked.poses, mmap_mode='r', allow_pickle=False), None
        except (OSError, ValueError) as error:
            refuse(f'{asked.poses} is no array file that can be read: {error}')
    module, _, name = asked.function.partition(':')
    sys.path.insert(0, os.getcwd())
    try:
        return getattr(importlib.import_module(module), name), asked.count
    except (ImportError, AttributeError) as error:
        refuse(f'{asked.function} names no function: {error}')


def _client(asked):
    if asked.scheduler is None and asked.scheduler_file is None:
        return None, None
    from distributed import Client

    from .drive import PATIENCE_S
    from .words import refuse

    def connect():
        # Dask would wait for a file without an end.
        if asked.scheduler_file is not None and not os.path.exists(asked.scheduler_file):
            raise FileNotFoundError('there is no such file')
        return Client(asked.scheduler, scheduler_file=asked.scheduler_file)

    if asked.scheduler_file is not None and not os.path.exists(asked.scheduler_file):
        print(f'palpate-sweep: waiting for {asked.scheduler_file}', file=sys.stderr)
        end = time.monotonic() + PATIENCE_S
        while not os.path.exists(asked.scheduler_file) and time.monotonic() < end:
            time.sleep(0.2)
    try:
        return connect(), connect
    except (OSError, ValueError) as error:
        refuse(f'no scheduler at {asked.scheduler or asked.scheduler_file}: {error}')
