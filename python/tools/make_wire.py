"""Writes aloft/wire.py, the types of an IDL file as cyclonedds.idl classes. Usage: make_wire.py FILE.idl OUTPUT.py

`idlc -l py` of Cyclone DDS does the same, but not here: its wheels for Python 3.11 and later come without `idlc`, and
for a sequence with a bound of 65536, as SiteMap has, it writes a type that cannot be used. Bounds are not on the wire,
so such a sequence is written without one. Every construct that this program does not know is an error.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

BASIC = {
    "boolean": "bool",
    "octet": "types.uint8",
    "long": "types.int32",
    "unsigned long": "types.uint32",
    "unsigned long long": "types.uint64",
    "double": "types.float64",
}
LONGEST_BOUND = 65535  # that cyclonedds.idl takes

HEADER = '''"""The samples on the bus, as {idl} has them. Made from it at build time."""

from dataclasses import dataclass
from enum import auto

from cyclonedds.idl import IdlEnum, IdlStruct, annotations, types

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


def type_of(idl: Reader, known: set[str]) -> str:
    word = idl.take()
    if word == "string":
        idl.take("<")
        bound = int(idl.take())
        idl.take(">")
        return f"types.bounded_str[{bound}]"
    if word == "sequence":
        idl.take("<")
        element = type_of(idl, known)
        idl.take(",")
        bound = int(idl.take())
        idl.take(">")
        return f"types.sequence[{element}, {bound}]" if bound <= LONGEST_BOUND else f"types.sequence[{element}]"
    if word in known:
        return word
    while word == "unsigned" or (word == "unsigned long" and idl.sees("long")):
        word += f" {idl.take()}"
    if word not in BASIC:
        idl.refuse(word)
    return BASIC[word]


def enum(idl: Reader, scope: str) -> tuple[str, str]:
    name = idl.take()
    idl.take("{")
    names = [idl.take()]
    while idl.takes(","):
        names.append(idl.take())
    idl.take("}")
    lines = [f'class {name}(IdlEnum, typename="{scope}.{name}", default="{names[0]}"):']
    lines += [f"    {one} = auto()  # from 0" if one == names[0] else f"    {one} = auto()" for one in names]
    return name, "\n".join(lines)


def struct(idl: Reader, scope: str, known: set[str]) -> tuple[str, str]:
    name = idl.take()
    idl.take("{")
    lines = [
        "@dataclass",
        "@annotations.final",
        '@annotations.autoid("sequential")',
        f'class {name}(IdlStruct, typename="{scope}.{name}"):',
    ]
    while not idl.takes("}"):
        key = idl.takes("@key")
        of_type = type_of(idl, known)
        member = idl.take()
        if idl.takes("["):
            of_type = f"types.array[{of_type}, {int(idl.take())}]"
            idl.take("]")
        idl.take(";")
        lines.append(f"    {member}: {of_type}")
        if key:
            lines.append(f'    annotations.key("{member}")')
    return name, "\n".join(lines)


def module(idl: Reader, scope: str) -> list[str]:
    parts: list[str] = []
    known: set[str] = set()
    idl.take("{")
    while not idl.takes("}"):
        word = idl.take()
        if word == "module":
            name = idl.take()
            parts += module(idl, f"{scope}.{name}" if scope else name)
        elif word == "const":
            type_of(idl, known)
            name = idl.take()
            idl.take("=")
            parts.append(f"{name} = {int(idl.take())}")
        elif word == "enum":
            name, text = enum(idl, scope)
            known.add(name)
            parts.append(text)
        elif word == "@final":
            idl.take("struct")
            name, text = struct(idl, scope, known)
            known.add(name)
            parts.append(text)
        else:
            idl.refuse(word)
        idl.take(";")
    return parts


def main() -> None:
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    source, output = map(Path, sys.argv[1:])
    idl = Reader(source)
    idl.take("module")
    parts = module(idl, idl.take())
    idl.take(";")
    output.write_text(HEADER.format(idl=f"idl/{source.name}") + "\n\n\n".join(parts) + "\n", encoding="utf-8")


main()
