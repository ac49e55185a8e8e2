"""The texts for whatever is under the pointer."""
