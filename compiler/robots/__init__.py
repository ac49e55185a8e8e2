"""From derivations to robots: attributes, normal form, equality."""
