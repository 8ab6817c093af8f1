"""Three directives that write reference pages from the program itself, so that neither can be out of date.

``{configuration}``       tables of every section and key, from the JSON schema of the configuration models
``{study}``               the same of a study
``{command-line} run``    what ``tether run --help`` prints
"""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import tether.config
from tether.study.study import json_schema

Schema = dict[str, Any]

LIMITS = {
    "exclusiveMinimum": "> {}",
    "minimum": ">= {}",
    "exclusiveMaximum": "< {}",
    "maximum": "<= {}",
    "multipleOf": "a multiple of {}",
}
TYPES = {
    "integer": "integer",
    "number": "number",
    "string": "text",
    "boolean": "true or false",
    "object": "table",
}


class ConfigurationReference(SphinxDirective):
    """Every section and key of a configuration file."""

    def run(self) -> list[nodes.Node]:
        """Write the sections as Markdown and parse them."""
        text = "\n".join(configuration_lines(tether.config.json_schema()))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


class StudyReference(SphinxDirective):
    """Every key of a study file."""

    def run(self) -> list[nodes.Node]:
        """Write the table as Markdown and parse it."""
        schema = json_schema()
        return self.parse_text_to_nodes("\n".join(table(schema, schema.get("$defs", {}))))


class CommandLine(SphinxDirective):
    """The help text of one command."""

    optional_arguments = 2

    def run(self) -> list[nodes.Node]:
        """Ask the installed program."""
        command = [str(Path(sys.executable).parent / "tether"), *self.arguments, "--help"]
        plain = {**os.environ, "COLUMNS": "100", "TERMINAL_WIDTH": "100", "NO_COLOR": "1", "TERM": "dumb"}
        answer = subprocess.run(command, env=plain, capture_output=True, text=True, check=True)
        text = "\n".join(line.rstrip() for line in answer.stdout.strip().splitlines())
        return [nodes.literal_block(text, text, language="text")]


def configuration_lines(schema: Schema) -> list[str]:
    """The Markdown lines of the reference: the keys of the top level, then a part for each section."""
    definitions: dict[str, Schema] = schema.get("$defs", {})
    sections: list[str] = []
    plain: dict[str, Schema] = {}
    for key, field in schema["properties"].items():
        models = models_of(field, definitions)
        if not models:
            plain[key] = field
            continue
        is_array = field.get("type") == "array"
        for model in models:
            heading = f"[[{key}]]" if is_array else f"[{key}]"
            kind = model["properties"].get("kind", {}).get("const")
            sections += ["", f"## `{heading}`" + (f' with `kind = "{kind}"`' if kind else ""), ""]
            sections += [*prose(field), *prose(model), *table(model, definitions)]
    top = table({"properties": plain, "required": schema.get("required", [])}, definitions)
    return ["## Top level", "", *prose(schema), *top, *sections]


def models_of(field: Schema, definitions: dict[str, Schema]) -> list[Schema]:
    """The models that a key's value, or its elements, may be; none where the value is no table of its own."""
    if field.get("type") == "array":
        return models_of(field.get("items", {}), definitions)
    if "$ref" in field:
        model = definitions[field["$ref"].rsplit("/", 1)[-1]]
        return [model] if "properties" in model else []
    return [model for way in alternatives(field) for model in models_of(way, definitions)]


def alternatives(field: Schema) -> list[Schema]:
    """The ways that a value may be, where the schema names several."""
    return field.get("oneOf") or field.get("anyOf") or field.get("allOf") or []


def table(model: Schema, definitions: dict[str, Schema]) -> list[str]:
    """One row for each key: name, what it may be, default, meaning."""
    rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
    required = model.get("required", [])
    for key, field in model["properties"].items():
        default = "required" if key in required else default_of(field)
        cells = [f"`{key}`", kind_of(field, definitions), default, field.get("description", "")]
        rows.append("| " + " | ".join(" ".join(cell.replace("|", r"\|").split()) for cell in cells) + " |")
    return [*rows, ""]


def default_of(field: Schema) -> str:
    """The default as it would be written in a file."""
    value = field.get("default")
    if value is None:
        return "none"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, dict):
        pairs = ", ".join(f"{k} = {v}" for k, v in value.items() if v is not None)
        return f"`{{{pairs}}}`" if pairs else "`{}`"
    return f"`{value!r}`".replace("'", '"')


def kind_of(field: Schema, definitions: dict[str, Schema]) -> str:
    """The type of a value and its limits, in words."""
    if "$ref" in field:
        return kind_of(definitions[field["$ref"].rsplit("/", 1)[-1]], definitions)
    ways = alternatives(field)
    if ways:
        kinds = [kind_of(way, definitions) for way in ways if way.get("type") != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if "const" in field:
        return f'`"{field["const"]}"`'
    if "enum" in field:
        return ", ".join(f'`"{choice}"`' for choice in field["enum"])
    if field.get("type") == "array":
        element = kind_of(field.get("items", {}), definitions)
        fewest, most = field.get("minItems"), field.get("maxItems")
        number = f" of {fewest} to {most}" if fewest is not None and most is not None else ""
        return f"list{number}: {element}"
    kind = TYPES.get(field.get("type", ""), "any value")
    limits = [words.format(field[limit]) for limit, words in LIMITS.items() if limit in field]
    return ", ".join([kind, *limits])


def prose(schema: Schema) -> list[str]:
    """A description as a paragraph of its own."""
    return [schema["description"].strip(), ""] if schema.get("description") else []


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("study", StudyReference)
    app.add_directive("configuration", ConfigurationReference)
    app.add_directive("command-line", CommandLine)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
