"""How far a pose may be believed."""

from proxnav.pose.trust.evidence import Evidence
from proxnav.pose.trust.local_correlation import Similarity, local_correlation
from proxnav.pose.trust.saturation import saturated_share
from proxnav.pose.trust.verdict import CheckedBy, TrustCalibration, TrustConfig, judged, verdict_of

__all__ = [
    "CheckedBy",
    "Evidence",
    "Similarity",
    "TrustCalibration",
    "TrustConfig",
    "judged",
    "local_correlation",
    "saturated_share",
    "verdict_of",
]
