"""The JSON schema of configuration files, with which editors complete and check them."""

from __future__ import annotations

from typing import Any

from tether.config.configuration import Configuration


def json_schema() -> dict[str, Any]:
    """The schema, JSON Schema draft 2020-12; its descriptions are the reference documentation."""
    schema = without_null(Configuration.model_json_schema())
    for table in schema["$defs"].values():
        # Python knows a flow by its class, which gives the kind; a file has to name it.
        if "const" in table.get("properties", {}).get("kind", {}):
            table["required"] = ["kind", *table.get("required", [])]
    for key in schema["$defs"]["Measure"]["properties"].values():
        if "$ref" in key and key.get("examples") == [True]:
            key["anyOf"] = [{"$ref": key.pop("$ref")}, {"type": "boolean"}]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "tether configuration",
    }


def without_null(schema: Any) -> Any:
    """TOML has no null: a key that may be left out has no value then."""
    if isinstance(schema, list):
        return [without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    cleaned = {name: without_null(item) for name, item in schema.items() if item is not None}
    choices = [choice for choice in cleaned.get("anyOf", []) if choice != {"type": "null"}]
    if len(choices) == 1:
        del cleaned["anyOf"]
        return {**choices[0], **cleaned}
    return {**cleaned, "anyOf": choices} if choices else cleaned
