"""Plots, report and replay."""
