"""Maps of obstacles, from map_server images and GeoJSON polygons to exact convex pieces."""
