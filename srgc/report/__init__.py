"""The report: a result folder as one HTML page that needs nothing else."""
