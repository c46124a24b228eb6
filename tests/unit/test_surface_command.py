"""``asperity surface``: the surface is that of the library, in cell lengths or in SI."""

import numpy as np
import pytest

import asperity as asp
from asperity.cli.commands.surface import LENGTHS, POWERS
from asperity.cli.main import main
from asperity.config.presets import PRESETS
from asperity.results import dataset
from asperity.results.variables import units_of

BAND = "--hurst 0.8 --wavelength-long 0.25 --wavelength-short 0.05 --rms-height 0.001"
SI_BAND = "--hurst 0.8 --wavelength-long 20um --wavelength-short 4000nm --rms-height 8e-5mm --length 80um"


def make(folder, words):
    """The surface that the command makes."""
    path = folder / "s.nc"
    assert main(["surface", *words.split(), "--out", str(path)]) == 0
    return dataset.read(path)


def test_the_surface_is_that_of_the_library(tmp_path, capsys):
    surface = make(tmp_path, f"{BAND} --points 64 --seed 7")
    expected = asp.self_affine((64, 64), 0.8, 0.25, 0.05, 1e-3, seed=7)
    assert np.array_equal(surface["height"].values, expected)
    assert dataset.settings_of(surface)["seed"] == 7
    line = capsys.readouterr().out
    assert "64 × 64 nodes, rms height 0.001 cell lengths, rms gradient" in line
    assert line.startswith(str(tmp_path))


def test_lengths_with_units_make_the_same_surface_in_metres(tmp_path, capsys):
    plain, si = make(tmp_path, f"{BAND} --points 64"), make(tmp_path, f"{SI_BAND} --points 64")
    assert si.attrs["unit_system"] == "SI"
    for name in plain.variables:
        factor = 80e-6 ** POWERS.get(str(name), 0)
        assert np.allclose(si[name].values, factor * plain[name].values, rtol=1e-12, atol=0), name
    settings = dataset.settings_of(si)["surface"]
    assert [settings[name] for name in (*LENGTHS, "length")] == pytest.approx([20e-6, 4e-6, 80e-9, 80e-6])
    assert "rms height 80 nm" in capsys.readouterr().out
    again = asp.self_affine((64, 64), 0.8, 20e-6, 4e-6, 80e-9, seed=1, length=80e-6)
    assert np.allclose(si["height"].values, again, rtol=0, atol=1e-18)


def test_powers_of_length_are_those_of_the_units_of_the_study(tmp_path):
    surface = make(tmp_path, BAND)
    words = {"cell_length": 1, "1/cell_length": -1, "cell_length^4": 4}
    found = {str(name): words.get(units_of(str(name)), 0) for name in surface.variables}
    assert found == {name: POWERS.get(name, 0) for name in found}


def test_without_points_the_grid_is_that_of_the_default_preset(tmp_path):
    assert make(tmp_path, BAND).sizes["x"] == PRESETS["paper"].points(0.05)


def test_skewness_and_kurtosis_are_those_asked_for(tmp_path):
    surface = make(
        tmp_path,
        "--hurst 0.8 --wavelength-long 0.05 --wavelength-short 0.02 --rms-height 0.001 "
        "--points 256 --skewness -0.5 --kurtosis 3.5",
    )
    assert float(surface["skewness"]) == pytest.approx(-0.5, abs=0.1)
    assert float(surface["kurtosis"]) == pytest.approx(3.5, abs=0.25)


def test_a_surface_in_si_is_not_taken_for_one_in_cell_lengths(tmp_path, capsys):
    make(tmp_path, SI_BAND)
    assert main(["solve", str(tmp_path / "s.nc"), "--out", str(tmp_path / "c.nc")]) == 1
    assert "in SI units; a result in cell lengths" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (f"{BAND} --length 80", "--length = '80': a number with a unit of length"),
        (f"{BAND} --length 80um", "--wavelength-long = '0.25': a number with a unit of length"),
        (BAND.replace("0.05", "2um"), "--wavelength-short = '2um': a number in cell lengths is needed, or"),
        (BAND.replace("0.05", "0"), "--wavelength-short = '0': a number ≥ 6.103515625e-05 and ≤ 1, in cell"),
        (BAND.replace("0.05", "nan"), "--wavelength-short = 'nan': a number ≥"),
        (
            BAND.replace("0.05", "0.5"),
            "--wavelength-short = '0.5': at most --wavelength-long = 0.25 is needed",
        ),
        (SI_BAND.replace("4000nm", "1nm"), "--wavelength-short = '1nm', 1.25e-05 of --length: a number ≥"),
        (
            f"{SI_BAND} --points 16",
            "--points = 16: at least 40 are needed, two on --wavelength-short = 4000nm",
        ),
        (f"{BAND} --skewness 1", "--skewness, --kurtosis: both are needed, or none of them"),
        (f"{BAND} --skewness 1 --kurtosis 2", "--kurtosis = 2: a number > 2, 1 + skewness², is needed"),
        (BAND.replace("0.05", "1e-4"), "--points: the default, 80000, is more than 32768"),
    ],
)
def test_the_command_refuses_in_one_line(tmp_path, capsys, words, message):
    assert main(["surface", *words.split(), "--out", str(tmp_path / "s.nc")]) == 1
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())
