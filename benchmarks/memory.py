"""Peak of the resident memory of this process, as reported by Linux."""

from pathlib import Path


def peak_memory() -> float:
    """Largest resident memory since `reset_peak_memory`, in MB."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * int(dict(line.split(":", 1) for line in lines)["VmHWM"].split()[0]) / 1e6


def reset_peak_memory() -> None:
    """Forget the peak so far."""
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
