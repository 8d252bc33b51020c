"""What the node takes from Cyclone DDS, or one sentence where it is not installed."""

from proxnav.errors import InputError

try:
    import cyclonedds.core as core
    import cyclonedds.domain as domain
    import cyclonedds.idl as idl
    import cyclonedds.idl.types as idl_types
    import cyclonedds.pub as pub
    import cyclonedds.sub as sub
    import cyclonedds.topic as topic
except ImportError as error:
    raise InputError("the node of ROS 2 speaks DDS through cyclonedds: pip install 'proxnav[ros2]'") from error

__all__ = ["core", "domain", "idl", "idl_types", "pub", "sub", "topic"]
