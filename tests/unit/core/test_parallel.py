"""Loops over parts of arrays on several threads, and the tasks that threads take in turn."""

import os
import subprocess
import sys
import threading
import time
from functools import partial

import numpy as np
import pytest

from asperity.contact.contact_nodes import dot
from asperity.core.parallel import SUMMED_PART, apply, in_parts, in_strips, map_parts, run_tasks, sum_parts
from asperity.core.processes import side_by_side


def number_and_process(number, progress):
    progress(1, 2)
    if number < 0:
        raise ValueError(str(number))
    time.sleep(0.1)
    return number, os.getpid()


def written_or_read(path, text, progress):
    if not text:
        return path.read_text()
    time.sleep(0.2)
    path.write_text(text)


@pytest.mark.parametrize(("processes", "platform"), [(1, "linux"), (2, "linux"), (2, "other")])
def test_calls_side_by_side_are_in_order_and_this_process_makes_some(processes, platform, monkeypatch):
    """The other process is a fork or, on another platform, a new one."""
    monkeypatch.setattr(sys, "platform", platform)
    seen, given = [], [(number,) for number in (0, 1, 2, 3, -4, 5)]
    calls = side_by_side(number_and_process, given, processes, lambda parts: seen.append([*parts]))
    numbers, made_in = zip(*(next(calls) for _ in range(4)), strict=True)
    assert numbers == (0, 1, 2, 3)
    assert os.getpid() in made_in
    assert len({*made_in}) == processes
    with pytest.raises(ValueError, match="-4"):
        next(calls)
    assert seen[-1][:4] == [1, 1, 1, 1]


@pytest.mark.parametrize("processes", [1, 2])
def test_a_call_begins_after_the_one_that_it_needs(processes, tmp_path):
    given = [(tmp_path / "a", "1"), (tmp_path / "a", ""), (tmp_path / "b", "2"), (tmp_path / "b", "")]
    calls = side_by_side(written_or_read, given, processes, lambda parts: None, [None, 0, None, 2])
    assert [*calls] == [None, "1", None, "2"]


def slow_if_second(number, progress):
    if number == 1:
        time.sleep(0.3)
        progress(1, 2)
        time.sleep(0.2)


def test_an_interrupt_ends_calls_that_wait_for_others():
    """Call 2 waits here for the slow one and is interrupted; call 3 waits in vain for call 2."""

    def interrupt(parts):
        if parts[1] == 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        [*side_by_side(slow_if_second, [(n,) for n in range(4)], 2, interrupt, [None, None, 1, 2])]


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_parts_cover_all_elements_in_order(threads):
    """Another task runs beside them; strips cover all rows."""
    done, seen = [], np.zeros(1000, int)
    beside = partial(done.append, "it")
    parts = in_parts(lambda part: part, 1000, threads, multiple=32, smallest=100, meanwhile=beside)
    assert [index for part in parts for index in range(part.start, part.stop)] == list(range(1000))
    assert all(part.start % 32 == 0 for part in parts)
    assert done == ["it"]
    in_strips(lambda rows: np.add.at(seen, rows, 1), (1000, 500), threads)
    assert (seen == 1).all()


def test_sums_do_not_depend_on_threads():
    values = np.random.default_rng(0).random(300_000)
    sums = [sum_parts(dot, threads, values, values) for threads in (1, 2, 3)]
    assert sums[0] == sums[1] == sums[2] == pytest.approx(values @ values, rel=1e-13)


def test_parts_of_arrays_hold_every_element_once():
    values, out = np.arange(7.0 * SUMMED_PART + 1), np.empty(7 * SUMMED_PART + 1)
    np.testing.assert_array_equal(np.concatenate(map_parts(lambda part: part, 2, values)), values)
    apply(lambda source, factor, target: np.multiply(source, factor, out=target), 3, values, 2.0, out)
    np.testing.assert_array_equal(out, 2 * values)


PRINTED_BITS = """
import asperity as asp
height = asp.self_affine((200, 200), 0.8, 0.25, 0.04, rms_height=1e-3, seed=1)
contact = asp.solve_contact(height, asp.Solid(1.0, 0.3), approach=0.5 * height.min())
slip = asp.contact.partial_slip(contact, 0.3, tangential_force=0.1 * contact.force)
roughness = asp.roughness_parameters(height)
numbers = contact.mean_pressure, contact.stiffness, slip.compliance_ratio, slip.deviation, slip.lost_energy
print([float(number).hex() for number in (*numbers, roughness.skewness, roughness.kurtosis)])
"""


def test_numbers_do_not_depend_on_the_blas():
    """Its scalar products of more than 10,000 elements round differently on two threads."""
    run = partial(subprocess.run, [sys.executable, "-c", PRINTED_BITS], capture_output=True, check=True)
    one, two = (run(env=os.environ | {"OMP_NUM_THREADS": threads}).stdout for threads in "12")
    assert one == two
    assert one.count(b"0x") == 7


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_results_are_in_the_order_of_tasks(threads):
    """Tasks may have tasks of their own."""

    def task(number, depth=3):
        time.sleep(0.0005 * (number % 3))
        inner = run_tasks([partial(task, n, depth - 1) for n in range(2)], threads) if depth else []
        return [number, inner]

    found = run_tasks([partial(task, number) for number in range(10)], threads)
    assert [number for number, _ in found] == list(range(10))
    assert all([number for number, _ in inner] == [0, 1] for _, inner in found)


def test_tasks_run_together_in_the_callers_context():
    """Each of three tasks waits for the others; a warning that the caller ignores is none in a helper."""
    barrier = threading.Barrier(3)

    def task():
        barrier.wait(10)
        return np.float32(np.array(1e300))

    with np.errstate(over="ignore"):
        assert run_tasks([task] * 3, 3) == [np.inf] * 3


@pytest.mark.parametrize("failing", [0, 5])
def test_error_is_raised_after_all_threads_stop(failing):
    """No task is begun after the error."""
    begun, ended = [], []

    def task(number):
        begun.append(number)
        time.sleep(0.01)
        if number == failing:
            raise ValueError(f"task {number}")
        ended.append(number)

    with pytest.raises(ValueError, match=f"task {failing}"):
        run_tasks([partial(task, number) for number in range(200)], 3)
    assert set(begun) - set(ended) == {failing}
    assert len(begun) < 200
