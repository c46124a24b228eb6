from .export import write_vtk as write_vtk
from .maps import plot_gap as plot_gap
from .maps import plot_height as plot_height
from .maps import plot_pressure as plot_pressure
from .peak_plot import plot_peaks as plot_peaks
from .stress_plot import plot_plane as plot_plane
from .stress_plot import plot_section as plot_section
