"""The quick study, from clean, as a user would run it; then its results, checked as results."""

import os
import re

import numpy as np
import pytest
import yaml
from project import QUICK, ROOT, copy_project, numbers, snakemake

import asperity as asp
from asperity.results import dataset


def read_all(folder, stage):
    paths = sorted((folder / "results/quick" / stage).rglob("*.nc"))
    assert paths
    return [dataset.read(path) for path in paths]


def test_it_takes_at_most_ninety_seconds_of_two_cores(second_study):
    """Processor time where the library is compiled, of a machine that imports its libraries in a second."""
    assert second_study.seconds < 2 * 90 * max(1.0, second_study.imports)


def test_every_figure_is_there_as_picture_and_as_vectors(quick_study):
    figures = quick_study.folder / "results/quick/figures"
    names = {path.name for path in figures.iterdir()}
    modules = {path.stem for path in (ROOT / "src/asperity/paper/figures").glob("fig*.py")}
    assert names >= {f"{module}{suffix}" for module in modules for suffix in (".png", ".pdf")}
    assert all(path.stat().st_size > 5000 for path in figures.iterdir() if path.suffix != ".rst")


def test_nothing_is_left_to_do_and_nothing_is_left_over(quick_study):
    again = snakemake(quick_study.folder, *QUICK, "--dry-run")
    assert "Nothing to be done" in again.stdout + again.stderr
    assert not list((quick_study.folder / "results").rglob("*.unfinished*"))


def test_a_changed_module_reruns_what_it_feeds_and_nothing_else(quick_study):
    module = quick_study.folder / "src/asperity/paper/figures/fig10.py"
    text, before = module.read_text(), module.stat()
    module.write_text(text + "\n")
    plan = snakemake(quick_study.folder, *QUICK, "--dry-run")
    module.write_text(text)
    os.utime(module, ns=(before.st_atime_ns, before.st_mtime_ns))
    jobs = [line.split() for line in (plan.stdout + plan.stderr).splitlines() if line.startswith("figure")]
    assert jobs
    assert jobs[0] == ["figure", "2"]  # of the paper's study and of the measured map
    assert "contact " not in plan.stdout + plan.stderr


def test_one_core_gives_the_same_numbers_and_the_same_pictures(quick_study, second_study):
    folder = second_study.folder
    files = [path.relative_to(folder) for path in sorted((folder / "results/quick").rglob("*.nc"))]
    assert len(files) > 25
    for file in files:
        assert numbers(folder / file).identical(numbers(quick_study.folder / file)), file
    written = [*(folder / "results/quick/figures").iterdir(), folder / "results/quick/claims.csv"]
    for path in written:
        assert path.read_bytes() == (quick_study.folder / path.relative_to(folder)).read_bytes()


def test_logs_hold_what_the_rules_said(quick_study):
    for stage in ("surface", "contact", "stress", "statistics"):
        logs = list((quick_study.folder / "results/quick/log" / stage).rglob("*.log"))
        assert logs
        assert all(": done after" in log.read_text() for log in logs)


def test_surfaces_have_the_height_and_the_spectrum_asked_for(quick_study):
    for surface in read_all(quick_study.folder, "surface"):
        asked = dataset.settings_of(surface)["surface"]
        if "file" in asked:
            continue
        assert float(surface.rms_height) == pytest.approx(asked["rms_height"], rel=1e-12)
        assert np.std(surface.height.values) == pytest.approx(asked["rms_height"], rel=1e-12)
        number = surface.wavenumber / (2 * np.pi)
        band = (number > 10) & (number < 0.97 / asked["wavelength_short"])
        drawn = surface.get("spectrum_before", surface.spectrum)  # a Johnson map moves some of it
        deviation = np.log(drawn / surface.spectrum_target).where(band, drop=True)
        assert abs(float(deviation.mean())) < 0.1  # statistics of one seed


