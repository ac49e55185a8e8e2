"""Whether a matrix is positive definite over a whole box."""
