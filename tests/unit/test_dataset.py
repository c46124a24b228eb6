"""Result files are complete, described and checked."""

import errno
import zipfile

import netCDF4
import numpy as np
import pytest
import xarray as xr

from asperity.errors import DatasetError, NewerFileError
from asperity.results import dataset
from asperity.results.variables import SI_UNITS, STAGES, STUDY_UNITS, UNIT_SYSTEMS, VARIABLES, units_of


@pytest.fixture
def surface():
    rng = np.random.default_rng(1)
    return xr.Dataset(
        {"height": (("y", "x"), rng.normal(size=(40, 30))), "rms_height": 1.0},
        coords={"y": np.arange(40.0), "x": np.arange(30.0)},
        attrs={"decision": "half-space"},
    )


SETTINGS = {"seed": 3, "surface": {"hurst": 0.8}}


def test_a_file_explains_itself_and_comes_back_equal(surface, tmp_path):
    path = tmp_path / "deep" / "file.nc"
    dataset.write(surface, path, "A surface", SETTINGS)
    found = dataset.read(path)
    xr.testing.assert_equal(found, surface)
    assert dataset.settings_of(found) == SETTINGS
    assert found.attrs["title"] == "A surface"
    assert found.attrs["Conventions"].startswith("CF-")
    assert found.attrs["source"].startswith("asperity ")
    assert found.attrs["decision"] == "half-space"
    assert found.attrs["settings_digest"] == dataset.digest(SETTINGS)
    for name, variable in found.variables.items():
        assert variable.attrs["units"] == units_of(name)
        assert variable.attrs["long_name"] == VARIABLES[name].long_name


def test_a_file_in_a_newer_format_is_refused_and_not_called_damaged(surface, tmp_path, monkeypatch):
    path = tmp_path / "file.nc"
    with monkeypatch.context() as newer:
        newer.setattr(dataset, "FORMAT_VERSION", dataset.FORMAT_VERSION + 1)
        dataset.write(surface, path, "Title", SETTINGS)
        assert dataset.read(path).attrs["format_version"] == dataset.FORMAT_VERSION
    for function in (dataset.read, dataset.verify):
        with pytest.raises(
            NewerFileError, match=r"format_version = 2, at most 1 is read by asperity [^;]*; install"
        ):
            function(path)


def test_a_file_without_a_format_version_is_in_the_first_format(surface, tmp_path):
    dataset.write(surface, tmp_path / "a.nc", "Title", SETTINGS)
    older = xr.load_dataset(tmp_path / "a.nc")
    del older.attrs["format_version"]
    older.attrs["content_digest"] = dataset.fingerprint(older)
    older.to_netcdf(tmp_path / "b.nc")
    xr.testing.assert_equal(dataset.read(tmp_path / "b.nc"), surface)


def test_every_dimension_has_a_unit_in_every_system():
    for system in UNIT_SYSTEMS:
        for name in VARIABLES:
            assert units_of(name, system)


def test_units_follow_the_unit_system_of_the_file(surface, tmp_path):
    for system, length, stress in ((SI_UNITS, "m", "Pa"), (STUDY_UNITS, "cell_length", "effective_modulus")):
        data = surface.assign(mean_pressure=5e7).assign_attrs(unit_system=system)
        dataset.write(data, tmp_path / "file.nc", "Title", SETTINGS)
        found = dataset.read(tmp_path / "file.nc")
        assert found.attrs["unit_system"] == system
        assert [found[name].attrs["units"] for name in ("x", "height", "mean_pressure")] == [
            length,
            length,
            stress,
        ]
        xr.testing.assert_equal(found, data)


def test_a_file_without_a_unit_system_is_in_units_of_the_study(surface):
    assert dataset.unit_system(surface) == STUDY_UNITS


