"""The version, which takes less time to import than the metadata of the package to read."""

VERSION = "0.1.0"
