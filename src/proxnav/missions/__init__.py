"""Missions: everything that rendering, training, estimation and navigation must agree on, said once."""

from proxnav.missions.files import load_mission, write_mission
from proxnav.missions.flights import fly, fly_mission
from proxnav.missions.mission import Mission

__all__ = ["Mission", "fly", "fly_mission", "load_mission", "write_mission"]
