"""Green's function molecular dynamics: damped dynamics of the surface against a hard wall.

The method of the paper (section 2; Campañá & Müser 2006, 10.1103/PhysRevB.74.075420; Prodanov, Dapp & Müser
2014, 10.1007/s11249-013-0282-z). The displacement modes of the surface move under their elastic force −k(q)
û(q), k = 1/G, and the external force f̂, all with the same mass, by position Störmer–Verlet with centred
damping,

    (1 + γ/2) û⁺ = 2 û − (1 − γ/2) û⁻ + τ² (f̂ − k û),      γ = η τ,

for unit mass. After each step every node that has passed through the indenter is put back on it, in real
space. The mass is the same for all modes because a mass that depends on q moves the fixed point of these two
operations away from equilibrium. The time step τ is a fraction of the stability limit 2/ω of the stiffest
mode; the damping is a fraction of the critical damping of the slowest mode, for which

    γ_critical = 2 √(κ − κ²/4),      κ = ω² τ².

The indenter is at rest and the load pushes the solid against it. Under an imposed load the mean (q = 0) mode
therefore has no elastic stiffness. It is stabilised by the growth of the contact: d(load)/d(gap) ≈ load /
(half the rms height), but no less than the stiffness of a single node in contact, E* / (spacing × nodes).

Under an imposed approach, a solid without uniform displacement has to keep the mean of its displacement at
zero. A spring pulls the mean back, and a load is adjusted until the spring is relaxed. The change of the load
per change of the mean is estimated along the way. It sets the speed of the adjustment and gives the remaining
error of the load, which is a part of the error.
"""

import math
from typing import Any

import numpy as np

from asperity.contact.load import AreaControl
from asperity.contact.problem import Control, ConvergenceProgress, Problem, State
from asperity.core.compiled import compiled
from asperity.core.errors import ConvergenceError
from asperity.core.types import Array, Progress
from asperity.fourier.grid import mean_square

# Time step, as a fraction of the stability limit.
TIME_STEP_FRACTION = 0.9

# Damping of the paper, as a fraction of the critical damping of the slowest mode.
DAMPING_FRACTION = 0.99

# Stiffness of the spring that holds the mean displacement at zero, over the stiffness of the softest mode.
# Found by trial: with half of it or twice as much 1.1 times the steps are needed.
MEAN_SPRING = 4

# Change of the load per step, over damping × mean displacement × estimated change of the load per change of
# the mean. Found by trial: with half of it or twice as much twice the steps are needed.
LOAD_GAIN = 0.25

# Relaxation times of the slowest mode after a change of the load, before the area is taken again. Found by
# trial: one takes 15 % more steps, six take 37 % more.
RELAXATION_TIMES = 3

# In single precision the dynamics end after so many relaxation times of the slowest mode without an error
# below a fraction of the smallest at this load: rounding of the displacement stops them, at an error that
# grows as the contact shrinks (1e-5 at 10 % of the area, 5e-4 at 1 %).
STALLED_TIMES = 100
PROGRESS_FACTOR = 0.9

# Steps between two evaluations of the residual, and largest number of steps.
STEPS_BETWEEN_CHECKS = 10
MAX_STEPS = 20_000


