"""The search for a design: motions along plans, and the parameters that make them robust."""
