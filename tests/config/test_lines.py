"""Each key's line, in every way that TOML has of writing one."""

from __future__ import annotations

from tether.config.lines import lines

TEXT = """\
# a comment
seed = 1 # another
a."b.c".d = { x = 1, y.z = [ # in between
    1, # one
    [2,
     3],
] }

[ fluid . "k\\"" ] # header
t.u = 1

[[bodies]]
q = [
    { a = 1 },
    # nothing
    { a = 2 },
]
[bodies.more]
deep = true
[[bodies]]
[[bodies.parts]]
[[bodies.parts]]
n = 1
[fluid]
"""


def test_lines() -> None:
    assert lines(TEXT) == {
        ("seed",): 2,
        ("a",): 3,
        ("a", "b.c"): 3,
        ("a", "b.c", "d"): 3,
        ("a", "b.c", "d", "x"): 3,
        ("a", "b.c", "d", "y"): 3,
        ("a", "b.c", "d", "y", "z"): 3,
        ("a", "b.c", "d", "y", "z", 0): 4,
        ("a", "b.c", "d", "y", "z", 1): 5,
        ("a", "b.c", "d", "y", "z", 1, 0): 5,
        ("a", "b.c", "d", "y", "z", 1, 1): 6,
        ("fluid", 'k"'): 9,
        ("fluid", 'k"', "t"): 10,
        ("fluid", 'k"', "t", "u"): 10,
        ("bodies",): 12,
        ("bodies", 0): 12,
        ("bodies", 0, "q"): 13,
        ("bodies", 0, "q", 0): 14,
        ("bodies", 0, "q", 0, "a"): 14,
        ("bodies", 0, "q", 1): 16,
        ("bodies", 0, "q", 1, "a"): 16,
        ("bodies", 0, "more"): 18,
        ("bodies", 0, "more", "deep"): 19,
        ("bodies", 1): 20,
        ("bodies", 1, "parts"): 21,
        ("bodies", 1, "parts", 0): 21,
        ("bodies", 1, "parts", 1): 22,
        ("bodies", 1, "parts", 1, "n"): 23,
        ("fluid",): 24,
    }


def test_multi_line_text_before_a_key() -> None:
    assert lines('a = """\n[no.table]\nno = 1\n"""\nb = 1\n') == {("a",): 1, ("b",): 5}


def test_letters_of_several_bytes() -> None:
    assert lines('"η" = "µ"\nb = 1\n') == {("η",): 1, ("b",): 2}
