"""What tasks say in temporal logic: one formula per task, its monitors, its sampled form."""
