"""Containers of contact.engineering: several maps of one surface in a ZIP archive."""

import io
import os
import re
import warnings
import zipfile
from pathlib import Path

from asperity.core.packages import require
from asperity.surface.reading.agreement import require_size
from asperity.surface.reading.height_map import MapError

INDEX = {"index.json", "meta.yml"}
"""Members of an archive that list its maps; a container has one of them."""

MOST = 8.0
"""Largest size of the unpacked maps in GiB."""


def maps_in(path: str) -> list[str]:
    """Files of the maps in a container, written as NetCDF into a folder beside it; of another file itself.

    Heights, edges, units and instruments are those that the container states; line scans are left out.

    Raises
    ------
    MapError
        If it holds several surfaces, or none that can be read.
    """
    if not path.endswith(".zip") or not zipfile.is_zipfile(path):
        return [path]
    with zipfile.ZipFile(path) as archive:
        if INDEX.isdisjoint(archive.namelist()):
            return [path]
        size = float(sum(member.file_size for member in archive.infolist()))
    require(("SurfaceTopography",))
    folder = Path(path).with_suffix("")
    try:
        require_size(size, MOST)
        with warnings.catch_warnings(action="ignore"):
            from SurfaceTopography import read_container

            surfaces = read_container(io.BytesIO(Path(path).read_bytes()))  # it leaves files open
            if len(surfaces) != 1:
                names = ", ".join(str(each.info.get("name")) for each in surfaces)
                raise ValueError(f"a container of one surface is needed, it holds {len(surfaces)}: {names}")
            folder.mkdir(exist_ok=True)
            files: list[str] = []
            for number, each in enumerate(surfaces[0]):
                if each.dim == 2:
                    name = re.sub(r"[^\w.+-]+", "_", str(each.info.get("name", ""))).strip("._")[:60]
                    files.append(os.fspath(folder / f"{number + 1}_{name or 'map'}.nc"))
                    each.to_netcdf(files[-1])
    except Exception as error:  # readers raise errors of any type for damaged files
        raise MapError(path, [f"a container that can be read is needed ({error})"]) from error
    if not files:
        raise MapError(path, ["a map is needed, the container holds line scans alone"])
    return files
