"""Write a robot as a ROS 2 package, with a configuration for MoveIt."""
