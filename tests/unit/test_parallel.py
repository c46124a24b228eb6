"""Loops over parts of arrays on several threads, and the tasks that threads take in turn."""

from __future__ import annotations

import gc
import multiprocessing
import threading
import time
import weakref
from functools import partial

import numpy as np
import pytest

from asperity.contact import kernels
from asperity.parallel import (
    PARTS_OF_THREAD,
    STRIP,
    SUMMED_PART,
    apply,
    in_parts,
    in_strips,
    results,
    select,
    total,
)
from asperity.tasks import results_of


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_parts_cover_all_elements_in_order(threads: int) -> None:
    parts = in_parts(lambda part: part, 1000, threads, multiple=32, smallest=100)
    assert len(parts) == (1 if threads == 1 else min(PARTS_OF_THREAD * threads, 10))
    assert [index for part in parts for index in range(part.start, part.stop)] == list(range(1000))
    assert all(part.start % 32 == 0 for part in parts)


def test_few_elements_are_one_part() -> None:
    assert in_parts(lambda part: part, 10, 4) == [slice(0, 10)]


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_strips_cover_all_rows_once(threads: int) -> None:
    seen = np.zeros(1000, int)
    longest = []

    def work(rows: slice) -> None:
        seen[rows] += 1
        longest.append(rows.stop - rows.start)

    in_strips(work, (1000, STRIP // 100), threads)
    assert (seen == 1).all()
    assert max(longest) == 100


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_elements_are_selected_in_order_on_any_number_of_threads(threads: int) -> None:
    field = np.random.default_rng(0).normal(size=100_000)
    found, values = select(
        lambda part: kernels.count_positive(field[part]),
        lambda part, *chosen: kernels.write_positive(field[part], part.start, *chosen),
        field.size,
        threads,
        (np.uint32, np.float32),
    )
    np.testing.assert_array_equal(found, np.flatnonzero(field > 0))
    np.testing.assert_array_equal(values, field[field > 0].astype(np.float32))
    assert found.dtype == np.uint32
    assert values.dtype == np.float32


def test_something_else_is_done_meanwhile() -> None:
    for threads in (1, 2):
        done: list[str] = []
        parts = in_parts(lambda part: part, 40, threads, smallest=1, meanwhile=partial(done.append, "it"))
        assert done == ["it"]
        assert sum(part.stop - part.start for part in parts) == 40


def test_sums_over_parts_have_the_same_bits_for_any_number_of_threads() -> None:
    values = np.random.default_rng(0).random(300_000)
    sums = [total(kernels.dot, threads, values, values) for threads in (1, 2, 3)]
    assert sums[0] == sums[1] == sums[2] == pytest.approx(values @ values, rel=1e-13)
    several = total(kernels.sums_of_iteration, 2, values, 2 * values, 3 * values, values[::-1])
    crossed = values @ values[::-1]
    expected = values.sum(), 3 * sums[0], 6 * sums[0], crossed, 2 * crossed
    assert several == pytest.approx(expected, rel=1e-13)
    assert total(kernels.added, 2, values[:10]) == pytest.approx(values[:10].sum(), rel=1e-13)


@pytest.mark.parametrize(("number", "parts"), [(1, 1), (2, 2), (3, 2), (4, 4), (7, 4), (14, 12)])
def test_sums_are_taken_over_numbers_of_parts_that_threads_can_share(number: int, parts: int) -> None:
    values = np.arange(number * SUMMED_PART + 1)
    found = results(lambda part: part, 2, values)
    assert len(found) == parts
    np.testing.assert_array_equal(np.concatenate(found), values)


def test_arrays_are_changed_in_parts() -> None:
    values, out = np.arange(100_000.0), np.empty(100_000)
    apply(kernels.write_gap, 3, values, values, 1.0, out)
    np.testing.assert_array_equal(out, 2 * values - 1)


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_results_of_tasks_are_in_their_order(threads: int) -> None:
    def task(number: int) -> int:
        time.sleep(0.001 * (number % 3))
        return number

    assert results_of([partial(task, number) for number in range(20)], threads) == list(range(20))


def test_tasks_are_done_at_the_same_time() -> None:
    """Each of three tasks waits for the others."""
    barrier = threading.Barrier(3)
    assert sorted(results_of([partial(barrier.wait, 10)] * 3, 3)) == [0, 1, 2]


def test_tasks_may_have_tasks_of_their_own() -> None:
    """Also if every helper is at work: nobody waits for a thread that waits."""

    def task(depth: int) -> int:
        if depth == 0:
            time.sleep(0.001)
            return 1
        return sum(results_of([partial(task, depth - 1)] * 3, 3))

    assert task(4) == 81


@pytest.mark.parametrize("failing", [0, 1, 5])
def test_an_error_in_any_task_is_raised_when_no_thread_is_at_work(failing: int) -> None:
    """No task is begun after it."""
    begun, ended = [], []

    def task(number: int) -> None:
        begun.append(number)
        time.sleep(0.01)
        if number == failing:
            raise ValueError(f"task {number}")
        ended.append(number)

    with pytest.raises(ValueError, match=f"task {failing}"):
        results_of([partial(task, number) for number in range(200)], 3)
    assert set(begun) - set(ended) == {failing}
    assert len(begun) < 200


def test_tasks_see_the_context_of_the_caller() -> None:
    """A warning of NumPy that the caller ignores is not one in a helper."""
    barrier = threading.Barrier(3)

    def task() -> np.float32:
        barrier.wait(10)
        return np.float32(np.array(1e300))

    with np.errstate(over="ignore"):
        assert results_of([task] * 3, 3) == [np.inf] * 3


def test_helpers_keep_nothing_of_tasks_that_are_done() -> None:
    array = np.zeros(10)
    kept = weakref.ref(array)

    def task(values: np.ndarray) -> None:
        time.sleep(0.001 + 0 * values.sum())

    results_of([partial(task, array)] * 8, 3)
    del array
    for _ in range(100):
        gc.collect()
        if kept() is None:
            return
        time.sleep(0.01)
    raise AssertionError("the array is still in use")


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="processes do not fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_has_helpers_of_its_own() -> None:
    """Each of two tasks waits for the other."""
    results_of([partial(time.sleep, 0.001)] * 4, 2)
    child = multiprocessing.get_context("fork").Process(target=_meet)
    child.start()
    child.join(30)
    assert child.exitcode == 0


def _meet() -> None:
    results_of([partial(threading.Barrier(2).wait, 10)] * 2, 2)
