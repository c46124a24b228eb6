"""A real SLURM of one node on this machine: loopback only, no systemd, all its state in a temporary folder.

Every daemon ends with the context, and the folder goes with it.
"""

import contextlib
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scontrol")
SYSTEM_PATH = os.pathsep.join(["/usr/sbin", "/sbin", os.environ["PATH"]])
CGROUPS = Path("/sys/fs/cgroup/memory")

CONFIGURATION = """\
ClusterName=asperity
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/controller
SlurmdSpoolDir={folder}/node
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
MpiDefault=none
ProctrackType=proctrack/linuxproc
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
{limits}
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=sched_interval=2,sched_min_interval=100000
MinJobAge=86400
KillWait=2
OverTimeLimit=0
InactiveLimit=0
ReturnToService=2
SlurmdParameters=config_overrides
NodeName=asperity NodeHostname={host} NodeAddr=127.0.0.1 CPUs={processors} RealMemory={memory} State=UNKNOWN
PartitionName=main Nodes=asperity Default=YES MaxTime=INFINITE State=UP
"""

# Ways to hold a job to its memory; without control groups SLURM measures it once a second.
BY_CGROUPS = "TaskPlugin=task/cgroup"
BY_POLLING = "TaskPlugin=task/none\nJobAcctGatherParams=OverMemoryKill"
CGROUP_CONFIGURATION = """\
CgroupPlugin=cgroup/v1
CgroupMountpoint=/sys/fs/cgroup
ConstrainRAMSpace=yes
ConstrainSwapSpace=yes
"""


class Cluster(NamedTuple):
    """A running cluster: its folder, and the environment in which its commands find it."""

    folder: Path
    environment: dict[str, str]

    def run(self, *command: str) -> str:
        """Output of a command of SLURM."""
        done = subprocess.run(command, env=self.environment, check=True, capture_output=True, text=True)
        return done.stdout


def missing() -> str:
    """Reason for which no cluster can be started here; empty if one can."""
    absent = [name for name in PROGRAMS if shutil.which(name, path=SYSTEM_PATH) is None]
    if absent:
        packages = "slurmctld slurmd slurm-client munge"
        return f"SLURM is not installed ({', '.join(absent)}): apt install {packages}"
    if os.geteuid() != 0:
        return "slurmd needs root"
    return ""


@contextlib.contextmanager
def cluster(processors: int = 2, memory: int = 8000) -> Iterator[Cluster]:
    """A cluster of one node with so many processors and so much memory in MiB, for as long as the context."""
    folder = Path(tempfile.mkdtemp(prefix="slurm-"))
    folder.chmod(0o755)
    running = Cluster(folder, _prepare(folder, processors, memory))
    daemons: list[subprocess.Popen[bytes]] = []
    try:
        _start(running, daemons)
        yield running
    finally:
        _stop(running, daemons)
        shutil.rmtree(folder, ignore_errors=True)


def _prepare(folder: Path, processors: int, memory: int) -> dict[str, str]:
    """Write keys and configuration; return the environment of the clients.

    A job's step is started without SLURM_CONF in its environment, so every command found first on PATH
    sets it itself.
    """
    for name in ("controller", "node", "bin"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o600)
    ports = _free_ports(2)
    configuration = folder / "slurm.conf"
    configuration.write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0],
            folder=folder,
            controller_port=ports[0],
            node_port=ports[1],
            processors=processors,
            memory=memory,
            limits=BY_CGROUPS if CGROUPS.is_dir() else BY_POLLING,
        )
    )
    (folder / "cgroup.conf").write_text(CGROUP_CONFIGURATION)
    for name in ("sbatch", "srun", "squeue", "scontrol", "sinfo", "scancel", "sacct"):
        found = shutil.which(name, path=SYSTEM_PATH)
        command = folder / "bin" / name
        command.write_text(f'#!/bin/sh\nSLURM_CONF={configuration} exec {found} "$@"\n')
        command.chmod(0o755)
    path = os.pathsep.join([str(folder / "bin"), str(Path(sys.executable).parent), SYSTEM_PATH])
    return os.environ | {"PATH": path, "SLURM_CONF": str(configuration)}


def _free_ports(number: int) -> list[int]:
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(number)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def _start(running: Cluster, daemons: list[subprocess.Popen[bytes]]) -> None:
    """Start the three daemons in the foreground of their own sessions, and wait until the node is idle."""
    folder, environment = running
    munged = ["munged", "--foreground", "--force", "--num-threads=2", f"--key-file={folder}/munge.key"]
    munged += [f"--{kind}-file={folder}/munge.{kind}" for kind in ("pid", "log", "seed")]
    configuration = str(folder / "slurm.conf")
    for command, ready in (
        ([*munged, f"--socket={folder}/munge.socket"], lambda: (folder / "munge.socket").exists()),
        (["slurmctld", "-D", "-f", configuration], lambda: "asperity" in _node_state(running)),
        (["slurmd", "-D", "-N", "asperity", "-f", configuration], lambda: "idle" in _node_state(running)),
    ):
        with open(folder / f"{command[0]}.out", "wb") as output:
            streams = {"stdout": output, "stderr": output}
            daemon = subprocess.Popen(command, env=environment, **streams, start_new_session=True)
        daemons.append(daemon)
        _await(ready, daemon, folder)


def _node_state(running: Cluster) -> str:
    command = ["sinfo", "--noheader", "--Node", "--format=%N %T"]
    return subprocess.run(command, env=running.environment, capture_output=True, text=True).stdout


def _await(
    ready: Callable[[], bool], daemon: subprocess.Popen[bytes], folder: Path, seconds: float = 60
) -> None:
    """Wait for a daemon, or fail with what it wrote."""
    end = time.monotonic() + seconds
    while not ready():
        if daemon.poll() is not None or time.monotonic() > end:
            said = "".join(path.read_text(errors="replace") for path in sorted(folder.glob("*.out")))
            raise RuntimeError(f"{daemon.args} has not started:\n{said}")
        time.sleep(0.2)


def _stop(running: Cluster, daemons: list[subprocess.Popen[bytes]]) -> None:
    """End what still runs, then the daemons, last first."""
    if "idle" not in _node_state(running):
        running.run("scancel", "--user=root")
        end = time.monotonic() + 30
        while "idle" not in _node_state(running) and time.monotonic() < end:
            time.sleep(0.5)
    for daemon in reversed(daemons):
        daemon.terminate()
        try:
            daemon.wait(timeout=15)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()
    for directory, _, _ in os.walk(CGROUPS / "slurm_asperity", topdown=False):
        Path(directory).rmdir()
