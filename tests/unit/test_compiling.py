"""A command that compiles says so once and else nothing; machine code is not kept when it is outdated."""

import subprocess
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from pkgutil import walk_packages

from numba import njit
from numba.core.registry import CPUDispatcher

import asperity
from asperity.cli.compiling import compile_visibly
from asperity.machine_code import calls_other_modules


def test_compiling_is_said_in_one_line(capsys):
    @njit
    def twice(value):
        return value + value

    def small():
        assert twice(2) == 4
        assert twice(2.0) == 4.0

    compile_visibly("planes", small)
    said = capsys.readouterr()
    assert said.err == "asperity: compiling, at the first use only, about 30 s\n"
    compile_visibly("planes", small)
    assert capsys.readouterr().err == ""


def test_what_the_small_calculation_refuses_is_left_to_the_command(capsys):
    def small():
        raise ValueError("refused")

    compile_visibly("contact", small)
    assert capsys.readouterr().err == ""


def modules_with_compiled_functions():
    """Name and source of each, which is imported."""
    for module in walk_packages(asperity.__path__, "asperity."):
        if module.name != "asperity.__main__" and find_spec(module.name):
            source = Path(find_spec(module.name).origin).read_text()
            if "njit" in source or "from asperity.compiled import" in source:
                yield import_module(module.name), source


def test_code_compiled_with_functions_of_other_modules_is_discarded_when_these_change():
    needed, done = set(), set()
    for module, source in modules_with_compiled_functions():
        needed |= {module} if calls_other_modules(module.__name__) else set()
        done |= {module} if "discard_outdated(__name__)" in source else set()
    assert needed
    assert done == needed


def test_sums_in_any_order_are_inlined_where_other_loops_call_them():
    # Else two copies, which may add in different orders, would stand in the callee and in the caller.
    found = 0
    for module, _ in modules_with_compiled_functions():
        for function in vars(module).values():
            if isinstance(function, CPUDispatcher):
                for name in function.py_func.__code__.co_names:
                    called = function.py_func.__globals__.get(name)
                    options = called.targetoptions if isinstance(called, CPUDispatcher) else {}
                    if "reassoc" in (options.get("fastmath") or ()):
                        assert options.get("forceinline"), name
                        found += 1
    assert found


def test_only_outdated_code_of_callers_is_discarded(tmp_path):
    compiled = "from numba import njit\n"
    (tmp_path / "callee.py").write_text(f"{compiled}@njit(cache=True)\ndef factor():\n    return 2.0\n")
    (tmp_path / "caller.py").write_text(
        f"{compiled}from callee import factor\nfrom asperity.machine_code import discard_outdated\n"
        "@njit(cache=True)\ndef scaled(x):\n    return factor() * x\ndiscard_outdated(__name__)\n"
    )
    ask = [
        sys.executable,
        "-c",
        "from caller import scaled; print(scaled(1.0), scaled.stats.cache_hits.total())",
    ]

    def answer():
        return subprocess.run(ask, cwd=tmp_path, check=True, capture_output=True, text=True).stdout.split()

    assert answer() == ["2.0", "0"]
    assert answer() == ["2.0", "1"]
    # Of another length: Python takes a source of the same length and second for the same.
    (tmp_path / "callee.py").write_text((tmp_path / "callee.py").read_text().replace("2.0", "3.00"))
    assert answer() == ["3.0", "0"]
    assert answer() == ["3.0", "1"]
