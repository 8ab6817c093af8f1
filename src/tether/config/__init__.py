"""Configurations: what a run is made from, read from TOML or built in Python."""

from tether.config.configuration import Configuration
from tether.config.measure import Measure, StopWhen
from tether.config.output import Interval, Output
from tether.config.reference import Reference
from tether.config.run import Run
from tether.config.schema import json_schema
from tether.config.source import Source, load
from tether.config.start import Start
from tether.config.template import template

__all__ = [
    "Configuration",
    "Interval",
    "Measure",
    "Output",
    "Reference",
    "Run",
    "Source",
    "Start",
    "StopWhen",
    "json_schema",
    "load",
    "template",
]
