"""A simulator of one's own in some thirty lines: a cube falls onto a plate; palpate says what pushes it."""
import numpy as np

import palpate


def box(half):
    x, y, z = half
    vertices = [[i, j, k] for k in (-z, z) for i, j in ((-x, -y), (x, -y), (x, y), (-x, y))]
    faces = '021 032 456 467 015 054 126 165 237 276 304 347'.split()
    return np.array(vertices), [[int(corner) for corner in face] for face in faces]


def times(a, b):  # product of quaternions x y z w
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])


EDGE, MASS, STEP = 0.02, 0.1, 1e-3  # m, kg, s
INERTIA, WEIGHT = MASS * EDGE**2 / 6, np.array([0, 0, -9.81 * MASS])  # of a cube, the same about every axis
scene = palpate.Scene(tool=box([EDGE / 2] * 3), static=box([0.1, 0.1, 0.01]))
pose = np.array([0, 0, 0.03, *np.array([0.1, 0.2, 0, 1]) / np.sqrt(1.05)])  # 10 mm off the plate, tilted
speed, spin = np.zeros(3), np.zeros(3)
for tick in range(600):
    # N, N·m about the centre of mass: a field behind a spring, so it stores no energy.
    force, torque = scene.wrench(pose)
    # Of the contact, N·s/m; about the centre with the square of half an edge.
    damping = 4.0 if force.any() else 0.0
    speed += STEP * (force + WEIGHT - damping * speed) / MASS
    spin += STEP * (torque - damping * (EDGE / 2) ** 2 * spin) / INERTIA
    pose[:3] += STEP * speed
    pose[3:] += STEP / 2 * times(np.append(spin, 0), pose[3:])
    pose[3:] /= np.linalg.norm(pose[3:])
    if tick % 100 == 0:
        rates = f'speed {np.linalg.norm(speed):.3f} m/s  force {np.linalg.norm(force):.3f} N'
        print(f'{tick * STEP:.1f} s  height {1000 * pose[2]:6.2f} mm  {rates}')
