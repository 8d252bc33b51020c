"""Compiled ground of the inner loops: lens, quaternions and small rotations on bare arrays."""
