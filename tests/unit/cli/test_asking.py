"""Commands, flags and calls as people guess them: they work, or one line names what is meant."""

import numpy as np
import pytest
from project import ROOT

import asperity as asp
from asperity.cli.main import main
from asperity.engineering.case import Case
from asperity.engineering.case_file import load_case
from asperity.engineering.jobs import arranged
from asperity.engineering.records import DISCRETISATION
from asperity.engineering.stages import answer_of
from asperity.engineering.templates import WORDS
from asperity.settings.model import described, entry_of
from asperity.surface.reading.container import maps_in

MAP = str(ROOT / "src/asperity/engineering/maps/ground_1.x3p")
ROLLER = {"hertz_pressure": "1 GPa", "radius_x": "5 mm", "radius_y": "inf"}
STEEL = {"young": "210 GPa", "poisson": 0.3}


def said(capsys, *words):
    with pytest.raises(SystemExit) as found:
        main(words)
    assert found.value.code == 2
    return capsys.readouterr().err


@pytest.mark.parametrize(
    ("flag", "meant"),
    [
        ("--film", "the key is film."),
        ("--leak", "leak."),
        ("--hertz", "did you mean --hertz-pressure?"),
        ("--mu", "did you mean --friction?"),
        ("--E", "did you mean --young?"),
        ("--spikes", "did you mean --despike?"),
        ("--residual-stress", "body.residual_stress"),
    ],
)
def test_a_guessed_flag_is_told_its_key(capsys, flag, meant):
    assert meant in said(capsys, "run", MAP, flag, "1")


@pytest.mark.parametrize(
    ("word", "meant"),
    [("seal", "asperity case seal"), (MAP, f"asperity run {MAP}"), ("compar", "compare?"), ("leak", "leak.")],
)
def test_a_guessed_command_is_told_another(capsys, word, meant):
    assert meant in said(capsys, word)


@pytest.mark.parametrize("key", WORDS)
def test_words_stand_for_keys_that_exist(key):
    assert entry_of(Case, key)
    assert described(Case)


def test_the_part_that_fits_into_a_hertz_contact_is_proposed_and_taken(capsys):
    load = ["--hertz-pressure", "1 GPa", "--radius-x", "5 mm", "--radius-y", "inf"]
    command = ["run", MAP, "--young", "210 GPa", "--poisson", "0.3", *load, "--check"]
    assert "--set map.crop=fit, which is 35 µm along x" in said(capsys, *command)
    assert main([*command, "--set", "map.crop=fit"]) == 0
    case = asp.Case(map={"file": MAP, "crop": "fit"}, body=STEEL, load=ROLLER)
    assert case.map.crop == ("1 m", "35 µm")
    with pytest.raises(asp.SettingsError, match=r"map\.crop = fit: needs a Hertz contact"):
        asp.Case(map={"file": MAP, "crop": "fit"}, body=STEEL, load={"mean_pressure": 1e6})


@pytest.mark.parametrize(
    ("crop", "shape"), [("20 um", (20, 20)), (["20 um", "8 um"], (20, 8)), ("20 um, 1 mm", (20, 32))]
)
def test_a_part_of_two_edges_is_cut(crop, shape):
    surface = asp.HeightMap(np.random.default_rng(1).normal(size=(48, 32)) * 1e-8, (48e-6, 32e-6), unit="m")
    options = asp.Case(map={"file": surface, "crop": crop}, body=STEEL, load={"mean_pressure": 1e6}).map
    assert surface.cropped(options.crop).height.shape == shape


def test_a_prepared_map_brings_its_grid_boundary_and_doubts():
    height = asp.self_affine((64, 64), 0.8, 1e-4, 2.5e-5, rms_height=1e-7, seed=1, length=2e-4)
    steel = asp.Solid(young=210e9, poisson=0.3)
    surface = asp.HeightMap(height, (2e-4, 2e-4), unit="m", name="ground")
    for periodic in ("mirrored", "none"):
        made = asp.prepare_map(surface, periodic=periodic)
        contact = asp.solve_contact(made, steel, mean_pressure=5e6)
        assert (contact.grid, contact.boundary) == (made.grid, made.boundary)
        assert "despike" not in repr(made)
    with pytest.raises(ValueError, match=r"^length: the edges of the map in m are needed"):
        asp.solve_contact(made.height, steel, mean_pressure=5e6)
    with pytest.raises(ValueError, match="not accepted with a map, which has its grid"):
        asp.solve_contact(made, steel, 1e-4, mean_pressure=5e6)
    height[3, 7] += 1e-5
    with pytest.warns(UserWarning, match="despike: 1 spike of"):
        made = asp.prepare_map(asp.HeightMap(height, (2e-4, 2e-4), unit="m"), periodic="mirrored")
    assert "despike: 1 spike of" in repr(made)
    assert made.doubts


