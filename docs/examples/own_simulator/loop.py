"""A simulator of one's own in some thirty lines: a cube falls onto a plate and comes to rest; palpate says what pushes it."""
import numpy as np

import palpate


def box(half):
    x, y, z = half
    vertices = [[i, j, k] for k in (-z, z) for i, j in ((-x, -y), (x, -y), (x, y), (-x, y))]
    return np.array(vertices), [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]


def times(a, b):   # product of quaternions x y z w
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])


EDGE, MASS, STEP = 0.02, 0.1, 1e-3                     # m, kg, s
INERTIA, WEIGHT = MASS * EDGE**2 / 6, np.array([0, 0, -9.81 * MASS])   # of a cube, the same about every axis
scene = palpate.Scene(tool=box([EDGE / 2] * 3), static=box([0.1, 0.1, 0.01]))
pose = np.array([0, 0, 0.03, *np.array([0.1, 0.2, 0, 1]) / np.sqrt(1.05)])   # 10 mm off the plate, tilted
speed, spin = np.zeros(3), np.zeros(3)
for tick in range(600):
    force, torque = scene.wrench(pose)                 # N, N·m about the centre of mass: a field behind a spring, so it stores no energy
    damping = 4.0 if force.any() else 0.0              # of the contact, N·s/m; about the centre with the square of half an edge
    speed += STEP * (force + WEIGHT - damping * speed) / MASS
    spin += STEP * (torque - damping * (EDGE / 2)**2 * spin) / INERTIA
    pose[:3] += STEP * speed
    pose[3:] += STEP / 2 * times(np.append(spin, 0), pose[3:])
    pose[3:] /= np.linalg.norm(pose[3:])
    if tick % 100 == 0:
        print(f'{tick * STEP:.1f} s  height {1000 * pose[2]:6.2f} mm  speed {np.linalg.norm(speed):.3f} m/s  force {np.linalg.norm(force):.3f} N')
