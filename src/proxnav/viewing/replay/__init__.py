"""A run as something that can be played: Rerun recording, video, MCAP."""