def test_an_unknown_unit_system_is_refused(surface, tmp_path):
    with pytest.raises(ValueError, match="imperial"):
        dataset.write(surface.assign_attrs(unit_system="imperial"), tmp_path / "a.nc", "Title", SETTINGS)
    dataset.write(surface, tmp_path / "a.nc", "Title", SETTINGS)
    relabelled = xr.load_dataset(tmp_path / "a.nc").assign_attrs(unit_system=SI_UNITS)
    relabelled.to_netcdf(tmp_path / "b.nc")
    with pytest.raises(DatasetError, match="'cell_length', 'm' expected"):
        dataset.read(tmp_path / "b.nc")


@pytest.mark.parametrize("stage", STAGES)
def test_the_file_of_a_stage_says_what_the_stage_makes(tmp_path, stage):
    data = xr.Dataset({STAGES[stage].variable: 1.0})
    assert dataset.stage_of(data) == stage
    dataset.write(data, tmp_path / "file.nc", "Title", SETTINGS)
    found = dataset.read(tmp_path / "file.nc")
    assert found.attrs["summary"] == STAGES[stage].summary
    assert "effective_modulus is E/(1 - nu^2)" in found.attrs["comment"]


def test_text_and_truth_values_come_back_without_units(tmp_path):
    names, flags = np.array(["xx", "von_mises", "", "σ"]), np.array([True, False, True, True])
    data = xr.Dataset({"peak_interior": ("peak", flags)}, coords={"peak_quantity": ("peak", names)})
    dataset.write(data, tmp_path / "file.nc", "Title", SETTINGS)
    found = dataset.read(tmp_path / "file.nc")
    assert found["peak_interior"].dtype == bool
    assert found["peak_quantity"].values.tolist() == names.tolist()
    assert all("units" not in variable.attrs for variable in found.variables.values())
    dataset.verify(tmp_path / "file.nc")


def test_fields_that_hardly_shrink_are_stored_as_they_are(tmp_path):
    noise = np.random.default_rng(1).normal(size=(200, 200))
    fields = {"height": noise, "displacement": noise, "gap": noise, "pressure": np.maximum(noise - 1, 0)}
    data = xr.Dataset({name: (("y", "x"), values) for name, values in fields.items()})
    dataset.write(data, tmp_path / "a.nc", "Title", SETTINGS)
    with netCDF4.Dataset(tmp_path / "a.nc") as file:
        filters = {name: file[name].filters() for name in fields}
    assert {name for name, used in filters.items() if used["zlib"]} == {"pressure"}
    assert all(used["fletcher32"] for used in filters.values())


def test_the_digest_is_of_the_values_not_of_their_order():
    assert (
        dataset.digest({"a": 1, "b": 2})
        == dataset.digest({"b": 2, "a": 1})
        != dataset.digest({"a": 2, "b": 1})
    )


