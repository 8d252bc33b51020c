"""How far a pose may be believed."""

from proxnav.pose.trust.local_correlation import Similarity, local_correlation
from proxnav.pose.trust.verdict import TrustConfig, judged

__all__ = ["Similarity", "TrustConfig", "judged", "local_correlation"]
