"""The robot model, its normal form and equality, its states, inputs and their bounds."""
