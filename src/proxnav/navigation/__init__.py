"""Camera, GNSS and IMU fused in one filter."""
