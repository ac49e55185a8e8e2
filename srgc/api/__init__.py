"""What the functions of ``srgc`` give back: programs, findings, robots, results, reports."""
