"""Searches parameters of the algorithm `strokes` by CMA-ES (N. Hansen, The CMA Evolution Strategy: A Tutorial, 2016),
in the stand-in. What it finds is to be proved in the physics, on other beds (docs/studies/leveling-trials.md).

    python3 tune_strokes.py [GENERATIONS [MINUTES]]
"""

import sys

import numpy as np
import screed

GENERATIONS, MINUTES = (int(word) for word in (sys.argv[1:] + ["10", "10"][len(sys.argv) - 1:]))
NAMES = ["stroke_down", "stroke_up", "stroke_ease"]
START, SPREAD = np.array([180.0, 200.0, 30.0]), np.array([30.0, 30.0, 6.0])
BEDS = range(21, 29)


def height_left(scaled):
    """Of the height about level, the mean over the beds; less is better."""
    values = np.rint(START + SPREAD * scaled).astype(int)
    keys = {f"parameters.{name}": value for name, value in zip(NAMES, values)}
    worlds = screed.Worlds("level_bed", BEDS, set={"experiment.algorithm": "strokes", **keys})
    before = worlds.level()["level_deviation"]
    worlds.advance(MINUTES * 6000)
    return (worlds.level()["level_deviation"] / before).mean()


size, count = len(NAMES), 8
weights = np.log(count / 2 + 0.5) - np.log(np.arange(1, count // 2 + 1))
weights /= weights.sum()
mass = 1 / (weights**2).sum()
rate_path, rate_sigma = 4 / (size + 4), (mass + 2) / (size + mass + 5)
rate_one = 2 / ((size + 1.3) ** 2 + mass)
rate_mean = min(1 - rate_one, 2 * (mass - 2 + 1 / mass) / ((size + 2) ** 2 + mass))
expected = np.sqrt(size) * (1 - 1 / (4 * size) + 1 / (21 * size**2))
random = np.random.default_rng(1)
mean, sigma, spread = np.zeros(size), 1.0, np.eye(size)
path, path_sigma = np.zeros(size), np.zeros(size)
print("as it is", round(height_left(mean), 4))
for generation in range(1, GENERATIONS + 1):
    root = np.linalg.cholesky(spread)
    steps = random.standard_normal((count, size)) @ root.T
    order = np.argsort([height_left(mean + sigma * step) for step in steps])
    best = steps[order[: count // 2]]
    move = weights @ best
    mean = mean + sigma * move
    path_sigma *= 1 - rate_sigma
    path_sigma += np.sqrt(rate_sigma * (2 - rate_sigma) * mass) * np.linalg.solve(root, move)
    path = (1 - rate_path) * path + np.sqrt(rate_path * (2 - rate_path) * mass) * move
    spread = ((1 - rate_one - rate_mean) * spread + rate_one * np.outer(path, path)
              + rate_mean * (weights * best.T) @ best)
    sigma *= np.exp(rate_sigma * (np.linalg.norm(path_sigma) / expected - 1))
    print(generation, dict(zip(NAMES, np.rint(START + SPREAD * mean).astype(int).tolist())),
          round(height_left(mean), 4), flush=True)
