"""Writes the types of an IDL file as classes of cyclonedds.idl, and a stub that says what their fields hold.
Usage: make_wire.py FILE.idl FOLDER, which gets wire.py and wire.pyi

`idlc -l py` of Cyclone DDS does the same, but not here: its wheels for Python 3.11 and later come without `idlc`, and
for a sequence with a bound of 65536, as SiteMap has, it writes a type that cannot be used. Bounds are not on the wire,
so such a sequence is written without one. Every construct that this program does not know is an error.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

# What a type is called by cyclonedds.idl, and what it is in Python.
BASIC = {
    "boolean": ("bool", "bool"),
    "octet": ("types.uint8", "int"),
    "long": ("types.int32", "int"),
    "unsigned long": ("types.uint32", "int"),
    "unsigned long long": ("types.uint64", "int"),
    "double": ("types.float64", "float"),
}
LONGEST_BOUND = 65535  # that cyclonedds.idl takes

HEADER = '''"""The samples on the bus, as {idl} has them. Made from it at build time."""

from dataclasses import dataclass
from enum import auto

from cyclonedds.idl import IdlEnum, IdlStruct, annotations, types

'''
STUB_HEADER = '''from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

'''

TOKEN = re.compile(r"//[^\n]*|\s+|(?P<token>@\w+|\w+|[{}()<>\[\],;=])")


class Reader:
    """The tokens of an IDL file, with what is expected of them."""

    def __init__(self, idl: Path) -> None:
        self.idl = idl
        self.line = 1
        self._tokens = self._split(idl.read_text(encoding="utf-8"))
        self._next = next(self._tokens, "")

    def _split(self, text: str) -> Iterator[str]:
        at = 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if match is None:
                self.refuse(text[at])
            if match["token"]:
                yield match["token"]
            self.line += match[0].count("\n")
            at = match.end()

    def refuse(self, what: str) -> None:
        sys.exit(f"{self.idl}:{self.line}: '{what}' is not known to {Path(__file__).name}; teach it, or write the IDL otherwise")

    def sees(self, token: str) -> bool:
        return self._next == token

    def take(self, expected: str = "") -> str:
        token = self._next
        if not token or (expected and token != expected):
            self.refuse(token or "the end of the file")
        self._next = next(self._tokens, "")
        return token

    def takes(self, token: str) -> bool:
        return self.sees(token) and bool(self.take())


def type_of(idl: Reader, known: set[str]) -> tuple[str, str]:
    word = idl.take()
    if word == "string":
        idl.take("<")
        bound = int(idl.take())
        idl.take(">")
        return f"types.bounded_str[{bound}]", "str"
    if word == "sequence":
        idl.take("<")
        element, plain = type_of(idl, known)
        idl.take(",")
        bound = int(idl.take())
        idl.take(">")
        bounded = f"{element}, {bound}" if bound <= LONGEST_BOUND else element
        return f"types.sequence[{bounded}]", f"Sequence[{plain}]"
    if word in known:
        return word, word
    while word == "unsigned" or (word == "unsigned long" and idl.sees("long")):
        word += f" {idl.take()}"
    if word not in BASIC:
        idl.refuse(word)
    return BASIC[word]


class Output:
    """The text of the module and of its stub."""

    def __init__(self) -> None:
        self.module: list[str] = []
        self.stub: list[str] = []

    def add(self, module: list[str], stub: list[str]) -> None:
        self.module.append("\n".join(module))
        self.stub.append("\n".join(stub))


def enum(idl: Reader, scope: str, output: Output) -> str:
    name = idl.take()
    idl.take("{")
    names = [idl.take()]
    while idl.takes(","):
        names.append(idl.take())
    idl.take("}")
    output.add(
        [
            f'class {name}(IdlEnum, typename="{scope}.{name}", default="{names[0]}"):',
            *(f"    {one} = auto()" for one in names),  # from 0
        ],
        [f"class {name}(Enum):", *(f"    {one} = {number}" for number, one in enumerate(names))],
    )
    return name


def struct(idl: Reader, scope: str, known: set[str], output: Output) -> str:
    name = idl.take()
    idl.take("{")
    module = [
        "@dataclass",
        "@annotations.final",
        '@annotations.autoid("sequential")',
        f'class {name}(IdlStruct, typename="{scope}.{name}"):',
    ]
    stub = ["@dataclass", f"class {name}:"]
    while not idl.takes("}"):
        key = idl.takes("@key")
        of_type, plain = type_of(idl, known)
        member = idl.take()
        if idl.takes("["):
            of_type, plain = f"types.array[{of_type}, {int(idl.take())}]", f"Sequence[{plain}]"
            idl.take("]")
        idl.take(";")
        module.append(f"    {member}: {of_type}")
        if key:
            module.append(f'    annotations.key("{member}")')
        stub.append(f"    {member}: {plain}")
    output.add(module, stub)
    return name


def module(idl: Reader, scope: str, output: Output) -> None:
    known: set[str] = set()
    idl.take("{")
    while not idl.takes("}"):
        word = idl.take()
        if word == "module":
            name = idl.take()
            module(idl, f"{scope}.{name}" if scope else name, output)
        elif word == "const":
            _, plain = type_of(idl, known)
            name = idl.take()
            idl.take("=")
            output.add([f"{name} = {int(idl.take())}"], [f"{name}: {plain}"])
        elif word == "enum":
            known.add(enum(idl, scope, output))
        elif word == "@final":
            idl.take("struct")
            known.add(struct(idl, scope, known, output))
        else:
            idl.refuse(word)
        idl.take(";")


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, folder = map(Path, sys.argv[1:])
    idl, output = Reader(source), Output()
    idl.take("module")
    module(idl, idl.take(), output)
    idl.take(";")
    header = HEADER.format(idl=f"idl/{source.name}")
    (folder / "wire.py").write_text(header + "\n\n\n".join(output.module) + "\n", encoding="utf-8")
    (folder / "wire.pyi").write_text(STUB_HEADER + "\n\n".join(output.stub) + "\n", encoding="utf-8")


main()
