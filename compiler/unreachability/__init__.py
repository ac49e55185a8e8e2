"""Proofs that a robot cannot do a task: coverings by boxes, and bounds on its actuators."""
