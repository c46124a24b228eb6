"""Version of the package: results, reports and messages state it."""

__version__ = "1.0.0"
