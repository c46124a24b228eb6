from .analysis import analyse as analyse
from .body import body_planes as body_planes
from .body import depth_grid as depth_grid
from .contact import Contact as Contact
from .contact import ConvergenceError as ConvergenceError
from .contact import certify as certify
from .contact import solve as solve
from .contact import solve_path as solve_path
from .layer import Layer as Layer
from .peaks import find_peaks as find_peaks
from .peaks import plane_peaks as plane_peaks
from .roughness import johnson as johnson
from .roughness import measure as measure
from .roughness import self_affine as self_affine
from .roughness import spectrum as spectrum
from .roughness import with_moments as with_moments
from .statistics import autocorrelation as autocorrelation
from .statistics import ensemble as ensemble
from .statistics import probability_density as probability_density

__version__: str
