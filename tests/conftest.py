"""Settings of all tests.

Hypothesis tries the same examples in every run (`make fuzz` tries random ones). Linear algebra runs on one
thread: on small matrices several threads only wait for each other. Tests of a module that share a fixture run
in one process, so that no other has to make it again.
"""

import os

import pytest
from hypothesis import settings

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

settings.register_profile("deterministic", derandomize=True, deadline=None, database=None)
settings.load_profile("deterministic")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Let one process run the tests of a module that share a fixture, unless they have a group already."""
    for item in items:
        shared = [defined[-1].scope for defined in item._fixtureinfo.name2fixturedefs.values()]
        if "module" in shared and item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))
