"""Settings of all tests.

Hypothesis tries the same examples in every run (`make fuzz` tries random ones). Linear algebra runs on one
thread: on small matrices several threads only wait for each other. Tests of a module that share a fixture run
in one process, so that no other has to make it again.

`pytest --fft-engine pyfftw` runs all tests with this engine of the Fourier transforms, also in the processes
that they start. Without the option the engine is the default, and tests with the mark `engines` run
with each.

With several workers the library is compiled before they start, so that they do not compile it side by side.
"""

# ruff: noqa: E402  the environment is set before NumPy is imported

import os
import sys
from importlib.util import find_spec

# Read when NumPy is imported: with several threads sums are rounded in another order.
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import pytest
from hypothesis import settings

from asperity.core.system import compile_in_parallel, is_compiled
from asperity.fourier import ENGINES, fft_engine
from asperity.fourier.engine import VARIABLE

os.environ["MPLBACKEND"] = "agg"  # no screen
# The tests start a hundred processes, each of which would compile all modules to bytecode.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

settings.register_profile("deterministic", derandomize=True, deadline=None, database=None)
settings.load_profile("deterministic")


def pytest_addoption(parser):
    parser.addoption("--fft-engine", choices=ENGINES, help="engine of the Fourier transforms in all tests")


def pytest_make_parametrize_id(val):
    """Begin of a long text, in place of all of it, in the name of a test."""
    return ascii(val)[:60] if isinstance(val, (str, bytes)) and len(val) > 40 else None


def pytest_configure(config):
    if engine := config.getoption("--fft-engine"):
        os.environ[VARIABLE] = engine


def pytest_xdist_auto_num_workers():
    """One more than processors: tests of the study and of the page wait for processes of their own."""
    return (os.cpu_count() or 1) + 1


def pytest_sessionstart(session):
    has_workers = getattr(session.config.option, "numprocesses", None)
    if has_workers and not hasattr(session.config, "workerinput") and not is_compiled():
        compile_in_parallel()


def pytest_generate_tests(metafunc):
    """Run marked tests with every engine, the default first."""
    if metafunc.definition.get_closest_marker("engines") and not metafunc.config.getoption("--fft-engine"):
        metafunc.fixturenames.insert(0, "chosen_engine")
        metafunc.parametrize("chosen_engine", ENGINES, indirect=True, scope="module")


@pytest.fixture(scope="module")
def chosen_engine(request):
    if find_spec(request.param) is None:
        pytest.skip(f"{request.param} is not installed")
    with fft_engine(request.param):
        yield request.param


@pytest.fixture(scope="session", autouse=True)
def checked_answers():
    """Every answer that tests compute is checked for what holds in all answers (`answer_invariants`)."""
    from answer_invariants import violations

    import asperity.engineering.stages as stages

    made = stages.AnswerData

    def checked(*arguments):
        answer = made(*arguments)
        assert not (found := list(violations(answer))), found
        return answer

    stages.AnswerData = checked
    yield
    stages.AnswerData = made


@pytest.fixture
def without_pictures(monkeypatch):
    """Answers and samples are written without pictures, which take most of the time."""
    from samples import leave_pictures_out

    leave_pictures_out(monkeypatch)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Let one process run the tests of a module that share a fixture, unless they have a group already."""
    for item in items:
        shared = [defined[-1].scope for defined in item._fixtureinfo.name2fixturedefs.values()]
        if "module" in shared and item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(item.module.__name__))
