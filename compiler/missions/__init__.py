"""Missions: boxes of parameters, the changes from robot to robot, and the cheapest chains."""
