"""Who is where: generators and file readers that give a Trajectory."""