def ground(count=48):
    height = asp.self_affine((count, count), 0.8, 1e-4, 2.5e-5, rms_height=3e-7, seed=1, length=2e-4)
    return asp.HeightMap(height, (2e-4, 2e-4), periodic=True, unit="m", name="ground")


def test_cracks_are_counted_on_the_area_of_the_track():
    """Cracks start independently: the probability on the track is that on the map, multiplied."""
    limits = STEEL | {"fatigue_torsion": "300 MPa", "fatigue_bending": "480 MPa"}
    asked = {"fatigue_scatter": 0.1, "fatigue_volume": "100 mm3", "area": "400000 um2"}
    answer = asp.run(ground(), limits, mean_pressure=50e6, cycles=asked)
    on_map, on_track = (answer[f"probability of no crack on the {of}"].value for of in ("map", "track"))
    assert on_track == pytest.approx(on_map**10, rel=1e-6)
    told = f" is {1 - on_track:.2g} on these pixels, ± not known"
    assert any(told in text for text in answer.verdict)
    with pytest.raises(asp.SettingsError, match=r"cycles\.area: requires fatigue_scatter"):
        asp.Case(map=ground(), body=limits, load={"mean_pressure": 1e6}, cycles={"area": "1 mm2"})


def test_a_material_without_fatigue_limits_is_named_with_the_numbers_that_remain():
    answer = asp.run(ground(), {"material": "100Cr6"}, mean_pressure=50e6, cycles={"shifts": 64})
    (told,) = [each.text for each in answer.warnings if each.subject == "fatigue limits"]
    assert "no fatigue limits of 100Cr6 are known: there are shear stress ranges and shakedown" in told


def test_errors_that_are_not_known_are_said_everywhere():
    """Below 200 nodes in contact; equal numbers have equal errors by the inputs."""
    steel = STEEL | {"young": "210 GPa ± 10 %", "yield_stress": "1 GPa"}
    answer = asp.run(ground(), steel, mean_pressure=9e6)
    table = answer.frame().set_index("quantity")
    for name in ("maximum pressure", "maximum von Mises stress", "rms gradient in contact"):
        assert "discretisation" in answer[name].unknown
        assert "discretisation: not known" in answer[name].text()
        assert "not known" in answer[name].best_text() or "± without" in answer[name].best_text()
        assert "discretisation" in table.loc[name, "not_known"]
    assert "not known" in " ".join(answer.verdict)
    assert all("the inputs" in answer[name].unknown for name in ("contact area", "contact area fraction"))
    volume, depth = (answer[f"volume above yield{of}"] for of in ("", " per area"))
    assert volume.error / volume.value == pytest.approx(depth.error / depth.value, rel=1e-9)
    assert answer["force"].errors == {}
    assert "discretisation" in asp.pool([answer])["maximum pressure"].unknown