def test_nothing_is_left_of_a_write_that_fails(surface, tmp_path, monkeypatch):
    path = tmp_path / "file.nc"
    dataset.write(surface, path, "Before", SETTINGS)
    before = path.read_bytes()

    def fail(self, target, **_):
        target.write_bytes(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(DatasetError, match=r"file\.nc: cannot be written \(the disk is full\); free"):
        dataset.write(surface, path, "After", SETTINGS)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_variable_without_a_description_is_refused(surface, tmp_path):
    with pytest.raises(KeyError, match="heigth"):
        dataset.write(surface.rename(height="heigth"), tmp_path / "file.nc", "Typing error", SETTINGS)


def damage_end(path):
    path.write_bytes(path.read_bytes()[:-500])


def damage_empty(path):
    path.write_bytes(b"")


def damage_byte(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 255
    path.write_bytes(content)


def damage_units(path):
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file["height"].units = "furlong"


def damage_value(path):
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file["height"][3, 4] += 1e-9


def damage_scalar(path):
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file["rms_height"][...] = 2.0


def damage_settings(path):
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file.settings = file.settings.replace("0.8", "0.2")


DAMAGES = [damage_end, damage_empty, damage_byte, damage_units, damage_value, damage_scalar, damage_settings]


UNREADABLE = (damage_end, damage_empty)


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_is_named_with_a_remedy(surface, tmp_path, damage):
    path = tmp_path / "file.nc"
    dataset.write(surface, path, "A surface", SETTINGS)
    damage(path)
    with pytest.raises(DatasetError, match=r"file\.nc: .*; delete it and run again$"):
        dataset.verify(path)
    with pytest.raises(DatasetError, match=r"file\.nc: ") as error:
        dataset.read(path)
    # A file that cannot be opened may be anything.
    assert ("delete it" in str(error.value)) == (damage not in UNREADABLE)


def raw_text(path):
    path.write_text("1.0 2.0\n3.0 4.0\n")


def raw_archive(path):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", "<p:ISO5436_2/>")


def raw_netcdf(path):
    xr.Dataset({"topography": (("y", "x"), np.eye(3))}, attrs={"instrument": "profiler"}).to_netcdf(path)


@pytest.mark.parametrize(
    ("name", "make"), [("map.asc", raw_text), ("steel.x3p", raw_archive), ("steel.nc", raw_netcdf)]
)
def test_nobody_is_told_to_delete_data_of_their_own(tmp_path, name, make):
    path = tmp_path / name
    make(path)
    with pytest.raises(DatasetError, match=f"{name}: .*not a result of asperity") as error:
        dataset.read(path)
    assert "delete it" not in str(error.value)


def test_every_flipped_byte_is_seen_or_changes_nothing(surface, tmp_path):
    path = tmp_path / "file.nc"
    dataset.write(surface, path, "A surface", SETTINGS)
    content, whole = path.read_bytes(), dataset.read(path)
    seen = 0
    for position in np.random.default_rng(1).choice(len(content), 40, replace=False):
        damaged = bytearray(content)
        damaged[position] ^= 1 << position % 8
        path.write_bytes(damaged)
        try:
            found = dataset.read(path)
        except DatasetError:
            seen += 1
        else:
            assert found.identical(whole)
    assert seen > 10  # most bytes are data


def test_a_file_is_checked_some_rows_at_a_time(surface, tmp_path, monkeypatch):
    path = tmp_path / "file.nc"
    dataset.write(surface, path, "A surface", SETTINGS)
    monkeypatch.setattr(dataset, "MAX_BLOCK", 1000)
    dataset.verify(path)
    assert dataset.read(path).attrs[dataset.FINGERPRINT] == dataset.fingerprint(dataset.read(path))


def test_what_a_killed_process_left_is_swept_and_what_a_living_one_writes_is_not(surface, tmp_path):
    path = tmp_path / "file.nc"
    dead, alive = (tmp_path / f".file.nc.{process}.unfinished" for process in (2**22 + 1, 1))
    dead.write_bytes(b"half")
    alive.write_bytes(b"half")
    dataset.write(surface, path, "A surface", SETTINGS)
    assert set(tmp_path.iterdir()) == {path, alive}


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(DatasetError, match=r"absent\.nc: no such file"):
        dataset.read(tmp_path / "absent.nc")


def test_a_file_in_si_units_says_so_and_is_read_again(tmp_path):
    data = xr.Dataset({"pressure": (("y", "x"), np.ones((2, 2))), "approach": 1e-6}).assign_attrs(
        unit_system="SI"
    )
    dataset.write(data, tmp_path / "si.nc", "contact", {})
    found = dataset.read(tmp_path / "si.nc")
    assert found.attrs["unit_system"] == "SI"
    assert (found["pressure"].units, found["approach"].units) == ("Pa", "m")
    assert (units_of("load_spectral", "SI"), units_of("wavenumber", "SI")) == ("N", "m-1")
    with pytest.raises(ValueError, match=r"^unit_system = 'imperial': one of cell length and"):
        dataset.write(data.assign_attrs(unit_system="imperial"), tmp_path / "bad.nc", "contact", {})
