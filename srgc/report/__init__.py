"""Reports: a result folder as one self-contained HTML page."""
