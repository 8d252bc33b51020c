"""DDS between processes of this computer only."""

import os
import random

LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>20</MaxAutoParticipantIndex><Peers><Peer address='localhost'/></Peers></Discovery>"
    "</Domain></CycloneDDS>"
)


def stay_on_loopback() -> None:
    """To be called before the first participant of a process."""
    os.environ["CYCLONEDDS_URI"] = LOOPBACK


def own_domain() -> int:
    """A domain that a test running beside this one hardly shares."""
    return random.Random(os.getpid()).randrange(100, 200)
