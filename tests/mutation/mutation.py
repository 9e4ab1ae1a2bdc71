#!/usr/bin/env python3
"""Changes every operator of the exact code, one at a time, and asks whether the answers tell.

    mutation.py JUDGE [--only PATH...] [--sample N] [--jobs N] [--cache FILE] [--table FILE] [--least PERCENT]

JUDGE is the built mutant_judge. Prints a line a file and the survivors; writes the table with --table. A
caught mutant stays caught until its file changes; a survivor is asked again when the oracle changes, too
(--cache remembers). Status 1: a survivor that survivors.csv does not explain, or fewer caught than --least of
those that change something.
"""
import argparse
import collections
import csv
import hashlib
import json
import os
import pathlib
import queue
import re
import subprocess
import sys
import threading

from sites import mutants

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CAUGHT = ("differs", "crashed", "hangs")
NO_MUTANT = ("no-program", "no-change")
# How the reason begins when no test could see the mutant.
CHANGES_NOTHING = (
    "equivalent: ",
    "speed only: ",
    "a sentence of an error",
    "memory_bytes is no answer",
    "by design: ",
)
SECOND = ("logic", "not", "name")  # kinds that are judged when all others have been

# What is judged first: predicates, then areas, rays, classes; then the rest.
FIRST = """cpu_ref/ model/ compute/ shaders/lib/triangle_pair shaders/lib/triangle_voxel shaders/lib/ray shaders/lib/sample.glsl
shaders/lib/line_box shaders/lib/direction shaders/lib/area shaders/lib/union_find shaders/lib/partition shaders/lib/cells shaders/lib/components shaders/lib/pose
shaders/lib/voxel_range shaders/lib/ shaders/response/ shaders/prepare/
shaders/frame/ shaders/""".split()


# The host's exact code, in the order of CMakeLists.txt.
HOST = [
    f"model/{name}.cpp"
    for name in "mesh/boundary mesh/edges mesh/orientation contact/field_response contact/response mesh/patches mesh/tips mesh/side_winding mesh/smooth_angle".split()
]


# What distances and the planner's questions are answered with: the judge asks them, too.
PLANNERS = (
    "compute/native/queries/",
    "compute/native/narrow_phase/pair_filter",
    "compute/scene/triangle_tree",
)


def native():
    """The native engine and what it has in common with the device's, as CMakeLists.txt lists them: not what
    stands for eight lanes at once (tests/native/filters_test.cpp holds that against plain numbers)."""
    return sorted(
        str(p.relative_to(ROOT))
        for folder in ("compute/native", "compute/scene")
        for p in (ROOT / folder).rglob("*")
        if p.suffix in (".h", ".cpp") and not p.name.endswith("_simd.h")
    )


def of_program(name):
    """Whether a file's mutants are switches in the judge, not texts that it compiles."""
    return not name.startswith("shaders/")


def sources():
    """Files with mutants, in the order of FIRST."""
    names = [
        str(p.relative_to(ROOT))
        for folder in ("cpu_ref", "shaders")
        for p in sorted((ROOT / folder).rglob("*"))
        if p.suffix in (".h", ".cpp", ".glsl", ".comp") and "shared" not in p.parts
    ]
    names += HOST + native()
    return sorted(names, key=lambda n: (next(i for i, f in enumerate(FIRST) if n.startswith(f)), n))


def includes(name, seen=None):
    """All that a shader includes, itself too."""
    seen = {name} if seen is None else seen
    for inner in re.findall(r'#include "([^"]+)"', (ROOT / name).read_text()):
        if inner not in seen:
            seen.add(inner)
            includes(inner, seen)
    return seen


def short_hash(*parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part if isinstance(part, bytes) else str(part).encode())
        digest.update(b"\0")
    return digest.hexdigest()[:16]


class Job:
    """A mutant, what the judge is told, and where the answer is remembered."""

    def __init__(self, name, mutant, command, text_hash):
        self.name, self.mutant, self.command = name, mutant, command
        self.key = short_hash(text_hash, name, mutant.begin, mutant.new)
        self.row = None  # outcome, seconds, case, what


