"""Frames in conditions under which poses go wrong: what trust is calibrated on and measured on."""