def solve(
    problem: Problem,
    control: Control,
    rtol: float,
    progress: Progress | None,
    initial: Array | None,
    damping_fraction: float = DAMPING_FRACTION,
) -> State:
    """Let the surface come to rest on the indenter.

    Parameters
    ----------
    problem : Problem
    control : Control
    rtol : float
        Error of the pressure relative to its norm to be reached, as estimated by
        `DampedDynamics.pressure_and_error`.
    progress : callable, optional
    initial : (ny, nx) array, optional
        Start from the displacement under this pressure, which is positive somewhere and nowhere negative.
    damping_fraction : float
        Damping, as a fraction of the critical damping of the slowest mode.

    Raises
    ------
    ConvergenceError
        If the surface is not at rest after `MAX_STEPS` steps, or if rounding keeps it from coming to rest.
    """
    dynamics = DampedDynamics(problem, control, initial, damping_fraction)
    area = None
    if control.kind == "contact_area_fraction" and np.ptp(problem.height):  # flat surfaces touch everywhere
        area = AreaControl(control.value, problem.grid.size, rtol)
    report = ConvergenceProgress(progress, rtol)
    single = problem.fourier.real == np.float32
    next_check, smallest, last_progress, step, error = 0, math.inf, 0, 0, math.inf
    while step < MAX_STEPS:
        for _ in range(STEPS_BETWEEN_CHECKS):
            dynamics.advance()
        step += STEPS_BETWEEN_CHECKS
        pressure, error = dynamics.pressure_and_error()
        if not math.isfinite(error):
            break
        report(error)
        if error < PROGRESS_FACTOR * smallest:
            smallest, last_progress = error, step
        elif single and (step - last_progress) * dynamics.slowest_frequency() > STALLED_TIMES:
            break
        # A change of the load takes effect within the relaxation time of the slowest mode.
        if step < next_check:
            continue
        load, converged, new_load = dynamics.load, error <= rtol, None
        if area is not None and area.misses(count := int(np.count_nonzero(pressure))):
            if converged:
                new_load = area.bracketed(load, count, area.power_law(load, count))
            elif abs(area.log_ratio(count)) > error and area.may_change():
                new_load = load * math.exp(1.1 * min(max(area.log_ratio(count), -0.6), 0.6))
        if new_load is not None:
            next_check = step + math.ceil(RELAXATION_TIMES / dynamics.slowest_frequency())
            smallest, dynamics.load = math.inf, new_load
        elif converged:
            if control.fixes_load:
                pressure *= pressure.dtype.type(load / pressure.mean(dtype=float))
            return State(pressure, control.value, load, error, step)
    raise ConvergenceError(
        f"damped dynamics on {problem.grid.shape} nodes stopped",
        error,
        rtol,
        step,
        dynamics.load,
        "method = 'active_set' or a larger rtol is needed",
    )


