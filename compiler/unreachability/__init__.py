"""Why a robot cannot do a task: coverings by boxes, and bounds of what actuators can do."""
