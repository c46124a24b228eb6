"""The engines of the Fourier transforms: accuracy, bits, plans, the choice, and what results say of it."""

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import fft

import asperity as asp
from asperity import packages
from asperity.cli.main import main
from asperity.config.study import read_study
from asperity.engines import ENGINES, current_engine
from asperity.engines.ducc0_engine import Ducc0Engine
from asperity.engines.wisdom import read_wisdom
from asperity.errors import ConfigError
from asperity.packages import MissingPackageError
from asperity.pipeline.wisdom import lengths
from asperity.results import dataset
from asperity.spectral import Fourier, Grid
from asperity.stress.truncation import coarser_grids

pyfftw = pytest.importorskip("pyfftw")
pyfftw_engine = pytest.importorskip("asperity.engines.pyfftw_engine")

SOLID = asp.Layer(young=1.0, poisson=0.3)
BAND = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 0.125, "rms_height": 1e-3}
SURFACE = "surface --points 64 --hurst 0.8 --wavelength-long 0.5 --wavelength-short 0.125 --rms-height 0.001"


@pytest.fixture(scope="module")
def wisdom(tmp_path_factory):
    """File with measured plans for grids of 96² and 270² nodes."""
    path = tmp_path_factory.mktemp("wisdom") / "wisdom.json"
    path.write_text(asp.measure_wisdom([96, 270]))
    return path


def field(shape, dtype="float64"):
    return np.random.default_rng(5).normal(size=shape).astype(dtype)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("shape", [(96, 120), (65, 129), (37, 41)])
@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_errors_are_those_of_rounding(engine, shape, dtype):
    """Against a transform in extended precision by scipy; the rms error is 0.7 ε √(log₂ n) or less."""
    values = field(shape, dtype)
    exact = fft.rfft2(values.astype(np.longdouble), norm="forward")
    with asp.fft_engine(engine):
        fourier = Fourier(Grid(shape), dtype)
    found = fourier.forward(values)
    bound = 0.7 * np.finfo(dtype).eps * np.sqrt(np.log2(values.size))
    assert np.linalg.norm(found - exact) < bound * np.linalg.norm(exact)
    assert np.linalg.norm(fourier.inverse(found) - values) < 2 * bound * np.linalg.norm(values)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("nodes", [(5, 120), (40, 129)])
