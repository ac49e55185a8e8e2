"""Import robots and modules from the unified robot description format (URDF) of ROS."""
