"""The drawn parts of a report: the robot beside its word and derivation, and its motion.

Their styles and scripts are in ``assets``; a page needs each once.
"""

from srgc.report.motion.animation import motion_section
from srgc.report.motion.robot_and_word import robot_section

__all__ = ["motion_section", "robot_section"]
