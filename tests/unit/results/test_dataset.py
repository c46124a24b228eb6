"""Result files are complete, described and checked."""

import errno
import os
import re
import zipfile

import netCDF4
import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.cli.main import main
from asperity.core.errors import DatasetError
from asperity.core.system import process_name
from asperity.results import dataset
from asperity.results.atomic import write_text
from asperity.results.variables import SI_UNITS, STUDY_UNITS, VARIABLES, units_of

SETTINGS = {"seed": 3, "surface": {"hurst": 0.8}}


@pytest.fixture
def surface():
    rng = np.random.default_rng(1)
    return xr.Dataset(
        {"height": (("y", "x"), rng.normal(size=(40, 30))), "rms_height": 1.0},
        coords={"y": np.arange(40.0), "x": np.arange(30.0)},
        attrs={"decision": "half-space"},
    )


@pytest.fixture
def path(surface, tmp_path):
    """A result file, the only file of its folder."""
    path = tmp_path / "file.nc"
    dataset.write(surface, path, "A surface", SETTINGS)
    return path


def test_file_explains_itself_and_comes_back_equal(surface, path):
    found = dataset.read(path)
    xr.testing.assert_equal(found, surface)
    assert dataset.settings_of(found) == SETTINGS
    assert found.attrs["title"] == "A surface"
    assert found.attrs["Conventions"].startswith("CF-")
    assert found.attrs["source"].startswith("asperity ")
    assert found.attrs["decision"] == "half-space"
    assert {"height"} == {name for name, each in found.variables.items() if "orientation" in each.attrs}
    assert found.attrs["settings_digest"] == dataset.digest(dict(reversed(SETTINGS.items())))
    for name, variable in found.variables.items():
        assert variable.attrs["units"] == units_of(name)
        assert variable.attrs["long_name"] == VARIABLES[name].long_name


def test_newer_format_is_not_called_damaged(surface, path, monkeypatch):
    with monkeypatch.context() as newer:
        newer.setattr(dataset, "FORMAT_VERSION", dataset.FORMAT_VERSION + 1)
        dataset.write(surface, path, "Title", SETTINGS)
        assert dataset.read(path).attrs["format_version"] == dataset.FORMAT_VERSION
    with pytest.raises(DatasetError, match=r"format_version = 2, at most 1 is read by [^;]*; install"):
        dataset.read(path)


@pytest.mark.parametrize(
    ("system", "units"),
    [(SI_UNITS, ["m", "m", "Pa"]), (STUDY_UNITS, ["cell_length", "cell_length", "effective_modulus"])],
)
def test_units_follow_the_unit_system(surface, path, system, units):
    data = surface.assign(mean_pressure=5e7).assign_attrs(unit_system=system)
    dataset.write(data, path, "Title", SETTINGS)
    found = dataset.read(path)
    assert found.attrs["unit_system"] == system
    assert [found[name].attrs["units"] for name in ("x", "height", "mean_pressure")] == units
    xr.testing.assert_equal(found, data)


def test_wrong_units_are_refused(surface, path):
    with pytest.raises(ValueError, match=r"^unit_system = 'imperial': one of cell length and"):
        dataset.write(surface.assign_attrs(unit_system="imperial"), path, "Title", SETTINGS)
    relabelled = xr.load_dataset(path).assign_attrs(unit_system=SI_UNITS)
    relabelled.to_netcdf(path)
    with pytest.raises(DatasetError, match="'cell_length', 'm' expected"):
        dataset.read(path)


@pytest.mark.parametrize(
    ("name", "value"), [("coordinates", 3), ("_Encoding", "x"), ("scale_factor", "x"), ("units", 3.5)]
)
def test_damaged_attributes_are_answered_with_one_line(surface, path, name, value, capsys):
    """Whatever error the decoding of xarray ends in."""
    with netCDF4.Dataset(path, "a") as file:
        file["height"].setncattr(name, value)
    with pytest.raises(DatasetError, match=r"file\.nc: .*damaged \("):
        dataset.read(path)
    assert main(["view", str(path), "height"]) == 1
    assert re.fullmatch(r"asperity: .*file\.nc: .*damaged \(.*\n", capsys.readouterr().err)


