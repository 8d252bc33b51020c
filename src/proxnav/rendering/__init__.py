"""Linear radiance, depth and part ids of a SceneSpec, by Cycles or by ray casting."""
