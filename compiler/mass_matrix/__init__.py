"""Whether the mass matrix of a robot is positive definite over its whole box."""
