"""A node of ROS 2 over DDS, without a ROS installation."""
