"""The cell in three dimensions: a block of solid with its deformed surface, and the indenter above it."""

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from asperity.core.types import Array, ArrayLike
from asperity.paper.figures.cases import Datasets, contact_area, name
from asperity.results.dataset import grid_of
from asperity.views.scales import blocks
from asperity.views.style import MILLIMETRE, label

SOLID, FRONT, RIGHT, CONTACT = "#c9d6df", "#9fb3c1", "#8aa0b0", "#D55E00"
"""Colours of the solid's surface, of the two walls that are seen, and of the contact."""

DEPTH = 0.14
"""Indentation of the paraboloid as drawn, in cell lengths; the displacements are magnified to it."""

INDENTER_RADIUS = 0.31
"""Radius to which the paraboloid is drawn, in cell lengths."""

NODES = 192
"""Largest number of nodes of a rough surface drawn along an edge."""

RELIEF = 0.02
"""Root-mean-square height of a rough surface as drawn, in cell lengths."""

LIFT = 0.4
"""Distance by which a rough indenter is drawn above its place, in cell lengths."""


def draw_hertzian(validation: Datasets) -> Figure:
    """Draw the periodic cell of the slab with the mesh on its walls, and half of the indenter above it."""
    data = validation["elements"]
    curvature, approach = data.attrs["curvature_radius"], data.attrs["approach"]
    magnify = DEPTH / approach
    figure, axis = _scene(85, 78, (-0.12, 1.3), zoom=1.06)

    nodes = data.axis_node.values
    x = np.concatenate([-nodes[:0:-1], nodes])
    # The walls lie at half a period: by symmetry their nodes stay in the plane of the wall.
    across, _, up = data.rim_displacement_elements.transpose("component", "node_z", "axis_node").values
    along = x + magnify * np.hstack([-across[:, :0:-1], across])
    height = data.node_z.values[:, None] + magnify * np.hstack([up[:, :0:-1], up])
    front, right = _points(along, -0.5, height), _points(0.5, along, height)
    _draw_walls(axis, front[-1], right[-1])
    for wall in (front, right):
        mesh = [*wall[::2], *wall.swapaxes(0, 1)[::2]]
        axis.add_collection3d(Line3DCollection(mesh, colors="k", linewidths=0.15, alpha=0.6))
    quarter = data.surface_displacement_elements.values
    half = np.hstack([quarter[:, :0:-1], quarter])
    top = 1 + magnify * np.vstack([half[:0:-1], half])
    columns, rows = np.meshgrid(x, x)
    _draw_surface(axis, columns, rows, top, color=SOLID)

    def face(r: Array) -> Array:
        """Height of the indenter's lower face at a distance from its axis, as drawn."""
        return 1 + magnify * (r**2 / (2 * curvature) - approach)

    radius = float(data.contact_radius)
    turn = np.linspace(0, 2 * np.pi, 121)
    edge = float(face(np.array(radius)))
    circle = _points(radius * np.cos(turn), radius * np.sin(turn), edge)
    axis.add_collection3d(Line3DCollection([circle], colors=CONTACT, linewidths=0.9))
    reach = np.linspace(0, INDENTER_RADIUS, 40)
    r, phi = np.meshgrid(reach, np.linspace(0.0, np.pi, 61))
    _draw_surface(axis, r * np.cos(phi), r * np.sin(phi), face(r), color="#E69F00", alpha=0.75)
    section = np.concatenate([-reach[::-1], reach])
    outline = _points(section, 0.0, face(section))
    axis.add_collection3d(Line3DCollection([outline], colors="k", linewidths=0.6))

    text = {"fontsize": 8, "ha": "center", "va": "center"}
    axis.text(0.0, -0.68, -0.1, "$L_x$", **text)
    axis.text(0.68, 0.0, -0.1, "$L_y$", **text)
    axis.text(0.58, 0.58, 0.5, "$L_z$", **text)
    axis.text(radius + 0.06, -radius - 0.06, edge, "$a$", color=CONTACT, **text)
    axis.text(0.0, 0.0, 1.44, "paraboloid, radius $R$", **text)
    return figure


def caption_hertzian(validation: Datasets) -> str:
    """Radius and approach of the paraboloid, and the contact radius."""
    data = validation["elements"]
    return (
        f"A paraboloid of radius {data.attrs['curvature_radius']:g} L pressed by "
        f"{data.attrs['approach']:.3g} L into a slab; "
        f"contact radius {float(data['contact_radius']):.3f} L. Displacements are magnified."
    )


