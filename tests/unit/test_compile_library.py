"""All that numba compiles is compiled at once."""

import subprocess
import sys
from pathlib import Path

import asperity
from asperity.runtime.compiling import compiled_functions

ALL_AT_ONCE = """
from dataclasses import replace
from itertools import product

from asperity.runtime.compiling import PARTS, compiled_functions
from asperity.contact import METHODS
from asperity.validation.extremes import LEVELS, Scene, attempt
from asperity.config.presets import PRESETS
from asperity.accuracy.evaluation import Scene as Kind, evaluate
from asperity.accuracy.measurement import POISSON_RATIOS

def signatures():
    functions = compiled_functions().items()
    return {(name, str(each)) for name, function in functions for each in function.signatures}

for compile_part in PARTS.values():
    compile_part()
before = signatures()
for knobs, precision, height in product(PRESETS.values(), ("float32", "float64"), (0.5, 1.0)):
    if precision == "float32" and knobs.contact_tolerance < 1e-6:
        continue
    ratios = POISSON_RATIOS if height == 1.0 else (0.33,)
    scene = Kind(0.8, 1 / 4, 1 / 16, 0.1, layer_height=height, loads=(0.05,), poisson=ratios)
    evaluate(scene, replace(knobs, precision=precision), 1e-3)
for method, precision, bottom, imposed in product(
    METHODS, ("float32", "float64"), LEVELS["bottom"], (("load", 0.5), ("area", 1.0), ("approach", 0.999))
):
    attempt(Scene(method=method, precision=precision, bottom=bottom, scaled_height=1.0, imposed=imposed))
print(*sorted(signatures() - before), sep="\\n")
"""


def test_no_preset_precision_solver_or_control_needs_what_is_not_compiled():
    found = subprocess.run([sys.executable, "-c", ALL_AT_ONCE], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert not found.stdout.strip()


def test_every_module_that_imports_numba_is_looked_at():
    package = Path(asperity.__file__).parent
    found = {
        ".".join(("asperity", *path.relative_to(package).with_suffix("").parts))
        for path in package.rglob("*.py")
        if "import njit" in path.read_text(encoding="utf-8")
    }
    assert {name.rpartition(".")[0] for name in compiled_functions()} == found
    assert len(found) > 4
