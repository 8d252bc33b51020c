"""Missions: everything that rendering, training, estimation and navigation must agree on, said once."""

from proxnav.missions.files import load_mission, write_mission
from proxnav.missions.flights import fly
from proxnav.missions.mission import Mission

__all__ = ["Mission", "fly", "load_mission", "write_mission"]
