"""Small meshes and scenes as files."""
import json
import pathlib

FACES = [
    [0, 2, 1],
    [0, 3, 2],
    [4, 5, 6],
    [4, 6, 7],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
]
EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / 'docs/examples'


def write_boxes(path, boxes):
    """An OFF file of boxes (low corner, high corner), m."""
    corners, faces = [], []
    for low, high in boxes:
        faces += [[len(corners) + i for i in face] for face in FACES]
        corners += [
            [x, y, z]
            for z in (low[2], high[2])
            for x, y in ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))
        ]
    lines = [
        'OFF',
        f'{len(corners)} {len(faces)} 0',
        *(' '.join(map(str, corner)) for corner in corners),
        *('3 ' + ' '.join(map(str, face)) for face in faces),
    ]
    path.write_text('\n'.join(lines) + '\n')


def write_scene(folder, mockup, tool):
    """Boxes as a scene's mock-up and tool; the scene file's path."""
    write_boxes(folder / 'mockup.off', mockup)
    write_boxes(folder / 'tool.off', tool)
    path = folder / 'scene.json'
    path.write_text(
        json.dumps(
            {'static': [{'mesh': 'mockup.off', 'units': 'm'}], 'tool': {'mesh': 'tool.off', 'units': 'm'}}
        )
    )
    return path
