"""What a task asks of every motion whatever the robot, as clauses."""
