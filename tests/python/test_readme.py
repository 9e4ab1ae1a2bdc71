"""Every Python block of README.md and docs/PYTHON.md runs."""
import pathlib
import re

import numpy as np
import palpate
import pytest
from conftest import CUBE

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BLOCKS = {
    file: re.findall(r'```python\n(.*?)```', (SOURCE / file).read_text(), re.S)
    for file in ('README.md', 'docs/PYTHON.md')
}


def test_the_readme_has_ten_lines():
    assert len(BLOCKS['README.md']) == 1 and len(BLOCKS['README.md'][0].splitlines()) == 10


@pytest.mark.parametrize('file', BLOCKS)
def test_the_blocks_run(file, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    palpate.generate('disassembly', 'engine', triangles=5000, tool_triangles=2000)
    # What a block takes for granted.
    here = {
        'palpate': palpate,
        'table': CUBE,
        'gripper': CUBE,
        'table_matrix': np.eye(4),
        'matrix': np.eye(4),
    }
    for block in BLOCKS[file]:
        exec(compile(block, file, 'exec'), here)
    said = capsys.readouterr().out
    assert said.strip()
    if 'names' in here:
        assert here['names'] == {'table'} and here['gap'] == 0
