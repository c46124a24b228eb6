"""Rule machine_code compiles every function that numba compiles, with all types that a study uses."""

import re
import subprocess
import sys
from pathlib import Path

import asperity
from asperity.runtime.compiling import compiled_functions

ALL_SETTINGS = """
from itertools import product

import asperity as asp
from asperity.contact import METHODS
from asperity.runtime.compiling import PARTS, compiled_functions

def signatures():
    functions = compiled_functions().items()
    return {(name, str(each)) for name, function in functions for each in function.signatures}

for compile_part in PARTS.values():
    compile_part()
before = signatures()
height = asp.self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=2)
layers = [asp.Layer(1.0, 0.33), asp.Layer(1.0, 0.5)]
layers += [
    asp.Layer(1.0, 0.33, height=thickness, bottom=bottom)
    for thickness, bottom in product((1e-4, 0.5, 1.0), ("bonded", "frictionless", "free"))
]
controls = [{"area_fraction": part} for part in (0.05, 1.0)]
controls += [{"mean_pressure": load} for load in (1e-4, 1.0)]
controls += [{"approach": part * float(height.min())} for part in (0.5, 0.001)]
for layer, method, precision, control in product(layers, METHODS, ("float32", "float64"), controls):
    try:
        contact = asp.solve(height, layer, **control, method=method, dtype=precision, rtol=1e-4)
    except (ValueError, asp.ConvergenceError):  # a free layer carries no load
        continue
    if method == "active_set" and control == controls[0] and layer.bottom != "free":
        ratios = None if layer.height else (0.0, 0.33, 0.5)
        for tolerance in (1e-2, 1e-4, 1e-6):
            asp.analyse_stress(contact, poisson=ratios, tolerance=tolerance)
print(*sorted(signatures() - before), sep="\\n")
"""


def test_solvers_precisions_layers_and_controls_need_no_further_compilation():
    found = subprocess.run([sys.executable, "-c", ALL_SETTINGS], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert not found.stdout.strip()


def test_every_module_that_imports_numba_is_compiled():
    package = Path(asperity.__file__).parent
    found = {
        ".".join(("asperity", *path.relative_to(package).with_suffix("").parts))
        for path in package.rglob("*.py")
        if re.search("import njit|from asperity.compiled import", path.read_text(encoding="utf-8"))
    } - {"asperity.compiled"}  # the decorators
    assert {name.rpartition(".")[0] for name in compiled_functions()} == found
    assert len(found) > 4
