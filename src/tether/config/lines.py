"""On which line of a TOML file each key stands."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

from tether.errors import Key

_PARSER = Parser(Language(tree_sitter_toml.language()))


def lines(text: str) -> dict[Key, int]:
    """The line, counted from 1, of every table, key and list item of a valid TOML text."""
    found: dict[Key, int] = {}
    items: dict[Key, int] = {}  # array of tables -> number of the latest one
    for node in _PARSER.parse(text.encode()).root_node.named_children:
        if node.type == "pair":
            _add_pair(node, (), found)
        elif node.type in ("table", "table_array_element"):
            header, *pairs = (child for child in node.named_children if child.type != "comment")
            table = _numbered(_names(header), items)
            if node.type == "table_array_element":
                items[table] = items.get(table, -1) + 1
                found.setdefault(table, _line(node))
                table = (*table, items[table])
            _add(table, _line(node), found)
            for pair in pairs:
                _add_pair(pair, table, found)
    return found


def _add_pair(node: Node, table: Key, found: dict[Key, int]) -> None:
    name, item = (child for child in node.named_children if child.type != "comment")
    key = table
    for part in _names(name):
        key = (*key, part)
        _add(key, _line(node), found)
    _add_items(item, key, found)


def _add_items(node: Node, key: Key, found: dict[Key, int]) -> None:
    """Go into inline tables and arrays."""
    inner = [child for child in node.named_children if child.type != "comment"]
    if node.type == "inline_table":
        for pair in inner:
            _add_pair(pair, key, found)
    elif node.type == "array":
        for number, item in enumerate(inner):
            _add((*key, number), _line(item), found)
            _add_items(item, (*key, number), found)


def _add(key: Key, line: int, found: dict[Key, int]) -> None:
    found.setdefault(key, line)


def _numbered(names: Iterator[str], items: dict[Key, int]) -> Key:
    """A header's key; [bodies.more] after [[bodies]] is in the latest of them."""
    key: Key = ()
    for name in names:
        if key in items:
            key = (*key, items[key])
        key = (*key, name)
    return key


def _names(node: Node) -> Iterator[str]:
    """The parts of a key, without quotation marks and escapes."""
    assert node.text is not None
    return split(node.text.decode())


def split(key: str) -> Iterator[str]:
    """The parts of a dotted key as TOML reads it; raises ValueError if it is none."""
    table = tomllib.loads(f"{key} = 0")
    if len(table) != 1:
        raise ValueError(key)
    while isinstance(table, dict):
        ((name, table),) = table.items()
        yield name


def _line(node: Node) -> int:
    return node.start_point.row + 1
