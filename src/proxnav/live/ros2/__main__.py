"""`python -m proxnav.live.ros2 --image /camera/image_raw`: the node until Ctrl-C."""

from dataclasses import dataclass, field

from proxnav.errors import InputError
from proxnav.live.ros2.node_config import NodeConfig


@dataclass(frozen=True)
class Options:
    """The node and its model."""

    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    threads: int = 0
    """Threads of the network; 0 takes all cores."""
    node: NodeConfig = field(default_factory=NodeConfig)


def main() -> None:
    """Starts the node."""
    import tyro

    options = tyro.cli(tyro.conf.OmitArgPrefixes[Options], description="Poses of the target for ROS 2, over DDS.")
    try:
        from proxnav.estimator import PoseEstimator
        from proxnav.live.ros2.node import PoseNode

        node = PoseNode(PoseEstimator.load(options.model, threads=options.threads), options.node)
    except InputError as error:
        raise SystemExit(f"error: {error}") from None
    print(f"listening to {options.node.image} and {options.node.camera_info}; Ctrl-C ends it", flush=True)
    try:
        node.run()
    except KeyboardInterrupt:
        print(node.health.intake.summary())


if __name__ == "__main__":
    main()
