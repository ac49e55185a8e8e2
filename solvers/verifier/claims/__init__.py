"""What a verdict claims, as data, and the checks of it that integrate nothing."""
