"""The shape of a document: outline, folds, colours, links."""