def test_contacts_are_contacts(quick_study):
    for contact in read_all(quick_study.folder, "contact"):
        pressure, gap = contact.pressure.values, contact.gap.values
        tolerance = dataset.settings_of(contact)["contact"]["tolerance"]
        touching = pressure > 0
        length = np.ptp(contact.displacement.values)
        assert pressure.min() >= 0
        assert pressure.mean() == pytest.approx(float(contact.mean_pressure), rel=1e-10)
        assert np.abs(gap[touching]).max() < 100 * tolerance * length  # solver
        assert gap.min() > -100 * tolerance * length  # solver
        assert touching.mean() == pytest.approx(0.10, rel=2e-3)
        assert float(contact.area_fraction) == touching.mean()
        assert np.all(np.diff(contact.path_area_fraction) > 0)
        assert np.all(np.diff(contact.path_mean_pressure) > 0)
        proportionality = contact.path_area_fraction * contact.path_gradient_rms_contact
        kappa = (proportionality / contact.path_mean_pressure).values
        assert np.all((kappa > 1.5) & (kappa < 2.6))  # between about Persson's and Bush's


def test_peaks_lie_in_the_solid_and_planes_reach_its_bottom(quick_study):
    for stress in read_all(quick_study.folder, "stress"):
        assert stress.sizes["peak"] > 1000
        assert float(stress.peak_depth.min()) >= 0
        assert float(stress.peak_depth.max()) <= 1
        for position in (stress.peak_x, stress.peak_y):
            assert float(position.min()) >= 0
            assert float(position.max()) < 1
        assert stress.plane_depth.values[[0, -1]] == pytest.approx([0, 1])
        assert np.all(np.diff(stress.plane_points) <= 0)
        surface_peaks = stress.peak_depth.values[~stress.peak_interior.values]
        assert not surface_peaks.any()
        assert np.all(stress.covariance_plane.values[:, 0] > 0)


def test_densities_integrate_to_one_and_count_every_peak(quick_study):
    for statistics, stress in zip(
        read_all(quick_study.folder, "statistics"), read_all(quick_study.folder, "stress"), strict=True
    ):
        width = np.diff(statistics.bin_edge.values, axis=1)
        chosen = statistics.sel(selection="all")
        integral = (chosen.peak_density.values * width[:, None, :]).sum(axis=-1)
        np.testing.assert_allclose(integral, 1, rtol=1e-12)
        poisson = float(stress.poisson[0])
        for quantity in stress.quantity.values:
            expected = asp.peaks(stress, quantity, poisson).sizes["peak"]
            counted = chosen.peak_counts.sel(quantity=quantity, poisson=poisson)
            assert int(counted.sum()) == expected
        assert float((statistics.height_density * np.diff(statistics.height_edge)).sum()) == pytest.approx(1)


def test_every_file_tells_a_stranger_what_it_is(quick_study):
    for stage in ("surface", "contact", "stress", "statistics"):
        for data in read_all(quick_study.folder, stage):
            assert all(data.attrs[name] for name in ("title", "source", "references", "Conventions"))
            settings = dataset.settings_of(data)
            assert settings["surface"]["points"] in (128, 256)
            assert dataset.digest(settings) == data.attrs["settings_digest"]
            if stage in ("contact", "stress", "statistics"):
                assert data.attrs["solid"] == "half-space"
                assert data.attrs["uniform_mode"] == "laterally confined"
            assert not re.search(r"\d{4}-\d{2}-\d{2}|\d{2}:\d{2}:\d{2}", str(data.attrs))


@pytest.mark.parametrize(
    ("overlay", "line"),
    [
        ({"contact": {"tolerance": "1e-6"}}, "contact.tolerance = '1e-6': a number"),
        ({"surfaces": {"hurst_02": {"hurts": 0.2}}}, "surfaces.hurst_02.hurts: unknown key"),
        ({"layer": {"poisson": 0.6}}, "layer.poisson = 0.6: a number > -1 and ≤ 0.5"),
    ],
)
def test_a_bad_configuration_stops_before_any_rule_runs(tmp_path, overlay, line):
    folder = copy_project(tmp_path)
    (folder / "bad.yaml").write_text(yaml.safe_dump(overlay))
    run = snakemake(folder, "--configfile", "bad.yaml")
    assert run.returncode != 0
    assert f"config: {line}" in run.stderr
    assert "Traceback" not in run.stderr
    assert not (folder / "results").exists()