def all_jobs(only):
    modules = {str(p.relative_to(ROOT)): None for p in (ROOT / "shaders").rglob("*.comp")}
    modules.update((str(p.relative_to(ROOT)), None) for p in (ROOT / "tests/compute/shaders").glob("*.comp"))
    closure = {m: includes(m) for m in modules}
    # Probes first, they cost least; then the parts of a frame: a mutant caught there need not be compiled for
    # the preparation too.
    order = sorted(
        modules,
        key=lambda m: (
            not m.startswith("tests/"),
            not m.startswith("shaders/frame/"),
            not m.startswith("shaders/response/"),
            m,
        ),
    )
    first_number = 1
    numbers = {}
    for name in sorted(n for n in sources() if n.startswith("cpu_ref/")) + HOST + native():
        numbers[name] = first_number
        first_number += len(mutants((ROOT / name).read_text(), cpp=True))
    for name in sources():
        if only and not any(name.startswith(o) for o in only):
            continue
        text = (ROOT / name).read_text()
        # What surrounds a file changes its mutants' fate seldom; what it is itself always.
        reference = of_program(name)
        for i, m in enumerate(mutants(text, cpp=reference)):
            if reference:
                planners = name.startswith(PLANNERS)
                command = ("host " if name in HOST else "planners " if planners else "") + str(
                    numbers[name] + i
                )
            else:
                # Places in bytes, for C++.
                begin, end = (len(text[:at].encode()) for at in (m.begin, m.end))
                command = "\t".join(
                    [name, str(begin), str(end), m.new, " ".join(c for c in order if name in closure[c])]
                )
            yield Job(name, m, command, short_hash(text))


# Tests of parts by what they ask, the soonest done first, as CMakeLists.txt names them.
TESTS = {
    "cpu_ref/clearance.cpp": ["first_contact"],
    "cpu_ref/depth.cpp": ["depth_search"],
    "cpu_ref/distance_of_triangles.cpp": ["first_contact"],
    "model/mesh/patches.cpp": ["patches"],
    "model/mesh/tips.cpp": ["tips"],
    "compute/native/broad_phase/": ["filters"],
    "compute/native/force/": ["depth_search"],
    "compute/native/narrow_phase/": ["filters", "inside_cells"],
    "compute/native/queries/distance_lattice": ["room_field", "first_contact"],
    "compute/native/queries/nearest_points": ["nearest_points", "turned_gaps", "first_contact"],
    "compute/native/queries/pair_gap": ["nearest_points", "first_contact"],
    "compute/native/queries/room_": ["room_field", "touch", "first_contact"],
    "compute/native/queries/": ["turned_gaps", "touch", "first_contact"],
    "compute/scene/": ["brick_bits", "filters", "depth_search"],
}
TEST_SECONDS = 100  # of the processor's; the longest takes twenty


def test_program(judge, test):
    return pathlib.Path(judge).parent / f"mutant_{test}_test"


def tests_of(job):
    return next((TESTS[of] for of in TESTS if job.name.startswith(of)), [])


