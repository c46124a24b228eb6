"""Version of the package: results, reports and messages state it."""

__version__ = "0.2.0"
