"""Turn a design into a scene of moving links among regions, for pictures, logs and views."""
