"""Procedural surface patterns: nominal ones by kind of material, and random fields for training."""
