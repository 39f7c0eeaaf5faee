"""The process in which MuJoCo expands a model: models that copy or attach themselves end it, and nothing else."""
