#!/usr/bin/env python3
"""Pages name files that exist. Of README, CONTRIBUTING and docs/: every relative link, and every path of this
tree that is written out (`compute/native/frame.cpp`). Of sources and scripts: every page of docs/ that they
name.

usage: docs_test.py ROOT"""
import re
import sys
from pathlib import Path

TOP = 'bench|compute|cpu_ref|docs|driver|model|scenes|scripts|service|shaders|tests'
LINK = re.compile(r'\]\(([^)#:\s]+)(?:#[^)]*)?\)')
PATH = re.compile(
    rf'(?<![\w/.~-])((?:{TOP})/[\w./-]*\w\.(?:cpp|h|comp|glsl|py|md|mjs|ts|rules|csv|json|sh|in|service|conf))\b'
)
PAGE = re.compile(r'(?<![\w/.])docs/\w+\.md\b')
SOURCES = {
    '.cpp',
    '.h',
    '.comp',
    '.glsl',
    '.py',
    '.mjs',
    '.ts',
    '.cmake',
    '.txt',
    '.json',
    '.sh',
    '.html',
    '',
}
MADE = {'service/viewer/work'}  # folders of a build, which docs may speak of


def missing(root):
    pages = [
        root / 'README.md',
        root / 'CONTRIBUTING.md',
        *sorted((root / 'docs').glob('**/*.md')),
        *sorted(root.glob('tests/**/README.md')),
        *sorted(root.glob('bench/**/README.md')),
    ]
    for page in pages:
        text = page.read_text()
        for target in LINK.findall(text):
            if not (page.parent / target).exists():
                yield page, target
        for path in PATH.findall(text):
            if not (root / path).exists() and not any(path.startswith(made) for made in MADE):
                yield page, path
    for folder in TOP.split('|'):
        for source in sorted((root / folder).rglob('*')):
            if source.suffix in SOURCES and source.is_file() and 'node_modules' not in source.parts:
                for page in PAGE.findall(source.read_text(errors='replace')):
                    if not (root / page).exists():
                        yield source, page


def main():
    root = Path(sys.argv[1])
    wrong = [f'{where.relative_to(root)}: {what} does not exist' for where, what in missing(root)]
    print('\n'.join(wrong) or 'every file that a page names exists')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
