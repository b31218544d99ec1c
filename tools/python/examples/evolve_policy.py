"""Evolves a small network that drives the robot by what it senses, in many worlds at once (evolution strategies:
T. Salimans and others, 2017). Each world tries one change of the weights; all drive the same bed.

    python3 evolve_policy.py [GENERATIONS [SECONDS]]
"""

import sys

import numpy as np
import screed

GENERATIONS, SECONDS = (int(word) for word in (sys.argv[1:] + ["20", "120"][len(sys.argv) - 1:]))
WORLDS, HIDDEN, SIGMA, RATE = 64, 8, 0.1, 0.05
SCALE = np.array([5, 5, 1, 1, 1, 1, 1, 1, 0.1, 0.1, 0.1])

env = screed.VectorEnv("level_bed", n=WORLDS, duration=SECONDS)
inputs, outputs = env.single_observation_space.shape[0], env.single_action_space.shape[0]
sizes = [(inputs + 1) * HIDDEN, (HIDDEN + 1) * outputs]
random = np.random.default_rng(1)
weights = 0.3 * random.standard_normal(sum(sizes))


def act(all_weights, observations):
    """A network for each world."""
    first = all_weights[:, : sizes[0]].reshape(-1, inputs + 1, HIDDEN)
    second = all_weights[:, sizes[0]:].reshape(-1, HIDDEN + 1, outputs)
    hidden = np.tanh(np.einsum("wi,wih->wh", observations * SCALE, first[:, :-1]) + first[:, -1])
    return np.tanh(np.einsum("wh,who->wo", hidden, second[:, :-1]) + second[:, -1]) * env.single_action_space.high


for generation in range(1, GENERATIONS + 1):
    half = random.standard_normal((WORLDS // 2, weights.size))
    changes = np.concatenate([half, -half])
    observations, _ = env.reset(seed=[generation] * WORLDS)
    alive, rewards = np.ones(WORLDS, bool), np.zeros(WORLDS)
    for _ in range(SECONDS * 10):
        observations, reward, terminated, truncated, _ = env.step(act(weights + SIGMA * changes, observations))
        rewards += np.where(alive, reward, 0)
        alive &= ~(terminated | truncated)
    ranks = np.argsort(np.argsort(rewards)) / (WORLDS - 1) - 0.5
    weights += RATE / (WORLDS * SIGMA) * ranks @ changes * WORLDS / 12
    print(f"{generation}: height about level fell by {rewards.mean():.3f} mm, at best {rewards.max():.3f}", flush=True)
