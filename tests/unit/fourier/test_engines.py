"""The engines of the Fourier transforms: accuracy, bits, the choice, and what results say of it."""

import hashlib
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from samples import HALF_SPACE, rough
from scipy import fft

import asperity as asp
from asperity.cli.main import main
from asperity.core import packages
from asperity.core.errors import InputError
from asperity.core.packages import MissingPackageError
from asperity.fourier import ENGINES, current_engine
from asperity.fourier.grid import Fourier, Grid
from asperity.settings.study import read_study

pyfftw = pytest.importorskip("pyfftw")


def field(shape, dtype="float64"):
    return np.random.default_rng(5).normal(size=shape).astype(dtype)


def fourier_of(engine, shape, dtype="float64"):
    with asp.fft_engine(engine):
        return Fourier(Grid(shape), dtype)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("shape", [(96, 120), (65, 129), (37, 41)])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_errors_are_those_of_rounding(engine, shape, dtype):
    """Against a transform in extended precision by scipy; the rms error is 0.7 ε √(log₂ n) or less."""
    values = field(shape, dtype)
    exact = fft.rfft2(values.astype(np.longdouble), norm="forward")
    fourier = fourier_of(engine, shape, dtype)
    found = fourier.forward(values)
    bound = 0.7 * np.finfo(dtype).eps * np.sqrt(np.log2(values.size))
    assert np.linalg.norm(found - exact) < bound * np.linalg.norm(exact)
    assert np.linalg.norm(fourier.inverse(found) - values) < 2 * bound * np.linalg.norm(values)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("nodes", [(5, 120), (40, 129)])
def test_rows_in_place_have_the_same_bits(engine, dtype, nodes):
    rows, columns = nodes
    fourier = fourier_of(engine, nodes, dtype)
    memory = np.zeros((1, rows, 16 * (columns // 16 + 2)), dtype)
    coefficients = memory.view(fourier.coefficient_type)[:, :, : columns // 2 + 1]
    coefficients.real, coefficients.imag = field((2, *coefficients.shape))
    expected = np.empty((1, rows, columns), dtype)
    fourier.engine.inverse_along_x(coefficients.copy(), expected)
    fourier.engine.inverse_along_x(coefficients, memory[:, :, :columns])
    np.testing.assert_array_equal(memory[:, :, :columns], expected)


BITS = """
import hashlib
import numpy as np
from asperity.fourier import fft_engine
from asperity.fourier.grid import Fourier, Grid
values = np.random.default_rng(5).normal(size=(96, 96))
with fft_engine("pyfftw"):
    print(hashlib.sha256(Fourier(Grid(values.shape)).forward(values)).hexdigest())
"""


@pytest.mark.parametrize("cache", ["kept", "damaged", "none"])
def test_plans_of_another_process_give_the_same_bits(cache, tmp_path):
    """A damaged file of plans is replaced; a folder that cannot be made is left out."""
    here = fourier_of("pyfftw", (96, 96)).forward(field((96, 96)))
    kept = {"XDG_CACHE_HOME": str(tmp_path)} if cache != "kept" else {}
    if cache == "none":
        (tmp_path / "asperity").write_text("in the way")
    elif cache == "damaged":
        (tmp_path / "asperity").mkdir()
        (tmp_path / f"asperity/fftw_wisdom_{pyfftw.__version__}.json").write_text("{")
    environment = os.environ | kept
    found = subprocess.run([sys.executable, "-c", BITS], env=environment, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    if cache == "kept":
        assert found.stdout.strip() == hashlib.sha256(here).hexdigest()


@pytest.mark.parametrize(("boundary", "mirrored"), [("periodic", False), ("free", False), ("periodic", True)])
def test_engines_agree_on_contact_and_stress(boundary, mirrored, monkeypatch):
    """In a block of another engine, on two threads, ducc0 is not imported."""

    def run():
        height, grid = rough((32, 32)), Grid((32, 32), mirrored=mirrored)
        settings = {"mean_pressure": 1e-3, "boundary": boundary, "rtol": 1e-10, "threads": 2}
        contact = asp.solve_contact(height, HALF_SPACE, grid, **settings)
        asp.stress_section(contact, "x", depths=[0.0, 0.1])
        contact.to_dataset()  # with the gradient, which this engine computes
        return contact, asp.analyse_stress(contact, threads=2)

    found = []
    for engine in ENGINES:
        with asp.fft_engine(engine):
            found.append(run())
        monkeypatch.setitem(sys.modules, "ducc0", None)
    for engine, (contact, stress) in zip(ENGINES, found, strict=True):
        assert contact.fft_engine.startswith(engine)
        assert contact.to_dataset().attrs["fft_engine"] == stress.attrs["fft_engine"] == contact.fft_engine
    pressures = [contact.pressure for contact, _ in found]
    assert np.ptp(pressures, axis=0).max() < 1e-8 * pressures[0].max()
    largest = [float(stress["maximum_von_mises"].max()) for _, stress in found]
    assert largest == pytest.approx(3 * largest[:1], rel=1e-6)


def test_choice_ends_with_its_block(monkeypatch):
    """An inner block is stronger than an outer one, and both than the environment variable."""
    monkeypatch.delenv("ASPERITY_FFT_ENGINE", raising=False)
    assert current_engine().description.startswith("ducc0")
    with asp.fft_engine("pyfftw"):
        with asp.fft_engine("ducc0"):
            assert current_engine().description.startswith("ducc0")
        monkeypatch.setenv("ASPERITY_FFT_ENGINE", "ducc0")
        assert current_engine().description.startswith("pyfftw")
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "pyfftw")
    assert current_engine().description.startswith("pyfftw")
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "fast")
    message = "^{} = 'fast': ducc0 or pyfftw or scipy is needed$"
    with pytest.raises(ValueError, match=message.format("ASPERITY_FFT_ENGINE")):
        Fourier(Grid((4, 4)))
    with pytest.raises(ValueError, match=message.format("fft_engine")), asp.fft_engine("fast"):
        pass


@pytest.mark.parametrize(("engine", "package"), [("pyfftw", '"asperity[fftw]"'), ("ducc0", "asperity")])
def test_missing_engine_names_the_package(monkeypatch, tmp_path, engine, package):
    missing = f"not installed: {engine}; install with: pip install {package}"
    monkeypatch.setattr(packages, "find_spec", lambda name: None if name == engine else name)
    with pytest.raises(MissingPackageError, match=f"^{re.escape(missing)}$"), asp.fft_engine(engine):
        pass
    mine = tmp_path / "mine.yaml"
    mine.write_text("{based_on: config/config.yaml, fft_engine: " + engine + "}")
    with pytest.raises(InputError, match=f"^fft_engine = '{engine}': {re.escape(missing)}$"):
        read_study([mine])


def test_commands_transform_by_the_chosen_engine(chain, monkeypatch):
    """The option is stronger than the environment variable."""
    used = []
    monkeypatch.setattr(
        "asperity.cli.commands.verify.run", lambda _: used.append(current_engine().description)
    )
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "pyfftw")
    for option in ([], ["--fft-engine", "ducc0"]):
        assert main(["verify", chain["contact"], *option]) == 0
    assert [engine.split()[0] for engine in used] == ["pyfftw", "ducc0"]
