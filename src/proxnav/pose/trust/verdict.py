"""What the evidence about a pose amounts to."""

from dataclasses import dataclass

from proxnav.pose.trust.local_correlation import Similarity
from proxnav.records.estimates import Trust


@dataclass(frozen=True, slots=True)
class TrustConfig:
    """Where evidence begins to speak."""

    least_similarity: float = 0.647
    """Similarity of the predicted view that 99 % of good poses exceed."""
    least_contrast: float = 0.02
    """Contrast of the predicted view below which nothing can be compared."""


def judged(similarity: Similarity | None, config: TrustConfig) -> Trust:
    """The verdict on a pose whose predicted view is so like the picture."""
    if similarity is None:
        return Trust("not_verifiable", float("nan"))
    if similarity.contrast < config.least_contrast:
        return Trust("not_verifiable", similarity.score)
    verified = similarity.score >= config.least_similarity
    return Trust("verified" if verified else "contradicted", similarity.score)