def test_rows_are_transformed_in_place_with_the_same_bits(engine, dtype, nodes):
    rows, columns = nodes
    grid = Grid((rows, columns))
    with asp.fft_engine(engine):
        fourier = Fourier(grid, dtype)
    draw = np.random.default_rng(1)
    memory = np.zeros((1, rows, 16 * (columns // 16 + 2)), dtype)
    coefficients = memory.view(fourier.complex)[:, :, : columns // 2 + 1]
    coefficients.real, coefficients.imag = draw.normal(size=(2, *coefficients.shape))
    expected = np.empty((1, rows, columns), dtype)
    fourier.inverse_along_x(coefficients.copy(), expected)
    fourier.inverse_along_x(coefficients, memory[:, :, :columns])
    np.testing.assert_array_equal(memory[:, :, :columns], expected)


@pytest.mark.parametrize("threads", [2, 3, 4])
@pytest.mark.parametrize("size", [270, 271])
def test_plans_have_the_same_bits_on_any_number_of_threads(wisdom, threads, size, monkeypatch):
    """With measured plans on 270² nodes, and estimated ones on others."""
    monkeypatch.setattr(pyfftw_engine, "_SMALL", 0)
    values = field((size, size))
    with asp.fft_engine("pyfftw", wisdom):
        one, many = Fourier(Grid(values.shape)), Fourier(Grid(values.shape), threads=threads)
    coefficients = one.forward(values)
    assert np.array_equal(coefficients, many.forward(values))
    assert np.array_equal(one.inverse(coefficients), many.inverse(coefficients))


BITS = """
import hashlib, sys
import numpy as np
import asperity as asp
from asperity.spectral import Fourier, Grid
values = np.random.default_rng(5).normal(size=(96, 96))
with asp.fft_engine("pyfftw", *sys.argv[1:]):
    print(hashlib.sha256(Fourier(Grid(values.shape)).forward(values)).hexdigest())
"""


def test_another_process_has_the_same_bits(wisdom):
    """With measured plans of one file and with estimated ones, whatever was planned before."""
    for arguments in ([str(wisdom)], []):
        found = subprocess.run(
            [sys.executable, "-c", BITS, *arguments], capture_output=True, text=True, check=True
        )
        with asp.fft_engine("pyfftw", *arguments):
            here = Fourier(Grid((96, 96))).forward(field((96, 96)))
        assert found.stdout.strip() == hashlib.sha256(here).hexdigest()


@pytest.mark.parametrize("offset", [0, 1, 3])
def test_the_place_of_an_array_in_memory_changes_no_bit(offset):
    """FFTW itself takes other instructions for arrays that are not aligned."""
    values = field((96, 96), "float32")
    room = np.zeros((96, 104), "float32")
    room[:, offset : offset + 96] = values
    with asp.fft_engine("pyfftw"):
        fourier = Fourier(Grid(values.shape), "float32")
    wide = np.zeros((96, 60), "complex64")
    coefficients = fourier.forward(values)
    found = fourier.forward(room[:, offset : offset + 96], out=wide[:, offset : offset + 49])
    assert np.array_equal(found, coefficients)
    assert np.array_equal(fourier.inverse(found), fourier.inverse(coefficients))


def wisdom_lines():
    """What FFTW knows of plans, in any order."""
    return {line for text in pyfftw.export_wisdom() for line in text.splitlines()}


def test_the_wisdom_of_others_is_neither_used_nor_lost():
    pyfftw.forget_wisdom()
    array = pyfftw.empty_aligned((96, 16), "complex128")
    pyfftw.FFTW(array, array, axes=(0,), flags=("FFTW_MEASURE",))
    kept = wisdom_lines()
    with asp.fft_engine("pyfftw"):
        Fourier(Grid((96, 100))).forward(field((96, 100)))
        asp.measure_wisdom([10])
    assert wisdom_lines() == kept


def test_plans_are_those_of_the_file(wisdom, monkeypatch):
    """FFTW is asked for measured plans of the grids in the file, and estimates the others."""
    asked, make = [], pyfftw.FFTW

    def recorded(*arrays, flags, **options):
        asked.append(flags[0])
        return make(*arrays, flags=flags, **options)

    monkeypatch.setattr(pyfftw, "FFTW", recorded)
    with asp.fft_engine("pyfftw", wisdom):
        known, unknown = Fourier(Grid((96, 96))), Fourier(Grid((112, 112)))
    known.inverse(known.forward(field((96, 96))))
    assert asked == 4 * ["FFTW_MEASURE"]
    unknown.inverse(unknown.forward(field((112, 112))))
    assert asked[4:] == 4 * ["FFTW_ESTIMATE"]


def test_engines_agree_on_contact_and_stress():
    height = asp.self_affine((64, 64), **BAND, seed=1)
    found = []
    for engine in ENGINES:
        with asp.fft_engine(engine):
            contact = asp.solve(height, SOLID, area_fraction=0.1, rtol=1e-10)
            stress = asp.analyse_stress(contact)
        assert contact.fft_engine.startswith(engine)
        assert contact.to_dataset().attrs["fft_engine"] == stress.attrs["fft_engine"] == contact.fft_engine
        found.append((contact, stress))
    (first, under_first), (second, under_second) = found
    assert np.abs(first.pressure - second.pressure).max() < 1e-8 * first.pressure.max()
    largest = [float(stress["largest_von_mises"].max()) for stress in (under_first, under_second)]
    assert largest[0] == pytest.approx(largest[1], rel=1e-6)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_everything_in_a_block_is_transformed_by_its_engine(boundary, monkeypatch):
    """Surface, contact, stress and its pictures on two threads, without one transform by the other engine."""

    def refuse(*arguments):
        raise AssertionError("a transform by ducc0")

    monkeypatch.delenv("ASPERITY_FFT_ENGINE", raising=False)
    monkeypatch.setattr(Ducc0Engine, "forward", refuse)
    monkeypatch.setattr(Ducc0Engine, "inverse", refuse)
    with asp.fft_engine("pyfftw"):
        height = asp.self_affine((32, 32), **BAND, seed=1)
        asp.roughness_parameters(height)
        contact = asp.solve(height, SOLID, area_fraction=0.1, boundary=boundary, threads=2)
        asp.analyse_stress(contact, threads=2)
        contact.section("x", depths=[0.0, 0.1])
    with pytest.raises(AssertionError, match="a transform by ducc0"):
        asp.roughness_parameters(height)


def test_the_choice_ends_with_its_block(monkeypatch):
    monkeypatch.delenv("ASPERITY_FFT_ENGINE", raising=False)
    assert current_engine().description.startswith("ducc0")
    with asp.fft_engine("pyfftw"):
        with asp.fft_engine("ducc0"):
            assert current_engine().description.startswith("ducc0")
        assert Fourier(Grid((4, 4))).engine.description.startswith("pyfftw")
        monkeypatch.setenv("ASPERITY_FFT_ENGINE", "ducc0")
        assert current_engine().description.startswith("pyfftw")
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "pyfftw")
    assert current_engine().description.startswith("pyfftw")


def test_wrong_choices_are_one_line(wisdom, tmp_path, monkeypatch):
    def refused(message, *arguments):
        with pytest.raises(ValueError, match=f"^{message}$"), asp.fft_engine(*arguments):
            pass

    refused("fft_engine = 'fftw': ducc0 or pyfftw is needed", "fftw")
    refused("wisdom = .*: accepted with the engine pyfftw only, not with ducc0", "ducc0", wisdom)
    refused(
        "wisdom = .*: cannot be read .*; a file of `asperity wisdom` is needed", "pyfftw", tmp_path / "none"
    )
    other = tmp_path / "other.json"
    for text in ("height", "[1]", '{"plans": {}}'):
        other.write_text(text)
        refused("wisdom = .*: a file of `asperity wisdom` is needed", "pyfftw", other)
    other.write_text(re.sub(r"fftw_wisdom #x\w+", "fftw_wisdom #x12345678", wisdom.read_text()))
    refused("wisdom = .*: measured with another FFTW or on another processor; .*", "pyfftw", other)
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "fast")
    with pytest.raises(ValueError, match=r"^ASPERITY_FFT_ENGINE = 'fast': ducc0 or pyfftw is needed$"):
        Fourier(Grid((4, 4)))
    with pytest.raises(ValueError, match=r"^lengths = 0: a whole number from 1 to"):
        asp.measure_wisdom([0])


MISSING = 'not installed: pyfftw; install with: pip install "asperity[fftw]"'


def test_without_pyfftw_its_choice_names_the_extra(monkeypatch, tmp_path):
    monkeypatch.setattr(packages, "find_spec", lambda name: None if name == "pyfftw" else name)
    for arguments in ((), (tmp_path / "wisdom.json",)):
        with (
            pytest.raises(MissingPackageError, match=f"^{re.escape(MISSING)}$"),
            asp.fft_engine("pyfftw", *arguments),
        ):
            pass
    mine = tmp_path / "mine.yaml"
    mine.write_text("{based_on: config/config.yaml, fft_engine: pyfftw}")
    with pytest.raises(ConfigError, match=f"^fft_engine = 'pyfftw': {re.escape(MISSING)}$"):
        read_study([mine])
    assert packages.absent() == []
    assert packages.install_command(["pyfftw", "matplotlib"]) == 'pip install "asperity[plot,fftw]"'


def test_commands_transform_by_the_engine_of_their_option(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("ASPERITY_FFT_ENGINE", raising=False)
    monkeypatch.chdir(tmp_path)

    def engine_in(path):
        return dataset.read(path).attrs["fft_engine"]

    assert main(["wisdom", "--points", "64", "--out", "wisdom.json"]) == 0
    digest = read_wisdom("wisdom.json").digest
    assert main(f"{SURFACE} --out s.nc --fft-engine pyfftw --fft-wisdom wisdom.json".split()) == 0
    assert engine_in("s.nc").endswith(f"wisdom {digest}")
    assert main(["solve", "s.nc", "--out", "c.nc", "--fft-engine", "pyfftw"]) == 0
    assert engine_in("c.nc").endswith("estimated plans")
    monkeypatch.setenv("ASPERITY_FFT_ENGINE", "pyfftw")
    assert main(["stress", "c.nc", "--out", "t.nc"]) == 0
    assert engine_in("t.nc").startswith("pyfftw")
    assert main(["stress", "c.nc", "--out", "t.nc", "--fft-engine", "ducc0"]) == 0
    assert engine_in("t.nc").startswith("ducc0")
    capsys.readouterr()
    assert main(["stress", "c.nc", "--out", "t.nc", "--fft-wisdom", "none.json"]) == 1
    assert capsys.readouterr().err.startswith("asperity: --fft-wisdom = 'none.json': ")


def test_plans_are_measured_for_the_coarser_grids_of_a_calculation_too():
    found = lengths(1024)
    assert {1024, 900, 768, 640, 512, 128} <= found
    assert found - {1024} == {g.shape[0] for g in coarser_grids(Grid((1024, 1024)))[1:] if g.shape[0] >= 128}
    assert lengths(64) == {64}


def test_every_process_of_the_tests_takes_the_engine_of_their_option():
    """`pytest --fft-engine` sets the environment variable, which other processes inherit."""
    command = [sys.executable, "-m", "pytest", "--fft-engine", "pyfftw", "-p", "no:cacheprovider"]
    tests = Path(__file__).with_name("test_spectral.py")
    found = subprocess.run(
        [*command, "--collect-only", f"{tests}::test_parseval"],
        capture_output=True,
        text=True,
        env=os.environ,
    )
    assert found.returncode == 0, found.stdout
    assert "test_parseval[shape0]" in found.stdout  # once, not with every engine