class DampedDynamics:
    """Displacement of the surface in two successive time steps.

    Parameters
    ----------
    problem : Problem
    control : Control
    initial : (ny, nx) array or None
        Start at rest from the displacement under this pressure, or without displacement.
    damping_fraction : float
        Damping, as a fraction of the critical damping of the slowest mode.
    """

    def __init__(
        self, problem: Problem, control: Control, initial: Array | None, damping_fraction: float
    ) -> None:
        self._problem = problem
        self._fixed_load = control.fixes_load
        if control.kind == "mean_pressure":
            self.load = control.value
        elif initial is not None:
            self.load = float(np.mean(initial, dtype=float))
        elif control.kind == "approach":
            self.load = 0.0
        else:
            # The area fraction of small loads is about two times load / (E* × rms gradient).
            # A flat surface has no gradient, and is in full contact under any load.
            coefficients, grid = problem.fourier.forward(problem.height), problem.grid
            rms_gradient = math.sqrt(mean_square(coefficients, grid, grid.wavenumber() ** 2))
            modulus = problem.response.solid.effective_modulus
            self.load = 0.5 * control.value * modulus * (rms_gradient or 1e-3)
        self._damping_fraction = damping_fraction
        self._wall = (0.0 if control.fixes_load else control.value) - problem.height
        self._node_stiffness = 1 / (problem.nodal_compliance * problem.grid.size)
        self._half_rms_height = 0.5 * float(np.std(problem.height, dtype=float))
        compliance = problem.response.compliance
        stiffness = np.zeros_like(compliance)
        np.divide(1, compliance, out=stiffness, where=compliance > 0)
        elastic = stiffness[stiffness > 0]
        softest, stiffest = (float(elastic.min()), float(elastic.max())) if elastic.size else (1.0, 1.0)
        self._softest = softest
        self._squared_step = TIME_STEP_FRACTION**2 * 4 / stiffest
        # Stiffness of the spring that holds the mean displacement at zero, if it has to be held.
        self._spring = 0.0
        if compliance[0, 0] == 0 and not control.fixes_load:
            stiffness[0, 0] = self._spring = MEAN_SPRING * softest
        self._stiffness = stiffness
        # Estimated change of the load per change of the mean displacement, never below the spring's.
        self._growth = self._spring
        self._last_load_and_mean = (0.0, 0.0)
        displacement = np.zeros_like(problem.height)
        if initial is not None:
            problem.response.displacement(initial, displacement)
        if control.fixes_load:  # the surface touches the indenter
            displacement += np.max(self._wall - displacement)
        self._displacement = np.maximum(displacement, self._wall, out=displacement)
        self._now = problem.fourier.forward(self._displacement)
        self._before = self._now.copy()

    def advance(self) -> None:
        """Take one time step under the load, which follows the mean displacement if that has to be held."""
        fourier = self._problem.fourier
        kappa = self._slowest_kappa()
        gamma = self._damping_fraction * 2 * math.sqrt(kappa - kappa**2 / 4)
        if self._spring:
            change = LOAD_GAIN * gamma * self._growth * float(self._now[0, 0].real)
            self.load = max(self.load + change, 0.0)
        _advance_modes(
            self._now,
            self._before,
            self._stiffness,
            self._squared_step,
            gamma,
            self._squared_step * self.load,
        )
        fourier.inverse(self._before, self._displacement)
        np.maximum(self._displacement, self._wall, out=self._displacement)
        self._now, self._before = fourier.forward(self._displacement, self._before), self._now

    def pressure_and_error(self) -> tuple[Array, float]:
        """Pressure on the contact nodes, and its error, estimated from all other tractions, over its norm.

        The other tractions vanish in equilibrium. Tractions that are spread evenly over all nodes are still
        to be carried by the contact nodes alone, which multiplies their norm by the root of the ratio of the
        numbers of nodes.
        """
        traction = self._problem.fourier.inverse(self._stiffness * self._now, overwrite=True)
        traction += traction.dtype.type(self.load)
        pressure = np.where((self._displacement == self._wall) & (traction > 0), traction, 0)
        unbalanced = math.sqrt(float(np.sum(np.square(traction - pressure), dtype=float)))
        nodes_in_contact = max(int(np.count_nonzero(pressure)), 1)
        missing_load = 0.0
        if self._spring:
            # Norm of the pressure that the load lacks to hold the mean displacement at zero, from the change
            # of the load per change of the mean since the last call, which may halve or double the last
            # estimate. It also sets how fast the load follows the mean: near full contact a small change of
            # the mean needs a large change of the load.
            mean, (last_load, last_mean) = float(self._now[0, 0].real), self._last_load_and_mean
            if mean != last_mean and (growth := (last_load - self.load) / (mean - last_mean)) > 0:
                slowest, fastest = max(self._spring, 0.5 * self._growth), 2 * self._growth
                self._growth = min(max(growth, slowest), fastest)
            self._last_load_and_mean = (self.load, mean)
            missing_load = self._growth * abs(mean) * math.sqrt(self._problem.grid.size)
        error = max(unbalanced * math.sqrt(pressure.size / nodes_in_contact), missing_load)
        norm = math.sqrt(float(np.sum(np.square(pressure), dtype=float)))
        return pressure, error / norm if norm else (0.0 if error == 0 else math.inf)

    def slowest_frequency(self) -> float:
        """Angular frequency of the slowest mode under the load, times the time step."""
        return math.sqrt(self._slowest_kappa())

    def _slowest_kappa(self) -> float:
        """κ = ω² τ² of the slowest mode under the load."""
        slowest = self._softest
        if self._fixed_load and self._half_rms_height:
            slowest = min(slowest, max(self.load / self._half_rms_height, self._node_stiffness))
        return min(slowest * self._squared_step, 2.0)


@compiled
def _advance_modes(
    now: Any, before: Any, stiffness: Any, squared_step: float, gamma: float, push: float
) -> None:
    """Take one time step of every mode; the new displacements replace `before`."""
    rows, columns = now.shape
    scale = 1 / (1 + gamma / 2)
    backward = (1 - gamma / 2) * scale
    uniform = now[0, 0]
    uniform_before = before[0, 0]
    for i in range(rows):
        for j in range(columns):
            forward = (2 - squared_step * stiffness[i, j]) * scale
            before[i, j] = forward * now[i, j] - backward * before[i, j]
    before[0, 0] = ((2 - squared_step * stiffness[0, 0]) * uniform - push) * scale - backward * uniform_before
