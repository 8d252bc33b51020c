"""Modules of Basilisk (AVSLab, ISC licence): a rendered camera, a pose sensor, relative navigation."""
