"""A robot as a package of ROS 2, with a configuration for MoveIt."""
