"""Our detector: find the target, crop, and read sub-pixel keypoints with covariances off heat maps."""
