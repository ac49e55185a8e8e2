"""Steps of a robot in doubles, over all samples at once, and their derivatives."""
