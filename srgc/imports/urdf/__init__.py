"""Robots and modules in the unified robot description format of ROS."""
