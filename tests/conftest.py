"""Settings of all tests.

Hypothesis tries the same examples in every run (`make fuzz` tries random ones). Linear algebra runs on one
thread: on small matrices several threads only wait for each other.
"""

import os

from hypothesis import settings

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

settings.register_profile("deterministic", derandomize=True, deadline=None, database=None)
settings.load_profile("deterministic")
