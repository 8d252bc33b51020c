"""A Ray cluster of two nodes on the loopback of this machine, one processor each."""

import os
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

OBJECTS = 80 * 2**20


@dataclass(frozen=True)
class TwoNodes:
    """The cluster, the node that may be killed, and where clients knock."""

    cluster: Any
    second: Any
    address: str

    def kill_second(self) -> None:
        """As a power cut would."""
        self.cluster.remove_node(self.second, allow_graceful=False)


@pytest.fixture
def two_nodes(monkeypatch: pytest.MonkeyPatch) -> Iterator[TwoNodes]:
    """Started for one test and ended after it."""
    pytest.importorskip("ray", reason="needs pip install 'proxnav[cluster]'")
    # Before ray is imported: it stays on the loopback. Workers find proxnav and the tests' jobs by PYTHONPATH.
    monkeypatch.setenv("RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER", "0")
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    monkeypatch.setenv("GRPC_ENABLE_FORK_SUPPORT", "0")  # see proxnav.cluster.ray_session
    places = [str(Path(__file__).parents[1]), str(Path(__file__).parents[2] / "src"), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, places)))
    from ray.cluster_utils import Cluster

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    shared = {"num_cpus": 1, "object_store_memory": OBJECTS, "node_ip_address": "127.0.0.1"}
    head = {**shared, "include_dashboard": False, "ray_client_server_port": port}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    try:
        assert cluster.address.startswith("127.0.0.1:")
        yield TwoNodes(cluster, cluster.add_node(**shared), f"ray://127.0.0.1:{port}")
    finally:
        cluster.shutdown()
