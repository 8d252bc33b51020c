"""Keypoints with covariances from an image."""
