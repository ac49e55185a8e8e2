"""What every name of a specification stands for, and where it stands."""
