"""Blender's path tracer, in an interpreter of its own."""

from proxnav.rendering.cycles.config import CyclesConfig

__all__ = ["CyclesConfig"]
