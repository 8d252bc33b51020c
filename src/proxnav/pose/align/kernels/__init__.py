"""Compiled inner loops of the alignment."""
