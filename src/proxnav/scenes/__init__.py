"""What the camera looks at: SceneSpecs from a trajectory or drawn at random."""