def test_failed_write_leaves_the_earlier_file(surface, path, monkeypatch):
    """Of processes that were killed nothing is left; what a living one writes stays."""
    before = path.read_bytes()
    host, _, start = process_name().rsplit(".", 2)
    names = (f"{host}.{2**22 + 1}.{start}", f"elsewhere.{2**22 + 1}.{start}", process_name())
    dead, far, alive = (path.with_name(f".file.nc.{name}.ab.unfinished") for name in names)

    def fail(self, target, **_):
        target.write_bytes(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    dead.write_bytes(b"half")
    far.write_bytes(b"half")
    alive.write_bytes(b"half")
    monkeypatch.setattr(xr.Dataset, "to_netcdf", fail)
    with pytest.raises(DatasetError, match=r"file\.nc: cannot be written \(the disk is full\); free"):
        dataset.write(surface, path, "After", SETTINGS)
    assert path.read_bytes() == before
    assert set(path.parent.iterdir()) == {path, far, alive}


@pytest.mark.skipif(os.name == "nt", reason="Windows has neither pipes in folders nor permissions of a group")
def test_only_writable_regular_files_are_replaced(tmp_path):
    pipe, text, link = tmp_path / "pipe", tmp_path / "text", tmp_path / "link"
    os.mkfifo(pipe)
    with pytest.raises(DatasetError, match="pipe: not a regular file; another name is needed"):
        write_text(pipe, "new")
    assert pipe.is_fifo()
    text.write_text("old")
    link.symlink_to(text)
    text.chmod(0o440)
    with pytest.raises(DatasetError, match="text: read-only"):
        write_text(text, "new")
    text.chmod(0o640)
    write_text(link, "new")
    assert link.is_symlink()
    assert (text.read_text(), text.stat().st_mode & 0o777) == ("new", 0o640)
    with pytest.raises(DatasetError, match="pipe: not a regular file"):
        dataset.read(pipe)


def cut(path):
    path.write_bytes(path.read_bytes()[:-500])


def flip_a_byte(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 255
    path.write_bytes(content)


def change_value(path):
    with netCDF4.Dataset(path, "a") as file:
        file["height"][3, 4] += 1e-9


def change_settings(path):
    with netCDF4.Dataset(path, "a") as file:
        file.settings = file.settings.replace("0.8", "0.2")


@pytest.mark.parametrize("damage", [cut, flip_a_byte, change_value, change_settings])
def test_damaged_file_is_named_with_a_remedy(path, damage):
    damage(path)
    with pytest.raises(DatasetError, match=r"file\.nc: ") as error:
        dataset.read(path)
    # A file that cannot be opened may be anything.
    assert ("delete it" in str(error.value)) == (damage is not cut)


def foreign_archive(path):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("main.xml", "<p:ISO5436_2/>")


def foreign_netcdf(path):
    xr.Dataset({"topography": (("y", "x"), np.eye(3))}, attrs={"instrument": "profiler"}).to_netcdf(path)


@pytest.mark.parametrize("make", [lambda path: path.write_text("1.0 2.0\n"), foreign_archive, foreign_netcdf])
def test_nobody_is_told_to_delete_own_data(tmp_path, make):
    make(tmp_path / "map")
    with pytest.raises(DatasetError, match=r"map: not a result of asperity") as error:
        dataset.read(tmp_path / "map")
    assert "delete it" not in str(error.value)


def pressed(height, length, **settings):
    return asp.solve_contact(height, asp.Solid(1.0, 0.3), length, **settings)


def test_row_of_nodes_keeps_its_edges(tmp_path):
    contact = pressed(np.linspace(-1, 1, 33)[None] ** 2, (0.01, 1.0), mean_pressure=0.1, boundary="free")
    contact.to_netcdf(tmp_path / "row.nc")
    found = dataset.read(tmp_path / "row.nc")
    assert dataset.grid_of(found) == contact.grid
    assert asp.views.plot_pressure(found).axes[0].images[0].get_array().shape == (1, 33)
    del found["y"].attrs["cell_edge"]  # as files of earlier versions
    with pytest.raises(ValueError, match="y: the nodes of a whole cell are needed"):
        dataset.grid_of(found)


HEIGHT = np.random.default_rng(1).normal(size=(16, 24))


@pytest.mark.parametrize(
    ("part", "axis"),
    [
        ({"y": slice(4, 12)}, "y"),
        ({"x": slice(None, None, -1)}, "x"),
        ({"x": slice(0, 1)}, "x"),  # a cell of one node
        ({"y": slice(None, None, 2)}, "y"),  # a coarser cell
        ({"y": [0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]}, "y"),
    ],
)
def test_part_of_a_contact_has_no_stress(part, axis):
    data = pressed(HEIGHT, (2.0, 3.0), mean_pressure=0.01).to_dataset().isel(part)
    for function in (asp.views.plot_pressure, asp.LoadedSolid.from_dataset):
        with pytest.raises(ValueError, match=f"^{axis}: the nodes of a whole cell are needed, equidistant"):
            function(data)


def test_missing_and_too_large_files_are_named(path, monkeypatch):
    with pytest.raises(DatasetError, match=r"absent\.nc: no such file"):
        dataset.read(path.with_name("absent.nc"))
    monkeypatch.setenv("ASPERITY_MAX_MEMORY", "1e-9")
    with pytest.raises(DatasetError, match=r"ASPERITY_MAX_MEMORY = 1e-09 GiB: the file holds .* set that"):
        dataset.read(path)


def test_arguments_win_over_inherited_attributes(surface, path):
    other = {"title": "Other", "settings": '{"seed": 4}', "settings_digest": "0", "comment": "none"}
    dataset.write(surface.assign_attrs(other), path, "A surface", SETTINGS)
    found = dataset.read(path)
    assert (found.attrs["title"], dataset.settings_of(found)) == ("A surface", SETTINGS)
    assert found.attrs["settings_digest"] == dataset.digest(SETTINGS)
    assert "cell" in found.attrs["comment"]


def test_files_are_on_the_disk_before_they_replace(surface, path, monkeypatch):
    """A power failure then leaves the old or the new file: content, name, and the entry of the folder."""
    order = []
    replace, fsync = os.replace, os.fsync
    monkeypatch.setattr(os, "replace", lambda *names: order.append("replace") or replace(*names))
    monkeypatch.setattr(
        os, "fsync", lambda file: order.append(os.readlink(f"/proc/self/fd/{file}")) or fsync(file)
    )
    dataset.write(surface, path, "Title", SETTINGS)
    assert order[0].endswith(".unfinished")
    assert order[1:] == ["replace", str(path.parent)]
