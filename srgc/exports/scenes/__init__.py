"""A design as a scene of rigid links that move among regions: for pictures, logs and views."""