def asked_of_tests(judge, job):
    """What the tests of parts say of a mutant that the cases did not catch."""
    number = job.command.split()[-1]
    for test in tests_of(job):
        run = subprocess.run(
            ["prlimit", f"--cpu={TEST_SECONDS}", str(test_program(judge, test))],
            env=dict(os.environ, PALPATE_MUTANT=number),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        if run.returncode != 0:
            outcome = {1: "differs", 77: "no-program", -24: "hangs", -9: "hangs"}.get(
                run.returncode, "crashed"
            )
            return [outcome, job.row[1], f"{test}_test", f"exit status {run.returncode}"]
    return job.row


class Judge:
    """The judge's process, started again when a mutant ends it."""

    CHECK_EVERY = 20

    def __init__(self, program, back_end, flags, without):
        self.command = [program, back_end, str(ROOT), *flags, *(["--without", *without] if without else [])]
        self.back_end, self.process = back_end, None
        self.unchecked = []

    def start(self):
        environment = dict(os.environ, LP_NUM_THREADS="0")
        self.process = subprocess.Popen(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=environment,
        )
        ready = self.process.stdout.readline()
        if not ready.startswith("ready"):
            sys.exit(f"{' '.join(self.command)} does not start: the unchanged program fails its own oracle")
        self.unchecked = []

    def stop(self):
        if self.process:
            self.process.kill()
            self.process.wait()
            self.process = None

    def ask(self, command):
        """The judge's answer; None when the process ended."""
        if self.process is None:
            self.start()
        try:
            self.process.stdin.write(command + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        except BrokenPipeError:
            line = ""
        return line.rstrip("\n").split("\t") if line else None

    def judge(self, job):
        row = self.ask(job.command)
        if row is None:  # 27: SIGPROF, the limit of processor time
            status = self.process.wait()
            outcome = {-27: "hangs", 77: "no-program"}.get(status, "crashed")  # 77: mutant_switch.h
            row = [outcome, "0", "", f"signal {-status}"]
            self.process = None
            self.unchecked = []
        elif "did not answer in time" in row[3] and not getattr(job, "again", False):
            job.again = True  # a busy machine, perhaps
            self.stop()
            return self.judge(job)
        job.row = row
        if self.back_end == "gpu" and self.process:
            self.unchecked.append(job)

    def check(self):
        """A mutant that wrote where it should not may have spoilt the process for those after it."""
        if not self.unchecked:
            return
        suspects, self.unchecked = self.unchecked, []
        answer = self.ask("intact")
        if answer and answer[0] == "intact":
            return
        self.stop()
        for job in suspects:
            row = self.ask(job.command)
            after = self.ask("intact") if row else None
            if not after or after[0] != "intact":
                row = ["crashed", row[1] if row else "0", "", "spoils the process"]
                self.stop()
            job.row = row


def oracle_version():
    files = sorted(
        [
            *HERE.glob("oracle*"),
            *HERE.glob("limits*"),
            *HERE.glob("probes*"),
            *HERE.glob("mutable_device*"),
            *HERE.glob("*_probes*"),
            *(ROOT / "tests/compute").glob("*.h"),
            *(ROOT / "tests/equivalence").glob("*.cpp"),
            *(ROOT / "tests/equivalence").glob("*.h"),
        ]
    )
    return short_hash(*[f.read_bytes() for f in files])


def version_of_tests(job):
    sources = [next((ROOT / "tests").glob(f"*/{test}_test.cpp")) for test in tests_of(job)]
    return short_hash(*[source.read_bytes() for source in sources])


def explanations():
    """Why explained survivors survive, by place()."""
    path = HERE / "survivors.csv"
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        return {(r["file"], r["source"], r["change"]): r["why"] for r in csv.DictReader(file)}


def place(job):
    """How a survivor is named in survivors.csv: by its line's text, so that it stays explained when lines
    move."""
    m = job.mutant
    lines = [" ".join(line.split()) for line in (ROOT / job.name).read_text().split("\n")]
    source = lines[m.line - 1]
    twin = lines[: m.line - 1].count(source)
    nth = len(
        [
            x
            for x in mutants((ROOT / job.name).read_text(), cpp=of_program(job.name))
            if x.line == m.line and x.column < m.column and x.key() == m.key()
        ]
    )
    return (
        job.name,
        source + (f" [{twin + 1}]" if twin else ""),
        m.key() + (f" (no. {nth + 1})" if nth else ""),
    )


def main():
    arguments = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    arguments.add_argument("judge")
    arguments.add_argument("--only", nargs="*", default=[])
    arguments.add_argument(
        "--sample", type=int, default=0, help="every so many mutants only, so that this many are judged"
    )
    arguments.add_argument(
        "--least", type=float, default=95, help="so many in 100 of those that change something must be caught"
    )
    arguments.add_argument(
        "--without",
        nargs="*",
        default=[],
        help="cases that are not asked, to see what they are worth (and no probe)",
    )
    arguments.add_argument("--jobs", type=int, default=1)
    arguments.add_argument("--cache", type=pathlib.Path)
    arguments.add_argument("--table", type=pathlib.Path)
    arguments.add_argument(
        "--killers",
        action="store_true",
        help="ask the killer cases only: a first pass, whose survivors are asked again",
    )
    arguments.add_argument(
        "--probes",
        action="store_true",
        help="ask shaders' mutants the probes of tests/compute alone: a first pass of seconds",
    )
    arguments.add_argument(
        "--as-gpu",
        action="store_true",
        help="shaders run as on a GPU with memory of its own: teams of invocations, work cut finely",
    )
    arguments.add_argument("--known", action="store_true", help="judge nothing: only what the cache knows")
    options = arguments.parse_args()

    jobs = list(all_jobs(options.only))
    if options.sample:
        jobs = jobs[:: max(1, len(jobs) // options.sample)]
    known = json.loads(options.cache.read_text()) if options.cache and options.cache.exists() else {}
    flags = [
        f"--{name}" for name in ("killers", "probes", "as-gpu") if getattr(options, name.replace("-", "_"))
    ]
    oracle, named = oracle_version(), "".join(f" {flag[2:]}" for flag in flags)

    def versions(job):
        """What a survivor was asked by, with these flags and with none."""
        of_job = f"{oracle} {version_of_tests(job)}"
        return of_job + named, of_job

    for job in jobs:
        row = known.get(job.key)
        if row and (row[0] in CAUGHT or row[0] in NO_MUTANT or row[4] in versions(job) or options.known):
            job.row = row[:4]
    waiting = [j for j in jobs if j.row is None] if not options.known else []
    print(f"{len(jobs)} mutants, {len(waiting)} to judge", flush=True)

    for test in sorted({test for tests in TESTS.values() for test in tests}):
        if not test_program(
            options.judge, test
        ).exists():  # one that can't start would look like one that tells
            sys.exit(f"{test_program(options.judge, test)} is not there: build the target mutant_judge")

    lock = threading.Lock()

    def remember(job):
        with lock:
            known[job.key] = [*job.row, versions(job)[0]]

    def save():
        if options.cache:
            with lock:
                temporary = options.cache.with_suffix(".new")
                temporary.write_text(json.dumps(known))
                temporary.replace(options.cache)

    work = queue.Queue()
    # By file, so that a judge that has just seen a file's killer asks it first.
    batches = collections.OrderedDict()
    for job in waiting:
        batches.setdefault((SECOND.count(job.mutant.kind), job.name), []).append(job)
    for _, batch in sorted(batches.items(), key=lambda item: item[0][0]):  # stable: by file within each pass
        work.put(batch)

    def worker():
        judges = {}
        while True:
            try:
                batch = work.get_nowait()
            except queue.Empty:
                break
            name = batch[0].name
            back_end = "native" if name.startswith("compute/") else "cpu" if of_program(name) else "gpu"
            judge = judges.setdefault(back_end, Judge(options.judge, back_end, flags, options.without))
            # What is judged is kept when somebody ends us.
            for start in range(0, len(batch), Judge.CHECK_EVERY):
                part = batch[start : start + Judge.CHECK_EVERY]
                for job in part:
                    judge.judge(job)
                    if job.row[0] == "survived" and not options.killers:
                        job.row = asked_of_tests(options.judge, job)
                judge.check()
                for job in part:
                    remember(job)
                save()
            count = collections.Counter(job.row[0] for job in batch)
            seconds = sum(float(job.row[1]) for job in batch)
            print(f"{batch[0].name}: {dict(count)}, {seconds:.1f} s", flush=True)
        for judge in judges.values():
            judge.stop()

    threads = [threading.Thread(target=worker) for _ in range(options.jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    done = [j for j in jobs if j.row]
    why = explanations()
    real = [j for j in done if j.row[0] not in NO_MUTANT]
    survivors = [j for j in real if j.row[0] not in CAUGHT]
    if options.table:
        with options.table.open("w", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(
                ["file", "line", "column", "kind", "change", "outcome", "cpu_s", "case", "what differs"]
            )
            for j in done:
                m = j.mutant
                out.writerow(
                    [j.name, m.line, m.column, m.kind, m.key(), j.row[0], j.row[1], j.row[2], j.row[3][:60]]
                )
    unexplained = [j for j in survivors if place(j) not in why]
    for j in survivors:
        note = why.get(place(j), "NOT EXPLAINED")
        print(f"survives: {j.name}:{j.mutant.line}:{j.mutant.column}: {j.mutant.key()}: {note}")
    outcomes = collections.Counter(j.row[0] for j in done)
    caught = len(real) - len(survivors)
    print(f"{len(done)} judged of {len(jobs)}: {dict(outcomes)}")
    print(
        f"caught {caught} of {len(real)} ({100 * caught / max(1, len(real)):.1f} %),"
        f" {len(survivors)} survive, {len(unexplained)} not explained"
    )
    nothing = {id(j) for j in survivors if why.get(place(j), "").startswith(CHANGES_NOTHING)}

    def tell(what, chosen):
        n, of = sum(j.row[0] in CAUGHT for j in chosen), len(chosen)
        seen = of - sum(id(j) in nothing for j in chosen)
        if of:
            print(
                f"  {what}: {n} of {of} ({100 * n / of:.1f} %); of the {seen} that change something"
                f" {100 * n / max(1, seen):.1f} %"
            )

    tell("all", real)
    for side, of_side in (
        ("reference", [j for j in real if j.name.startswith("cpu_ref/")]),
        ("host", [j for j in real if j.name in HOST]),
        ("shaders", [j for j in real if not of_program(j.name)]),
    ):
        tell(side, of_side)
        for kinds in (("relation",), ("sign", "negative"), ("barrier",), ("logic", "not"), ("name",)):
            tell(f"{side}, {' and '.join(kinds)}", [j for j in of_side if j.mutant.kind in kinds])
    few = 100 * caught < options.least * (len(real) - len(nothing))
    return 1 if unexplained or few or len(done) < len(jobs) else 0


if __name__ == "__main__":
    sys.exit(main())
