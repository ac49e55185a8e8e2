"""The version; importing it is faster than reading the metadata of the package."""

VERSION = "0.1.0"
