"""Estimates against the truth: pairing, errors of many frames, honesty of covariances, tables, run folders."""

from proxnav.evaluation.summary import Summary, summarise

__all__ = ["Summary", "summarise"]
