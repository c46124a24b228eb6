# Two hashes of the library's code, parameters of the rules: another hash reruns all that computes, or all that draws.
import hashlib
import re
from importlib.metadata import version
from pathlib import Path

import asperity

LIBRARY = Path(asperity.__file__).parent


def code_hash(rooms, packages):
    """Hash of every file in these folders of the library, and of the versions of these packages."""
    files = (file for room in rooms for file in sorted((LIBRARY / room).rglob("*")))
    contents = [file.read_bytes() for file in files if file.is_file() and file.parent.name != "__pycache__"]
    versions = " ".join(f"{name} {version(name)}" for name in packages)
    return hashlib.sha256(b"".join([*contents, versions.encode()])).hexdigest()[:16]


COMPUTING = code_hash(
    "core fourier reference surface elasticity results contact stress engineering study".split(),
    ["numpy", "scipy", "numba", config["fft_engine"], "netCDF4", "SurfaceTopography", "mpmath", "scikit-fem"],
)
DRAWING = code_hash(["views", "paper"], ["matplotlib"])


def any_of(names):
    """Pattern of a wildcard that is one of these names; without names one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"
