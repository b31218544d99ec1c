"""Environments for learning: many worlds behind the vector interface of Gymnasium 1, one world with several robots as a
parallel environment of PettingZoo, and vector environments as Stable-Baselines3 wants them.

None of these packages is needed. Where Gymnasium is installed, the vector environment is one of its own and has its
spaces; else spaces are those of this file, which have the same members.
"""

from __future__ import annotations

import os
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from . import _library as lib
from .worlds import Worlds, prepare

try:
    from gymnasium.spaces import Box
    from gymnasium.vector import VectorEnv as _VectorBase
    from gymnasium.vector.utils import batch_space
except ImportError:

    class Box:
        """Numbers between bounds, as gymnasium.spaces.Box."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            self.dtype = np.dtype(dtype)
            self.shape = np.shape(low) if shape is None else tuple(shape)
            self.low = np.full(self.shape, low, self.dtype)
            self.high = np.full(self.shape, high, self.dtype)
            self.seed(seed)

        def seed(self, seed=None):
            self._random = np.random.default_rng(seed)

        def sample(self):
            low = np.where(np.isfinite(self.low), self.low, -1e3)
            high = np.where(np.isfinite(self.high), self.high, 1e3)
            return self._random.uniform(low, high).astype(self.dtype)

        def contains(self, x) -> bool:
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all(x >= self.low) and np.all(x <= self.high))

        def __eq__(self, other):
            return (isinstance(other, Box) and self.shape == other.shape and np.array_equal(self.low, other.low)
                    and np.array_equal(self.high, other.high))

    class _VectorBase:
        """What VectorEnv has of gymnasium.vector.VectorEnv."""

        _np_random = None

        @property
        def np_random(self) -> np.random.Generator:
            if self._np_random is None:
                self._np_random = np.random.default_rng()
            return self._np_random

        @property
        def unwrapped(self):
            return self

    def batch_space(space: Box, n: int) -> Box:
        return Box(np.broadcast_to(space.low, (n, *space.shape)), np.broadcast_to(space.high, (n, *space.shape)),
                   (n, *space.shape), space.dtype)


try:
    from gymnasium.vector import AutoresetMode
except ImportError:  # none, or before 1.1: by their names
    AutoresetMode = None
try:
    from pettingzoo import ParallelEnv as _ParallelBase
except ImportError:

    class _ParallelBase:
        """What ParallelEnv has of pettingzoo.ParallelEnv."""

        num_agents = property(lambda self: len(self.agents))
        max_num_agents = property(lambda self: len(self.possible_agents))
        unwrapped = property(lambda self: self)


#: What a robot knows of itself: name, column of its frame or sample, element, factor to SI units.
_SENSED = (
    ("pitch", lib.FRAMES, "est_pitch", None, 1.0), ("roll", lib.FRAMES, "est_roll", None, 1.0),
    ("heading", lib.FRAMES, "est_heading", None, 1.0), ("x", lib.FRAMES, "odometry_x", None, 1.0),
    ("y", lib.FRAMES, "odometry_y", None, 1.0),
    *((f"rate_{axis}", lib.SAMPLES, "gyro", i, 0.07 * np.pi / 180) for i, axis in enumerate("xyz")),
    *((f"force_{axis}", lib.SAMPLES, "accel", i, 0.244e-3 * 9.80665) for i, axis in enumerate("xyz")),
)


class _Robots:
    """Observations of all robots of many worlds, and what they are told."""

    def __init__(self, action: str):
        controls = {"command": (lib.COMMAND, [0.25, 1.5]), "duty": (lib.DUTY, [1.0, 1.0])}
        if action not in controls:
            raise lib.InputError(f"action = {action!r}; allowed: {', '.join(controls)}")
        self.control, limit = controls[action]
        # Of the experiment: until it is told something, a robot stands.
        self.keys = ({"experiment.algorithm": "drive", "drive.speed": 0, "drive.yaw_rate": 0}
                     if action == "command" else {})
        limit = np.array(limit, np.float32)
        self.action_space = Box(-limit, limit, (2,), np.float32)
        self.observation_space = Box(-np.inf, np.inf, (len(_SENSED),), np.float32)

    def tell(self, values: np.ndarray) -> np.ndarray:
        """As the library takes it; what is beyond the space's bounds is cut off."""
        if not np.all(np.isfinite(values)):
            raise lib.InputError("actions that are no numbers")
        told = np.zeros(values.size // 2, lib.ACTION)
        told["control"] = self.control
        told["values"] = np.clip(values.reshape(-1, 2), self.action_space.low, self.action_space.high)
        return told

    def keys_with(self, others: Mapping[str, Any] | None) -> dict[str, Any]:
        """Keys of an experiment, with those that the actions need."""
        others = dict(others or {})
        algorithm = others.get("experiment.algorithm", "drive")
        if "experiment.algorithm" in self.keys and algorithm != "drive":
            raise lib.InputError(f"experiment.algorithm = {algorithm}; allowed with commands: drive")
        return {**self.keys, **others}

    @staticmethod
    def observe(worlds: Worlds) -> np.ndarray:
        """[world, robot, number]."""
        tables = {table: worlds.rows(table) for table in (lib.FRAMES, lib.SAMPLES)}
        observed = np.empty((worlds.count, worlds.robots, len(_SENSED)), np.float32)
        for i, (_, table, column, element, factor) in enumerate(_SENSED):
            values = tables[table][column]
            observed[..., i] = (values if element is None else values[..., element]) * factor
        return observed


class _Episodes:
    """Rewards and ends of many worlds."""

    def __init__(self, worlds: Worlds, steps: int, reward_every: int, reward: Callable | None):
        self.worlds, self.steps, self.reward_every, self.reward = worlds, steps, reward_every, reward
        self.step = np.zeros(worlds.count, int)
        self.height = np.zeros(worlds.count)

    def begin(self, which) -> None:
        self.step[which] = 0
        self.height[which] = self.worlds.level()["level_deviation"][which]

    def end_step(self, others):
        """Rewards, terminations, truncations; nothing of worlds in `others`, which have just begun."""
        self.step[~others] += 1
        frames = self.worlds.rows(lib.FRAMES)
        terminated = (frames["faults"] != 0).any(axis=1) & ~others
        truncated = (self.step >= self.steps) & ~terminated & ~others
        if self.reward is not None:
            rewards = np.asarray(self.reward(self.worlds), float)
            if rewards.shape != (self.worlds.count,):
                raise lib.InputError(f"reward of shape {rewards.shape}; allowed: {(self.worlds.count,)}")
            rewards = np.where(others, 0.0, rewards)
        else:
            rewards = np.zeros(self.worlds.count)
            due = ((self.step % self.reward_every == 0) | terminated | truncated) & ~others
            if due.any():
                height = self.worlds.level()["level_deviation"]
                rewards[due] = 1e3 * (self.height - height)[due]
                self.height[due] = height[due]
        return rewards, terminated, truncated


class VectorEnv(_VectorBase):
    """`n` worlds of an experiment with one robot each, in the stand-in, with the firmware in the loop.

    Actions, one each `ticks` of 10 ms: "command", speed (m/s) and yaw rate (rad/s), which the unchanged firmware
    executes (the experiment's algorithm becomes "drive"); "duty", shares of both motors' voltage.
    Observations: what the robot knows of itself (`sensed` has their names), in SI units; the truth is
    `infos["truth"]`, rows as of Session.frames; without `copy` the next step replaces them.
    Rewards: by how many mm the height of the ground about level has fallen, given every `reward_every` steps; or what
    reward(worlds) returns.
    An episode is truncated after `duration` seconds and terminated by a fault. `autoreset`: "next_step" (an action
    after the end resets and is ignored), "same_step" (the last observation is infos["final_obs"]) or "disabled"
    (reset(options={"reset_mask": mask})).
    A robot stands still for the first five to six seconds, until it is armed: reset() lives through them.
    """

    sensed = tuple(name for name, *_ in _SENSED)

    def __init__(self, experiment: str | os.PathLike = "level_bed", n: int = 16, *, hal: str = "surrogate",
                 set: Mapping[str, Any] | None = None, action: str = "command", ticks: int = 10,
                 duration: float = 600.0, reward_every: int = 10,
                 reward: Callable[[Worlds], Sequence[float]] | None = None, autoreset: str = "next_step",
                 threads: int | None = None, copy: bool = True):
        self.closed = True  # until it is whole
        if hal != "surrogate":
            raise lib.InputError(f"hal = {hal!r}; allowed: surrogate")
        if autoreset not in ("next_step", "same_step", "disabled"):
            raise lib.InputError(f"autoreset = {autoreset!r}; allowed: next_step, same_step, disabled")
        self._robots = _Robots(action)
        if not 1 <= n <= 65536:
            raise lib.InputError(f"n = {n}; allowed: 1 to 65536")
        keys = {"robots.count": 1, **self._robots.keys_with(set)}
        steps = round(duration * 100 / ticks)
        if action == "command" and steps * 1.3 > 65535:
            raise lib.InputError(f"{steps} actions in an episode; allowed: 50000, as a robot takes 65535 commands")
        self._seeds = np.arange(1, n + 1, dtype=np.uint64)
        self._worlds = Worlds(prepare(experiment, keys), self._seeds, threads=threads)
        if self._worlds.robots != 1:
            raise lib.InputError("robots.count: allowed: 1; ParallelEnv has several")
        self.ticks, self.autoreset, self.copy = ticks, autoreset, copy
        self._episodes = _Episodes(self._worlds, steps, reward_every, reward)
        self.num_envs = n
        mode = autoreset if AutoresetMode is None else AutoresetMode[autoreset.upper()]
        self.metadata = {"autoreset_mode": mode, "render_modes": []}
        self.render_mode = None
        self.single_action_space = self._robots.action_space
        self.single_observation_space = self._robots.observation_space
        self.action_space = batch_space(self.single_action_space, n)
        self.observation_space = batch_space(self.single_observation_space, n)
        self._done = np.zeros(n, bool)
        self._fresh = True
        self.closed = False

    _STANDING = 600  # ticks until every robot is armed and runs

    def _restart(self, which: np.ndarray, seeds: np.ndarray | None = None) -> None:
        if seeds is None:
            seeds = self.np_random.integers(0, 2**32, self.num_envs, dtype=np.uint64)
        self._seeds[which] = seeds[which]
        self._worlds.reset(which, self._seeds, self._STANDING)
        self._episodes.begin(which)
        self._done[which] = False

    def _observation(self) -> np.ndarray:
        return self._robots.observe(self._worlds)[:, 0]

    def _infos(self) -> dict[str, Any]:
        truth = self._worlds.rows(lib.FRAMES)[:, 0]
        return {"truth": truth.copy() if self.copy else truth, "seed": self._seeds.copy()}

    def reset(self, *, seed: int | Sequence[int] | None = None, options: dict[str, Any] | None = None):
        """seed: of the first world, the next has one more; or one for each."""
        self._require_open()
        which = np.ones(self.num_envs, bool)
        if options and "reset_mask" in options:
            which = np.asarray(options["reset_mask"], bool)
            if which.shape != (self.num_envs,):
                raise lib.InputError(f"reset_mask of shape {which.shape}; allowed: {(self.num_envs,)}")
            if self._fresh and not which.all():
                raise lib.InputError("reset_mask of some before all were reset")
        self._restart(which, self._seeds_of(seed))
        self._fresh = False
        return self._observation(), self._infos()

    def _seeds_of(self, seed) -> np.ndarray | None:
        """One for each world; draws those that are not given. The generator begins anew with a seed."""
        if seed is None:
            return None
        if isinstance(seed, (int, np.integer)):
            seed = [int(seed) + i for i in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise lib.InputError(f"{len(seed)} seeds; allowed: one, or {self.num_envs}")
        given = [int(its) for its in seed if its is not None]
        if given:
            self._np_random, self._np_random_seed = np.random.default_rng(given), given[0]
        drawn = self.np_random.integers(0, 2**32, self.num_envs, dtype=np.uint64)
        return np.array([drawn[i] if its is None else its for i, its in enumerate(seed)], np.uint64)

    def step(self, actions):
        self._require_open()
        if self._fresh:
            raise lib.Error("step() before reset()")
        actions = np.asarray(actions, float)
        if actions.shape != (self.num_envs, 2):
            raise lib.InputError(f"actions of shape {actions.shape}; allowed: {(self.num_envs, 2)}")
        if self.autoreset == "disabled" and self._done.any():
            raise lib.Error(f"step() after the end of {int(self._done.sum())} episodes: reset() them by their mask")
        begun = self._done.copy()
        told = self._robots.tell(actions)
        told["control"][begun] = lib.FIRMWARE
        self._worlds.advance(self.ticks, told)
        if begun.any():
            self._restart(begun)
        rewards, terminated, truncated = self._episodes.end_step(begun)
        self._done = terminated | truncated
        observation, infos = self._observation(), self._infos()
        if self.autoreset == "same_step" and self._done.any():
            ended = self._done.copy()
            final, final_infos = observation, {**infos, "truth": infos["truth"].copy()}
            self._restart(ended)
            observation, infos = self._observation(), self._infos()
            infos |= {"final_obs": final, "_final_obs": ended, "final_info": final_infos, "_final_info": ended}
        return observation, rewards, terminated, truncated, infos

    def _require_open(self) -> None:
        if self.closed:
            raise lib.Error("the environment is closed")

    def close(self, **_) -> None:
        if not self.closed:
            self._worlds.close()
            self.closed = True

    def __del__(self):
        if not getattr(self, "closed", True):
            self.close()


class ParallelEnv(_ParallelBase):
    """One world with several robots, "robot_0" and so on, as a parallel environment of PettingZoo.

    Actions, observations, rewards and ends as those of VectorEnv, the reward the same for all: they level one bed. A
    robot with a fault is terminated; it stays where it is.
    """

    metadata = {"name": "screed_level_v0", "render_modes": []}
    render_mode = None

    def __init__(self, experiment: str | os.PathLike = "level_bed", robots: int = 4, *,
                 set: Mapping[str, Any] | None = None, action: str = "command", ticks: int = 10,
                 duration: float = 600.0, reward_every: int = 10):
        self._robots = _Robots(action)
        keys = {**self._robots.keys_with(set), "robots.count": robots}
        self._worlds = Worlds(prepare(experiment, keys), [1], threads=1)
        self._episodes = _Episodes(self._worlds, round(duration * 100 / ticks), reward_every, None)
        self._ticks = ticks
        self.possible_agents = [f"robot_{i}" for i in range(robots)]
        self.agents: list[str] = []
        self._random = np.random.default_rng()
        self.observation_spaces = {agent: self._robots.observation_space for agent in self.possible_agents}
        self.action_spaces = {agent: self._robots.action_space for agent in self.possible_agents}

    def observation_space(self, agent: str) -> Box:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        return self.action_spaces[agent]

    def _of_agents(self, values) -> dict[str, Any]:
        return {agent: values[i] for i, agent in enumerate(self.possible_agents) if agent in self.agents}

    def _observations(self) -> dict[str, np.ndarray]:
        return self._of_agents(self._robots.observe(self._worlds)[0])

    def _infos(self) -> dict[str, dict[str, Any]]:
        return self._of_agents([{"truth": row} for row in self._worlds.rows(lib.FRAMES)[0].copy()])

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None):
        if seed is not None:
            self._random = np.random.default_rng(seed)
        its = int(self._random.integers(0, 2**32)) if seed is None else seed
        which = np.ones(1, bool)
        self._worlds.reset(which, [its], VectorEnv._STANDING)
        self._episodes.begin(which)
        self.agents = list(self.possible_agents)
        return self._observations(), self._infos()

    def step(self, actions: Mapping[str, Sequence[float]]):
        if set(actions) != set(self.agents):
            raise lib.InputError(f"actions of {sorted(actions)}; allowed: of {self.agents}")
        values = np.zeros((len(self.possible_agents), 2))
        for i, agent in enumerate(self.possible_agents):
            if agent in actions:
                values[i] = actions[agent]
        self._worlds.advance(self._ticks, self._robots.tell(values))
        rewards, _, _ = self._episodes.end_step(np.zeros(1, bool))
        faults = self._worlds.rows(lib.FRAMES)["faults"][0] != 0
        over = bool(self._episodes.step[0] >= self._episodes.steps)
        result = (self._observations(), self._of_agents([float(rewards[0])] * len(values)),
                  self._of_agents(faults.tolist()), self._of_agents([over] * len(values)), self._infos())
        alive = self._of_agents(~faults)
        self.agents = [agent for agent in self.agents if alive[agent] and not over]
        return result

    def state(self) -> np.ndarray:
        """Of all robots, one after the other."""
        return self._robots.observe(self._worlds).ravel()

    def render(self) -> None:
        """Nothing: record a run with sim() and see `screed view`."""

    def close(self) -> None:
        self._worlds.close()


def vec_env(env: VectorEnv):
    """A vector environment as Stable-Baselines3 takes it: a VecEnv of its own where the package is installed."""
    try:
        from stable_baselines3.common.vec_env import VecEnv as base
    except ImportError:
        base = object
    if env.autoreset != "same_step":
        raise lib.InputError(f"autoreset = {env.autoreset!r}; allowed here: same_step")

    class VecEnv(base):
        def __init__(self):
            self.num_envs = env.num_envs
            self.observation_space, self.action_space = env.single_observation_space, env.single_action_space
            self.reset_infos = [{} for _ in range(self.num_envs)]
            if base is not object:
                super().__init__(self.num_envs, self.observation_space, self.action_space)
            self._seed, self._actions = None, None

        def seed(self, seed=None):
            self._seed = seed
            return [None if seed is None else seed + i for i in range(self.num_envs)]

        def reset(self):
            observation, _ = env.reset(seed=self._seed)
            self._seed = None
            return observation

        def step_async(self, actions):
            self._actions = actions

        def step_wait(self):
            observation, rewards, terminated, truncated, infos = env.step(self._actions)
            each = [{"truth": row} for row in infos["truth"]]
            for i in np.flatnonzero(terminated | truncated):
                each[i]["terminal_observation"] = infos["final_obs"][i]
                each[i]["TimeLimit.truncated"] = bool(truncated[i])
            return observation, rewards.astype(np.float32), terminated | truncated, each

        def step(self, actions):
            self.step_async(actions)
            return self.step_wait()

        def close(self):
            env.close()

        def _of(self, indices) -> int:
            return self.num_envs if indices is None else len(np.atleast_1d(indices))

        def get_attr(self, attr_name, indices=None):
            return [getattr(env, attr_name)] * self._of(indices)

        def set_attr(self, attr_name, value, indices=None):
            setattr(env, attr_name, value)

        def env_method(self, method_name, *arguments, indices=None, **keywords):
            return [getattr(env, method_name)(*arguments, **keywords)] * self._of(indices)

        def env_is_wrapped(self, wrapper_class, indices=None):
            return [False] * self._of(indices)

    return VecEnv()
