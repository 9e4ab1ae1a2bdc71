"""Writes the copy of the reference that holds all its mutants: with_switches.py SOURCE_ROOT OUT FILE..., and
OUT/mutants.txt."""
import pathlib
import sys

from sites import mutants, with_switches

root, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
number, lines = 1, []
for name in sys.argv[3:]:
    text = (root / name).read_text()
    copy = out / name
    copy.parent.mkdir(parents=True, exist_ok=True)
    changed = with_switches(text, number)
    if not copy.exists() or copy.read_text() != changed:  # what didn't change is not compiled again
        copy.write_text(changed)
    found = mutants(text, cpp=True)
    lines.append(f"{name} {number} {len(found)}\n")
    number += len(found)
(out / "mutants.txt").write_text("".join(lines))
