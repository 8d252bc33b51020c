"""Blender's path tracer, in an interpreter of its own."""
