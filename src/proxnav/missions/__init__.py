"""Missions: everything that rendering, training, estimation and navigation must agree on, said once."""

from proxnav.missions.files import MISSION, load_mission, mission_in, write_mission
from proxnav.missions.flights import fly, fly_mission
from proxnav.missions.mission import Mission

__all__ = ["MISSION", "Mission", "fly", "fly_mission", "load_mission", "mission_in", "write_mission"]
