"""From how many sides can a screwdriver reach a point beside a robot's arm? A map, as a picture.

    accessibility.py arm.ply [link.ply …] [--poses 1e7] [--out map]

A rod, 250 mm long and 12 mm thick, stands with its tip at each point of a plane through the arm and points
into all directions. A point's colour is the part of them in which the rod touches nothing. Meshes are in
metres, z is up. Writes map.zarr, which goes on where it was cut off, and map.png.
"""
import argparse

import matplotlib
import numpy as np

import palpate

matplotlib.use('Agg')
import matplotlib.pyplot as plt

LENGTH, RADIUS = 0.25, 0.006  # m
TILTS, TURNS = 10, 25  # directions: bands from straight up to straight down, and round about


def rod(sides=8):
    """A closed prism along +z, its lower end at the origin: vertices (2 sides + 2, 3), faces (4 sides, 3)."""
    turn = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([RADIUS * np.cos(turn), RADIUS * np.sin(turn), np.zeros(sides)], axis=1)
    vertices = np.concatenate([ring, ring + [0, 0, LENGTH], [[0, 0, 0], [0, 0, LENGTH]]])
    faces = []
    for i in range(sides):
        j, tip, end = (i + 1) % sides, 2 * sides, 2 * sides + 1
        faces += [[i, j, sides + j], [i, sides + j, sides + i], [tip, j, i], [end, sides + i, sides + j]]
    return vertices, np.array(faces)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('meshes', nargs='+')
    parser.add_argument('--poses', type=float, default=1e7)
    parser.add_argument('--out', default='map')
    parser.add_argument('--workers', type=int)
    asked = parser.parse_args()
    scene = palpate.Scene({'static': [{'mesh': mesh} for mesh in asked.meshes], 'tool': {'mesh': rod()}})

    # A plane x, z through y = 0, as much of it as the poses allow at one step in both axes.
    corners = scene.triangles('static').reshape(-1, 3)
    low, high = corners.min(axis=0)[[0, 2]] - 0.15, corners.max(axis=0)[[0, 2]] + 0.15
    step = np.sqrt(np.prod(high - low) * TILTS * TURNS / asked.poses)
    across, up = np.maximum(2, np.round((high - low) / step)).astype(int)
    tilts = (np.arange(TILTS) + 0.5) * 180 / TILTS  # degrees from straight up, the middles of the bands
    grid = palpate.Grid(
        x=(low[0], high[0], int(across)),
        z=(low[1], high[1], int(up)),
        rx=tilts,
        rz=np.arange(TURNS) * 360 / TURNS,
    )
    print(f'{grid.count:,} poses, a point every {1000 * step:.1f} mm')

    done = palpate.sweep(scene, grid, out=f'{asked.out}.zarr', workers=asked.workers)
    print(f'{done.rate:,.0f} poses a second, hash {done.hash}')
    free = ~done.answers('touches')[:].reshape(across, up, TILTS, TURNS)
    # A band of directions counts as much as its part of the sphere.
    band = np.sin(np.radians(tilts))
    share = np.tensordot(free.mean(axis=3), band / band.sum(), axes=1)

    figure, axes = plt.subplots(figsize=(8, 8 * up / across), layout='constrained')
    picture = axes.imshow(
        100 * share.T,
        origin='lower',
        extent=[low[0], high[0], low[1], high[1]],
        cmap='viridis',
        vmin=0,
        vmax=100,
    )
    figure.colorbar(picture, label='directions in which the rod is free, %', shrink=0.6)
    axes.set(
        xlabel='x, m',
        ylabel='z, m',
        title=f'A rod of {1000 * LENGTH:.0f} mm with its tip in the plane y = 0: {grid.count:,} poses',
    )
    figure.savefig(f'{asked.out}.png', dpi=150)


if __name__ == '__main__':  # the sweep's processes read this file, too
    main()
