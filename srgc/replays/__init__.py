"""Replay the planned inputs in other simulators, and compare with the certified tube."""
