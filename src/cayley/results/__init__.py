"""Results: observations, labeled trajectories, the store."""
