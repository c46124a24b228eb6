from .contact import Contact as Contact
from .contact import ConvergenceError as ConvergenceError
from .contact import solve as solve
from .contact import solve_path as solve_path
from .contact import verify_contact as verify_contact
from .elasticity.layer import Layer as Layer
from .elasticity.two_bodies import TwoBodies as TwoBodies
from .results import read_result as read_result
from .spectral import Grid as Grid
from .stress.analysis import analyse_stress as analyse_stress
from .stress.depths import depth_grid as depth_grid
from .stress.peaks import find_peaks as find_peaks
from .stress.peaks import plane_peaks as plane_peaks
from .stress.planes import stress_planes as stress_planes
from .stress.pooling import pool_peaks as pool_peaks
from .stress.pressed import PressedSolid as PressedSolid
from .stress.selection import peaks as peaks
from .stress.statistics import autocorrelation as autocorrelation
from .stress.statistics import probability_density as probability_density
from .surface.measured import make_periodic as make_periodic
from .surface.measured import read_map as read_map
from .surface.roughness import johnson as johnson
from .surface.roughness import roughness_parameters as roughness_parameters
from .surface.roughness import self_affine as self_affine
from .surface.roughness import spectrum as spectrum
from .surface.roughness import with_moments as with_moments

__version__: str
