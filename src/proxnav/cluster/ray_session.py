"""A connection to Ray: to a cluster by its address, or to one of our own on this machine's loopback."""

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from proxnav.errors import InputError

_OBJECTS = 256 * 2**20
"""Bytes of the object store of a Ray that we start; results are a few hundred kB and few are under way."""


_ATTEMPTS = 3
"""To join a cluster whose head answers, but not in time."""


@contextmanager
def ray_session(address: str | None, workers: int) -> Iterator[Any]:
    """The ray module, connected; what was started here ends here."""
    ray = _imported()
    if ray.is_initialized():
        raise InputError("this process is connected to Ray already; disconnect with ray.shutdown() first")
    try:
        _connect(ray, address, workers)
        yield ray
    finally:
        ray.shutdown()


def _imported() -> Any:
    # Ray has no password: what it opens on a machine of ours, it opens to that machine alone. The variable chooses the
    # loopback address, as Ray does by itself on Windows and macOS, and is read when Ray is imported.
    os.environ.setdefault("RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER", "0")
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    # Ray forks to start its processes; gRPC then stops and starts its threads in both, in which they crash (SIGSEGV in
    # event_engine, grpcio 1.85). Nothing of ours uses gRPC after a fork, so it need not prepare for one.
    os.environ.setdefault("GRPC_ENABLE_FORK_SUPPORT", "0")
    try:
        import ray
    except ImportError:
        raise InputError("--on ray needs Ray: pip install 'proxnav[cluster]'") from None
    return ray


def _connect(ray: Any, address: str | None, workers: int) -> None:
    quiet = {"logging_level": logging.ERROR, "log_to_driver": False}
    if address is None:
        ray.init(
            "local",
            num_cpus=workers or None,
            object_store_memory=_OBJECTS,
            include_dashboard=False,
            _node_ip_address="127.0.0.1",
            **quiet,
        )
        return
    try:
        _join(ray, address, quiet)
    except Exception as error:  # ConnectionError, RuntimeError, gRPC's own: whatever keeps us out
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"{address}: no Ray cluster that this proxnav can join ({reason[:200]}); check that its head runs with "
            f"--ray-client-server-port and that both have ray {ray.__version__} and the same Python"
        ) from None


def _join(ray: Any, address: str, quiet: dict[str, Any]) -> None:
    """The head starts a server for each client and gives up on one that a busy machine starts too slowly: ask again."""
    for attempt in range(_ATTEMPTS):
        try:
            ray.init(address, **quiet)
            return
        except ConnectionAbortedError:
            if attempt == _ATTEMPTS - 1:
                raise
            ray.shutdown()
