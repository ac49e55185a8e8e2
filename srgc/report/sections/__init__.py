"""The sections of a report, one file each: from the evidence to HTML."""
