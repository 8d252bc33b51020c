"""Embree and numba: the fast renderer for training data and closed loops."""
