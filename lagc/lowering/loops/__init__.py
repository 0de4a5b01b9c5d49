"""Loop rolling: parts of the equations that differ in indices alone become one loop."""
