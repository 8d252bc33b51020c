"""Errors, tables and bounds."""
