"""Keeps BLAS on one thread; imported before NumPy by the benchmarks that measure processor time.

Threads of BLAS that wait for work would count.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
