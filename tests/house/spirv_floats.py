"""No shipped shader module computes a float that is compared, and none whose bits a device may choose leaves
a module unnoticed.

usage: spirv_floats.py SPIRV_DIRECTORY

Integers decide (docs/EXACTNESS.md), and the doubles of an answer are made on the host. Floats only propose:
CULLS lists the modules that hold any, and why no bit of theirs reaches an answer. Every other module with
float arithmetic must have NoContraction on each operation, none that Vulkan leaves inexact, and no reduced
precision. No module at all may keep a float where another invocation, the host or a later stage reads it.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

# Exactly rounded or free of rounding, once nothing is contracted (Vulkan, "Precision and Operation of SPIR-V
# Instructions").
ARITHMETIC = {'OpFAdd', 'OpFSub', 'OpFMul', 'OpFNegate', 'OpVectorTimesScalar'}
EXACT_EXTENDED = {'FAbs', 'FMin', 'FMax', 'FSign', 'Floor', 'Ceil', 'Trunc'}
INEXACT = {
    'OpFDiv',
    'OpFRem',
    'OpFMod',
    'OpDot',
    'OpOuterProduct',
    'OpMatrixTimesScalar',
    'OpVectorTimesMatrix',
    'OpMatrixTimesVector',
    'OpMatrixTimesMatrix',
}
SHARED_STORAGE = {
    'StorageBuffer',
    'Uniform',
    'UniformConstant',
    'PushConstant',
    'Workgroup',
    'CrossWorkgroup',
    'Input',
    'Output',
}

RAYS = (
    'whether a ray may meet a box or a triangle (lib/line_box.glsl): the margin covers every rounding,'
    ' contracted or not, and exact tests follow'
)
CELL = (
    'in which cell a coordinate lies (cell_along in lib/voxel_range.glsl): with at most 2^15 cells the'
    ' quotient is less than one off, and an integer remainder settles it'
)
DEPTH = (
    'in which cell a coordinate lies (as above), quotients and roots of lib/distance.glsl, which integer'
    ' remainders settle, and which triangles a segment crosses or may be nearest (lib/segment_estimate.glsl,'
    ' lib/distance_estimate.glsl, lib/body/body_depth.glsl, whose invocations tell each other bounds as bits):'
    ' margins cover every rounding, contracted or not, and exact tests decide the rest'
)
WALK = (
    'in which cell a coordinate lies (as above), and which triangles a segment crosses for sure'
    ' (lib/segment_estimate.glsl): margins cover every rounding, contracted or not, and the exact test'
    ' decides the rest'
)
NEAR = (
    'which runs, voxels and list entries may be near (lib/broad_phase/turned_box.glsl, broad_phase,'
    ' voxel_touch, pair_test): margins cover every rounding, contracted or not, and exact tests follow; and'
    ' in which cell a coordinate lies (as above)'
)
CULLS = {
    'centroids_trace': RAYS,
    'field_from_mockup': DEPTH,
    'field_from_tool': DEPTH,
    'field_points': CELL,
    'broad_phase': NEAR,
    'pair_test': NEAR,
    'sample_listed': CELL,
    'sample_scan': CELL,
    'sample_walk': WALK,
    'voxel_touch': NEAR,
}


class Module:
    def __init__(self, path):
        text = subprocess.run(
            ['spirv-dis', '--raw-id', '--no-color', str(path)], check=True, capture_output=True, text=True
        ).stdout
        self.problems = []
        self.floats = 0  # instructions that compute or convert a float
        lines = [line.split(';')[0].split() for line in text.splitlines()]
        instructions = []  # (opcode, result or None, operands with the result's type first)
        for words in filter(None, lines):
            if len(words) > 2 and words[1] == '=':
                instructions.append((words[2], words[0], words[3:]))
            else:
                instructions.append((words[0], None, words[1:]))
        decorated = {}
        for op, _, operands in instructions:
            if op in ('OpDecorate', 'OpMemberDecorate'):
                decorated.setdefault(operands[0], set()).update(operands[1:])
        if any('RelaxedPrecision' in names for names in decorated.values()):
            self.problems.append('RelaxedPrecision')
        # Types that hold a float, and what points to them from where others can read.
        holds_float, widths, type_of = set(), set(), {}
        for op, result, operands in instructions:
            if op == 'OpTypeFloat':
                holds_float.add(result)
                widths.add(int(operands[0]))
            elif op in (
                'OpTypeVector',
                'OpTypeMatrix',
                'OpTypeArray',
                'OpTypeRuntimeArray',
                'OpTypeStruct',
            ) and holds_float & set(operands):
                holds_float.add(result)
            elif op == 'OpTypePointer' and operands[1] in holds_float and operands[0] in SHARED_STORAGE:
                self.problems.append(f'a float in {operands[0]} memory')
            elif result and operands:
                type_of[result] = operands[0]
        if widths - {32}:
            self.problems.append(f'floats of {sorted(widths)} bits')
        self.loose = []  # what a module outside CULLS may not hold
        for op, result, operands in instructions:
            is_float = bool(operands) and operands[0] in holds_float
            if op in ARITHMETIC and is_float:
                self.floats += 1
                if 'NoContraction' not in decorated.get(result, ()):
                    self.loose.append(f'{op} without NoContraction')
            elif op in INEXACT and is_float:
                self.floats += 1
                self.loose.append(op)
            elif op == 'OpExtInst' and is_float:
                self.floats += 1
                if operands[2] not in EXACT_EXTENDED:
                    self.loose.append(operands[2])
            elif op.startswith('OpConvert') and (
                is_float or any(type_of.get(o) in holds_float for o in operands[1:])
            ):
                self.floats += 1


def verdict(path, name):
    """Sentences, none when all is well."""
    module = Module(path)
    problems = list(module.problems)
    if name in CULLS:
        if module.floats == 0:
            problems.append('is listed among the modules with floats and has none')
    else:
        problems += sorted(set(module.loose))
    return problems, module.floats


def test_the_test():
    """What must be found is found: each of these shaders breaks one rule, the last breaks none."""
    head = (
        '#version 460\n#extension GL_EXT_shader_explicit_arithmetic_types : require\nlayout(local_size_x = 1)'
        ' in;\nlayout(set = 0, binding = 0) buffer A { int a[]; };\nlayout(set = 0, binding = 1) buffer B {'
        ' %s b[]; };\nvoid main() { float x = float(a[0]), y = float(a[1]); precise float s = 0.0; float r ='
        ' 0.0; %s a[2] = int(r) + int(s); }\n'
    )
    cases = {
        'OpFMul without NoContraction': ('int', 'r = x * y + 1.0;'),
        'OpFAdd without NoContraction': ('int', 'r = x + y;'),
        'OpFDiv': ('int', 's = x / y;'),
        'Sqrt': ('int', 's = sqrt(x);'),
        'Fma': ('int', 's = fma(x, y, 1.0);'),
        'floats of [16, 32] bits': ('int', 'float16_t h = float16_t(x); a[3] = int(h * h);'),
        'RelaxedPrecision': ('int', 'mediump float m = x * y; r = m;'),
        'a float in StorageBuffer memory': ('float', 'b[0] = x;'),
        None: ('int', 's = x * y + 1.0; r = min(abs(x), s);'),
    }
    with tempfile.TemporaryDirectory(prefix='palpate-test-') as folder:
        for expected, (kind, body) in cases.items():
            source, spirv = pathlib.Path(folder) / 'probe.comp', pathlib.Path(folder) / 'probe.spv'
            source.write_text(head % (kind, body))
            subprocess.run(
                ['glslangValidator', '--quiet', '--target-env', 'vulkan1.3', '-o', str(spirv), str(source)],
                check=True,
                stdout=sys.stderr,
            )
            problems, _ = verdict(spirv, 'probe')
            if (expected not in problems) if expected else problems:
                sys.exit(f'this test is blind: {body} should give {expected}, gave {problems}')


def main():
    test_the_test()
    paths = sorted(pathlib.Path(sys.argv[1]).glob('*.spv'))
    failed = 0
    for path in paths:
        name = path.stem.removesuffix('.texels')  # the same shader for a device that reads texels
        problems, floats = verdict(path, name)
        if floats:
            print(
                f'{path.stem}: {floats} float instructions'
                + (f'; {CULLS[name]}' if name in CULLS else ', none contracted')
            )
        for problem in problems:
            failed += 1
            print(f'FAILED  {path.stem}: {problem}')
    missing = set(CULLS) - {p.stem for p in paths}
    for name in sorted(missing):
        failed += 1
        print(f'FAILED  {name} is listed and no longer there')
    print(f'{len(paths)} modules, {failed} problems')
    sys.exit(1 if failed or not paths else 0)


main()
