"""The version of tether, as installed."""

from importlib.metadata import version

__version__ = version("tether")