def test_a_container_of_contact_engineering_is_a_sample(tmp_path, capsys):
    """Its maps become files beside it, with edges, unit and instrument; line scans are left out."""
    package = pytest.importorskip("SurfaceTopography")
    from SurfaceTopography.Container.IO import write_containers
    from SurfaceTopography.Container.SurfaceContainer import InMemorySurfaceContainer

    heights = ground(32).height * 1e9
    info = {"name": "../spot ä", "instrument": {"name": "GT-K", "type": "undefined", "parameters": {}}}
    maps = [package.Topography(heights.T * part, (2e5, 2e5), unit="nm", info=info) for part in (1.0, 0.9)]
    line = package.UniformLineScan(heights[0], 2e5, unit="nm", info=info)
    surface, path = InMemorySurfaceContainer([*maps, line]), str(tmp_path / "ring.zip")
    write_containers([surface], path)
    steel = ["--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "5 MPa", "--check"]
    assert main(["run", path, *steel]) == 0
    assert "2 maps, 32 × 32 nodes" in capsys.readouterr().out
    first, second = maps_in(path)
    assert main(["info", path]) == 0
    described = capsys.readouterr().out
    assert described.count("instrument: GT-K") == 2
    assert first in described
    assert second in described
    found = asp.read_map(first)
    np.testing.assert_allclose(
        found.height - found.height.mean(), 1e-9 * (heights - heights.mean()), atol=1e-15
    )
    assert (found.unit, "instrument: GT-K" in found.notes) == ("nm", True)
    assert found.length == pytest.approx((2e-4, 2e-4))
    (tmp_path / "case.yaml").write_text("map: ring.zip\nsample: {}\n")
    assert load_case(tmp_path / "case.yaml")["map"]["file"] == [first, second]
    write_containers([surface, surface], path)
    assert main(["run", path, *steel]) == 1
    assert "a container of one surface is needed, it holds 2" in capsys.readouterr().err


SOFT = {"young": "2 GPa", "poisson": 0.3}


@pytest.mark.parametrize(
    ("body", "groups", "refused"),
    [
        (SOFT, {"load": {"force": "2 N"}, "running_in": {"hardness": "20 MPa"}}, "running_in.hardness"),
        (
            SOFT | {"hardness": "1 MPa"},
            {"load": {"contact_area_fraction": 1.0}},
            "load.contact_area_fraction",
        ),
        (SOFT, {"load": {"mean_pressure": "1 MPa"}, "map": {"crop": ["30 um", "1 mm"]}}, "map"),
        (SOFT, {"load": {"contact_area_fraction": 1.0}, "sensitivity": {}}, "load.contact_area_fraction"),
        (SOFT | {"yield_stress": "30 MPa"}, {"load": {"mean_pressure": "1 MPa"}, "running_in": {}}, ""),
        (SOFT | {"yield_stress": "1 MPa"}, {"load": {"contact_area_fraction": 1.0}}, ""),
        (
            SOFT | {"yield_stress": "30 MPa"},
            {
                "load": {"mean_pressure": "1 MPa"},
                "sliding": {"friction": 0.5, "direction": "x"},
                "partial_slip": {"tangential_displacement": "1 mm"},
            },
            "",
        ),
        (
            SOFT | {"hardness": "60 MPa ± 20 %"},
            {"load": {"mean_pressure": "1 MPa"}, "running_in": {}, "film": {"load_fraction": 0.3}},
            "",
        ),
    ],
)
def test_the_check_refuses_all_that_a_run_refuses(body, groups, refused, tmp_path):
    """What is accepted is answered: sliding, full contact and running-in at the documented default, too."""
    np.save(tmp_path / "map.npy", ground(16).height)
    options = {"file": str(tmp_path / "map.npy"), "unit": "m", "physical_size": ["200 um", "200 um"]}
    content = groups | {"body": body, "map": options | {"periodic": "declared"} | groups.get("map", {})}
    (job,) = arranged([content], tmp_path / "out").jobs
    assert [each.key for each in job.problems] == ([refused] if refused else [])
    if not refused:
        assert answer_of(job.case, job.rough).records


@pytest.mark.parametrize(
    ("load", "key"),
    [
        ({}, "load"),
        ({"pressure": "1 MPa"}, "load"),
        (ROLLER, "load.radius_x"),
        ({"force": "90 N"}, "load.force"),
    ],
)
def test_settings_are_checked_before_a_map_is_treated(load, key, tmp_path, monkeypatch):
    """A load that is missing or misspelled is refused without the file, others by the edges of the map."""
    np.save(tmp_path / "map.npy", ground(16).height)
    monkeypatch.setattr("asperity.engineering.face.treat_map", None)
    options = {"unit": "m", "physical_size": ["200 um", "200 um"], "orientation": "peaks up"}
    content = {"map": {"file": str(tmp_path / "map.npy"), **options}, "body": STEEL | {"hardness": "2 GPa"}}
    (job,) = arranged([content | {"load": load}], tmp_path / "out", small=0).jobs
    assert any(each.key.startswith(key) for each in job.problems)
    assert job.rough is None


@pytest.mark.parametrize("name", ["map.npy", "body.x3p", "sample.csv"])
def test_the_name_of_a_file_is_no_key(name, capsys):
    command = ["run", name, "--young", "210 GPa", "--poisson", "0.3", "--mean-pressure", "1 MPa", "--check"]
    assert f"{name}: no such file" in said(capsys, *command)


def test_numbers_that_follow_from_each_other_have_one_relative_error():
    answer = asp.run(ground(128), STEEL, mean_pressure=400e6)
    names = ("contact area fraction", "contact area", "mean contact pressure")
    records = [answer[name] for name in names]
    relative = [each.errors[DISCRETISATION] / each.best for each in records]
    assert relative == pytest.approx([relative[0]] * 3, rel=1e-9)
    assert records[0].best * records[2].best == pytest.approx(400e6, rel=1e-9)
