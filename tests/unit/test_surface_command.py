"""``asperity surface``: the surface equals the library's, in cell lengths or in SI."""

import numpy as np
import pytest
from bad_input import BAND, SI_BAND

import asperity as asp
from asperity.cli.main import main
from asperity.results import dataset


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


def test_stages_in_si_are_those_of_the_study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, band, young in (("si", SI_BAND, ["--young", "210 GPa"]), ("study", BAND, [])):
        make(tmp_path, band).close()
        assert main(["solve", "s.nc", "--poisson", "0.3", *young, "--out", f"{name}_contact.nc"]) == 0
        assert main(["stress", f"{name}_contact.nc", "--out", f"{name}_stress.nc"]) == 0
        given = [f"{name}_stress.nc", "--contact", f"{name}_contact.nc"]
        assert main(["peaks", *given, "--out", f"{name}_peaks.nc"]) == 0
    modulus = 210e9 / (1 - 0.3**2)
    edge = float(dataset.read("si_contact.nc").attrs["cell_length"])
    for stage, units in {
        "contact": {"pressure": modulus, "gap": edge, "x": edge, "area_fraction": 1.0},
        "stress": {"peak_value": modulus, "peak_depth": edge, "covariance_depth": modulus**2},
        "peaks": {"peak_percentile": 1.0, "plane_depth": 1.0, "scaled_largest_von_mises": 1.0},
    }.items():
        si, study = (dataset.read(f"{name}_{stage}.nc") for name in ("si", "study"))
        assert si.attrs["unit_system"] == ("SI" if stage != "peaks" else study.attrs["unit_system"])
        for variable, unit in units.items():  # the tolerance of the contact is 1e-6
            np.testing.assert_allclose(si[variable] / unit, study[variable], rtol=1e-5, atol=1e-8)


def test_given_heights_at_one_spectrum(tmp_path, capsys):
    """From moments, a honed surface and a map, turned over and without its missing points."""
    gaussian = asp.self_affine((64, 64), 0.8, 0.25, 0.05, 1e-3, seed=1)
    heights = np.random.default_rng(1).gamma(2.0, size=(30, 40)) * 1e-6
    heights[3, 4] = np.nan
    np.savetxt(tmp_path / "map.csv", heights, delimiter=",")
    of_map = "--physical-size 3um 4um --unit m"
    level = asp.prepare_map(
        asp.HeightMap(heights, (3e-6, 4e-6)), periodic="none", undefined="harmonic"
    ).height
    for words, distribution in {
        "--skewness 0.5 --kurtosis 4 --keep-spectrum": {"moments": (0.5, 4.0)},
        "--plateau 0.2 0.6 60": {"plateau": (0.2, 0.6, 60.0)},
        f"--heights-of {tmp_path / 'map.csv'} {of_map}": {"sample": level[np.isfinite(heights)]},
    }.items():
        if "map" in words:
            with pytest.raises(AssertionError):
                make(tmp_path, f"{BAND} --points 64 {words}")
            assert "map.csv: --orientation: " in capsys.readouterr().err
        command = [
            *f"{BAND} --points 64 {words}".split(),
            *(["--orientation", "peaks up"] if "map" in words else []),
        ]
        assert main(["surface", *command, "--out", str(tmp_path / "shaped.nc")]) == 0
        surface, shaped = (
            dataset.read(tmp_path / "shaped.nc"),
            asp.surface.with_heights(gaussian, **distribution),
        )
        np.testing.assert_allclose(surface["height"], shaped.height, rtol=0, atol=1e-15)
        assert float(surface["heights_residual"]) == pytest.approx(shaped.heights_residual)
        assert "spectrum kept to" in capsys.readouterr().out
        surface.close()
