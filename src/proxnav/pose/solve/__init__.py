"""Pose with covariance from keypoints."""
