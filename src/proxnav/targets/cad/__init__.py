"""Targets from CAD and graphics files."""
