"""Where a source file can be changed by one operator: the mutants of GLSL and C++ files, by their text
alone."""
import re
from dataclasses import dataclass

# What a spaced operator or a function's name may become. The first change moves the boundary, the second
# negates.
RELATIONS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
}
SIGNS = {"+": ("-",), "-": ("+",), "+=": ("-=",), "-=": ("+=",)}
LOGIC = {"&&": ("||",), "||": ("&&",)}
# In C++ the right operand may only be asked when the left one allows it, so there it is taken for what keeps
# the left one's word.
LOGIC_CPP = {"&&": ("&& true |",), "||": ("|| false &",)}
NAMES = {
    "lessThan": ("lessThanEqual", "greaterThanEqual"),
    "lessThanEqual": ("lessThan", "greaterThan"),
    "greaterThan": ("greaterThanEqual", "lessThanEqual"),
    "greaterThanEqual": ("greaterThan", "lessThan"),
    "equal": ("notEqual",),
    "notEqual": ("equal",),
    "any": ("all",),
    "all": ("any",),
    "min": ("max",),
    "max": ("min",),
    "atomicMin": ("atomicMax",),
    "atomicMax": ("atomicMin",),
}
BARRIERS = ("barrier", "memoryBarrier", "memoryBarrierBuffer", "memoryBarrierShared", "groupMemoryBarrier")

TOKEN = re.compile(
    r"""
    (?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])')
  | (?P<name>[A-Za-z_]\w*)
  | (?P<number>\.?\d(?:[eE][+-]\d|'\d|[\w.])*)
  | (?P<operator><=>|->\*?|<<=|>>=|\+\+|--|<<|>>|&&|\|\||[-+*/%&|^=!<>]=|::|[-+*/%&|^=!<>?:;,.(){}\[\]~])
  | (?P<space>\s+)""",
    re.X | re.S | re.M,
)

# A minus behind one of these has no left operand.
BEFORE_UNARY = set(
    "( [ { , ; = ? : + - * / % & | ^ ! ~ < > <= >= == != && || << >> += -= *= /= |= &= ^= <<= >>= return case".split()
)


@dataclass(frozen=True)
class Mutant:
    """One change: text[begin:end], `old`, becomes `new`. `kind`: relation, sign, negative, logic, not, name
    or barrier."""

    line: int
    column: int
    begin: int
    end: int
    kind: str
    old: str
    new: str

    def applied(self, text):
        return text[: self.begin] + self.new + text[self.end :]

    def key(self):
        """The change in a reader's words."""
        return f"{self.old} -> {self.new or 'nothing'}"


def tokens(text):
    at = 0
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:  # a character outside the languages' own: in comments only
            at += 1
            continue
        if match.lastgroup not in ("skip", "space"):
            yield match.lastgroup, match.group(), match.start()
        at = match.end()


def mutants(text, cpp=False):
    """All mutants of a file, in the order of the text. Spaces tell a relation from a template's bracket
    (.clang-format sees to that)."""
    found = []
    logic = LOGIC_CPP if cpp else LOGIC

    def add(kind, at, old, changes):
        line = text.count("\n", 0, at) + 1
        column = at - text.rfind("\n", 0, at)
        found.extend(Mutant(line, column, at, at + len(old), kind, old, new) for new in changes)

    stream = list(tokens(text))
    for i, (group, word, at) in enumerate(stream):
        spaced = text[at - 1 : at].isspace() and text[at + len(word) : at + len(word) + 1].isspace()
        before = stream[i - 1][1] if i > 0 else ";"
        after = stream[i + 1][1] if i + 1 < len(stream) else ";"
        if group == "operator":
            if spaced and word in RELATIONS:
                add("relation", at, word, RELATIONS[word])
            elif spaced and word in SIGNS:
                add("sign", at, word, SIGNS[word])
            elif spaced and word in logic:
                add("logic", at, word, logic[word])
            elif word == "-" and before in BEFORE_UNARY:
                add("negative", at, word, ("",))
            elif word == "!" and before in BEFORE_UNARY:
                add("not", at, word, ("",))
        elif group == "name" and after == "(":
            if word in BARRIERS and before in (";", "{", "}", ")"):
                end = text.index(";", at) + 1
                add("barrier", at, text[at:end], (";",))
            elif cpp and word in ("min", "max") and text[at - 5 : at] == "std::":
                add("name", at - 5, "std::" + word, ("std::" + NAMES[word][0],))
            elif not cpp and word in NAMES and before not in (".", "->"):
                add("name", at, word, NAMES[word])
    return found


OPS = {
    "<": "kLess",
    "<=": "kLessEqual",
    ">": "kGreater",
    ">=": "kGreaterEqual",
    "==": "kEqual",
    "!=": "kNotEqual",
    "+": "kPlus",
    "-": "kMinus",
}


def with_switches(text, first):
    """A copy of a C++ file in which mutant i of mutants(text, cpp=True) is on when mutation::active is first
    + i (mutant_switch.h)."""
    found = mutants(text, cpp=True)
    out, at, i = ['#include "tests/mutation/mutant_switch.h"\n'], 0, 0
    while i < len(found):
        m, number = found[i], first + i
        same = [x for x in found[i : i + 2] if x.begin == m.begin]
        scope = "::palpate::mutation::"
        if m.old in OPS and m.kind in ("relation", "sign"):
            ops = ", ".join(f"{scope}Op::{OPS[o]}" for o in [m.old] + [x.new for x in same])
            put = f"{m.old} {scope}Switch<{number}, {ops}>{{}} {m.old}"
        elif m.kind == "sign":
            put = f"{m.old} {scope}Added<{number}, {'true' if m.old == '+=' else 'false'}>{{}} ="
        elif m.kind == "negative":
            put = f"{scope}Negative<{number}>{{}} ->* "
        elif m.kind == "not":
            put = f"{scope}Not<{number}>{{}} ->* "
        elif m.kind == "logic":
            put = f"&& {scope}And<{number}>{{}} |" if m.old == "&&" else f"|| {scope}Or<{number}>{{}} &"
        else:
            put = f"{scope}Extreme<{number}, {'true' if m.old == 'std::min' else 'false'}>::of"
        out += [text[at : m.begin], put]
        at = m.end
        i += len(same)
    return "".join(out) + text[at:]