def draw_rough(surface: Datasets, contact: Datasets) -> Figure:
    """Draw the deformed solid with its contacts in red, and above it the indenter, coloured by height.

    The last surface is drawn.
    """
    rough, pressed = list(surface.values())[-1], list(contact.values())[-1]
    step = max(1, -(-rough.sizes["x"] // NODES))
    edges = grid_of(rough).length[::-1]
    x, y = (rough[axis].values[::step] - edge / 2 for axis, edge in zip("xy", edges, strict=True))
    columns, rows = np.meshgrid(x, y)
    magnify = RELIEF / float(rough.rms_height)
    height = rough.height.values[::step, ::step]
    down = pressed.displacement.values[::step, ::step] - pressed.displacement.values.min()

    figure, axis = _scene(110, 105, (-0.08, 1.5), zoom=1.04)
    top = 1 - magnify * down
    _draw_walls(axis, _points(x, y[0], top[0]), _points(x[-1], y, top[:, -1]))
    contacts = blocks(pressed.pressure.values, (step, step), np.max) > 0
    painted = np.where(contacts[..., None], mpl.colors.to_rgba(CONTACT), mpl.colors.to_rgba(SOLID))
    _draw_surface(axis, columns, rows, top, facecolors=painted)
    norm = Normalize(*np.percentile(height / float(rough.rms_height), [0.1, 99.9]))
    colours = mpl.colormaps["viridis"](norm(height / float(rough.rms_height)))
    _draw_surface(axis, columns, rows, 1 + LIFT + magnify * height, facecolors=colours)
    bar = figure.add_axes((0.87, 0.62, 0.02, 0.28))
    figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar, label=r"$h / h_\mathrm{rms}$")
    return figure


def caption_rough(surface: Datasets, contact: Datasets) -> str:
    """The drawn surface, its area of contact and its load."""
    drawn = list(surface)[-1]
    return f"Drawn: {name(label(surface[drawn]))}.\n\n- {contact_area(contact[drawn])}"


def _scene(width: float, height: float, z: tuple[float, float], zoom: float) -> tuple[Figure, Axes3D]:
    """A figure of `width` × `height` millimetres with the rigid ground to which the block is bonded.

    Three-dimensional axes without frame fill it, from the lower to the upper end `z`. Objects are drawn in
    the order in which they are added, whatever lies in front.
    """
    figure = Figure(figsize=(width * MILLIMETRE, height * MILLIMETRE))
    figure.set_layout_engine("none")
    axis = Axes3D(figure, (0.0, 0.0, 1.0, 1.0), computed_zorder=False)
    figure.add_axes(axis)
    axis.view_init(24, -58)
    axis.set_axis_off()
    axis.set_proj_type("ortho")
    axis.set(xlim=(-0.5, 0.5), ylim=(-0.5, 0.5), zlim=z)
    axis.set_box_aspect((1, 1, z[1] - z[0]), zoom=zoom)
    reach, thick = 0.56, 0.05
    top = [(-reach, -reach, 0), (reach, -reach, 0), (reach, reach, 0), (-reach, reach, 0)]
    side = [(-reach, 0), (reach, 0), (reach, -thick), (-reach, -thick)]
    faces = [top, [(x, -reach, z) for x, z in side], [(reach, y, z) for y, z in side]]
    grey = ["#e6e6e6", "#bbbbbb", "#a8a8a8"]
    axis.add_collection3d(Poly3DCollection(faces, facecolor=grey, edgecolor="k", linewidth=0.3))
    return figure, axis


def _draw_surface(axis: Axes3D, x: Array, y: Array, z: Array, **paint: str | float | Array) -> None:
    """Draw a lightly shaded surface of points (x, y, z), all of them of shape (rows, columns)."""
    rows, columns = z.shape
    axis.plot_surface(x, y, z, rcount=rows, ccount=columns, lw=0, antialiased=False, rasterized=True, **paint)


def _draw_walls(axis: Axes3D, front: Array, right: Array) -> None:
    """Draw the two faces of the block that are seen, from the given upper edges (n, 3) down to z = 0."""
    for edge, shade in ((front, FRONT), (right, RIGHT)):
        outline = np.vstack([edge, (edge * [1, 1, 0])[::-1]])
        axis.add_collection3d(Poly3DCollection([outline], facecolor=shade, edgecolor="k", linewidth=0.4))


def _points(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Array:
    """Points (…, 3) of three coordinates."""
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)
