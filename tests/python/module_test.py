"""The module: the bits of the program, arrays that are those of its files, environments that keep their contract."""

import csv
import json
import os
import pathlib
import resource
import subprocess
import tempfile
import unittest

import numpy as np

import screed

PROGRAM = os.environ["SCREED_PROGRAM"]
LEVEL = {"robots.count": 2, "soil.cell": 0.03}


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Runs(InFolder):
    def run_program(self, *words):
        out = self.folder / "program"
        said = subprocess.run([PROGRAM, "sim", *words, "--out", out, "--no-pictures", "--json"], check=True,
                              capture_output=True)
        return json.loads(said.stdout), out

    def test_a_run_has_the_hash_of_the_programs(self):
        for hal in ("native", "surrogate"):
            with self.subTest(hal):
                self.setUp()
                summary, _ = self.run_program("level_bed", "--hal", hal, "--seed", "3", "--duration", "2", "--set",
                                              "robots.count=2")
                run = screed.sim("level_bed", seed=3, set={"robots.count": 2, "experiment.duration": 2}, hal=hal,
                                 out=self.folder / "module")
                self.assertEqual(run.content_hash, summary["content_hash"])
                self.assertEqual(run.summary["terrain_after"], summary["terrain_after"])

    def test_tables_are_those_of_the_program(self):
        _, out = self.run_program("level_bed", "--hal", "surrogate", "--duration", "12")
        with screed.Session(out) as session:
            frames = session.frames
            self.assertEqual(session.info["seed"], 1)
            self.assertTrue(session.info["complete"])
            for name, table in (("frames", frames), ("leveling", session.leveling)):
                with open(out / f"{name}.csv") as file:
                    rows = list(csv.reader(file))
                names = [column.split(" [")[0] for column in rows[0]]
                self.assertEqual(names, list(table.dtype.names))
                values = np.array(rows[1:], float)
                for i, column in enumerate(names):
                    np.testing.assert_array_equal(values[:, i], table[column], column)
            self.assertEqual(len(session.samples), len(frames))
            self.assertEqual(session.samples["gyro"].shape, (len(frames), 3))
            self.assertEqual(frames.dtype.metadata["x"][0], "m")
            self.assertEqual(session.ground_before.shape, session.ground_after.shape)
            self.assertNotEqual(np.abs(session.ground_after - session.ground_before).max(), 0.0)

    def test_what_is_wrong_is_one_clear_exception(self):
        for wrong, text in ((lambda: screed.sim("no_such"), "no experiment of that name"),
                            (lambda: screed.sim("level_bed", set={"map.size": "wide"}), "map"),
                            (lambda: screed.sim("level_bed", hal="real"), "allowed: native, surrogate"),
                            (lambda: screed.Session(self.folder), "session.h5"),
                            (lambda: screed.World("level_bed", seed=2, set={"robots.count": 2,
                                                                            "robots.placement": "random"}),
                             "random places")):
            with self.assertRaises(screed.InputError) as caught:
                wrong()
            self.assertIn(text, str(caught.exception))
        closed = screed.World("level_bed")
        closed.close()
        with self.assertRaises(screed.InputError):
            closed.advance(1)


class OneWorld(InFolder):
    def test_it_is_the_run_of_its_seed(self):
        run = screed.sim("level_bed", seed=5, set={**LEVEL, "experiment.duration": 12}, hal="surrogate",
                         out=self.folder / "run")
        world = screed.World("level_bed", seed=5, set=LEVEL)
        world.advance(1200)
        for robot in range(2):
            session = run.session(robot)
            self.assertEqual(world.frames[robot], session.frames[-1])
            np.testing.assert_array_equal(world.ground, session.ground_after)
        self.assertEqual(world.level()["level_deviation"], run.summary["terrain_after"]["level_deviation_m"])
        self.assertEqual(world.time, 12.0)

    def test_worlds_come_and_go_without_growth(self):
        prepared = screed.prepare("level_bed", {"soil.cell": 0.05})
        for count in (300, 3000):
            for seed in range(count):
                screed.World(prepared, seed=seed)
            grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            if count == 300:
                before = grown
        self.assertLess(grown - before, 3000)  # kB


class Vectors(unittest.TestCase):
    def make(self, **more):
        env = screed.VectorEnv("level_bed", n=3, set={"soil.cell": 0.03}, duration=1.0, threads=2, **more)
        self.addCleanup(env.close)
        return env

    def drive(self, env, steps=9):
        return [env.step(np.tile([0.2, 0.3], (3, 1))) for _ in range(steps)]

    def test_robots_do_what_they_are_told(self):
        env = self.make()
        observation, infos = env.reset(seed=1)
        self.assertEqual((observation.shape, observation.dtype), ((3, len(env.sensed)), np.float32))
        self.assertTrue(env.observation_space.contains(observation))
        np.testing.assert_array_equal(infos["truth"]["state"], 2)  # they run
        _, rewards, terminated, truncated, infos = self.drive(env)[-1]
        self.assertEqual((rewards.shape, terminated.dtype, truncated.dtype), ((3,), bool, bool))
        np.testing.assert_allclose(infos["truth"]["linear"], 0.2, atol=1e-9)
        np.testing.assert_allclose(infos["truth"]["angular"], 0.3, atol=0.01)
        duty = self.make(action="duty")
        duty.reset(seed=1)
        infos = [duty.step(np.tile([0.9, -0.9], (3, 1))) for _ in range(5)][-1][4]
        self.assertTrue((infos["truth"]["rate_z"] < -0.2).all())

    def test_a_seed_decides_everything(self):
        def observed(seed, threads):
            env = screed.VectorEnv("level_bed", n=4, set={"soil.cell": 0.03}, duration=1.0, threads=threads)
            env.reset(seed=seed)
            return np.array([env.step(np.full((4, 2), 0.2))[0] for _ in range(25)])

        np.testing.assert_array_equal(observed(1, 1), observed(1, 3))
        self.assertTrue((observed(1, 1) != observed(2, 1)).any())

    def test_seeds_may_be_given_for_each_world_and_decide_what_comes_after(self):
        env = self.make()
        seeds = [env.reset(seed=[5, None, 7])[1]["seed"] for _ in range(2)]
        np.testing.assert_array_equal(*seeds)
        self.assertEqual((seeds[0][0], seeds[0][2]), (5, 7))
        again = [(env.reset(seed=3), self.drive(env, 12))[1][-1][4]["seed"] for _ in range(2)]
        np.testing.assert_array_equal(*again)

    def test_all_are_reset_before_some(self):
        env = self.make()
        with self.assertRaisesRegex(screed.InputError, "before all were reset"):
            env.reset(options={"reset_mask": [True, False, False]})
        env.reset(seed=1)
        first = self.drive(env, 3)[-1]
        observation, infos = env.reset(options={"reset_mask": [True, False, False]})
        np.testing.assert_array_equal(observation[1:], first[0][1:])
        self.assertEqual(infos["truth"]["linear"].tolist(), [0.0, 0.2, 0.2])

    def test_next_step_resets_with_the_step_after_the_end(self):
        env = self.make()
        env.reset(seed=1)
        steps = self.drive(env, 12)
        self.assertEqual([bool(step[3].all()) for step in steps], [False] * 9 + [True] + [False] * 2)
        self.assertEqual(set(steps[10][1]), {0.0})  # its action was ignored
        self.assertTrue((steps[10][4]["truth"]["linear"] == 0.0).all())
        self.assertTrue((steps[10][4]["seed"] != steps[9][4]["seed"]).all())
        self.assertTrue((steps[11][4]["truth"]["linear"] > 0.0).all())

    def test_same_step_gives_the_last_observation_as_info(self):
        env = self.make(autoreset="same_step")
        env.reset(seed=1)
        last = self.drive(env, 10)[-1]
        self.assertTrue(last[3].all())
        self.assertTrue((last[4]["truth"]["linear"] == 0.0).all())
        np.testing.assert_array_equal(last[4]["_final_obs"], True)
        other = self.make()
        other.reset(seed=1)
        np.testing.assert_array_equal(last[4]["final_obs"], self.drive(other, 10)[-1][0])

    def test_disabled_wants_to_be_reset(self):
        env = self.make(autoreset="disabled")
        env.reset(seed=1)
        self.drive(env, 10)
        with self.assertRaisesRegex(screed.Error, "after the end of 3 episodes"):
            self.drive(env, 1)
        env.reset(options={"reset_mask": np.array([True, True, True])})
        self.drive(env, 1)

    def test_reward_is_the_height_that_fell(self):
        env = self.make(reward_every=5)
        env.reset(seed=1)
        before = env._worlds.level()["level_deviation"]
        steps = self.drive(env, 10)
        fell = 1e3 * (before - env._worlds.level()["level_deviation"])
        np.testing.assert_allclose(sum(step[1] for step in steps), fell, atol=1e-9)
        own = self.make(reward=lambda worlds: np.arange(3.0))
        own.reset(seed=1)
        np.testing.assert_array_equal(self.drive(own, 1)[0][1], [0.0, 1.0, 2.0])

    def test_misuse_is_one_clear_exception(self):
        env = self.make()
        with self.assertRaisesRegex(screed.Error, "before reset"):
            env.step(np.zeros((3, 2)))
        env.reset(seed=1)
        for wrong, text in ((np.zeros((2, 2)), r"shape \(2, 2\); allowed: \(3, 2\)"),
                            (np.full((3, 2), np.nan), "no numbers")):
            with self.assertRaisesRegex(screed.InputError, text):
                env.step(wrong)
        with self.assertRaisesRegex(screed.InputError, "2 seeds; allowed: one, or 3"):
            env.reset(seed=[1, 2])
        for more, text in (({"n": 10**9}, "allowed: 1 to 65536"), ({"n": 0}, "n = 0"),
                           ({"hal": "native"}, "allowed: surrogate"),
                           ({"duration": 7200}, "65535 commands"),
                           ({"set": {"experiment.algorithm": "strokes"}}, "allowed with commands: drive"),
                           ({"action": "fly"}, "allowed: command, duty"), ({"autoreset": "no"}, "next_step")):
            with self.assertRaisesRegex(screed.InputError, text):
                screed.VectorEnv("level_bed", **{"n": 1, **more})
        env.close()
        env.close()
        with self.assertRaisesRegex(screed.Error, "closed"):
            env.step(np.zeros((3, 2)))


class Others(unittest.TestCase):
    def test_robots_in_parallel(self):
        env = screed.ParallelEnv("level_bed", robots=2, set={"soil.cell": 0.03}, duration=0.5)
        observations, infos = env.reset(seed=1)
        self.assertEqual(set(observations), {"robot_0", "robot_1"})
        self.assertTrue(env.observation_space("robot_0").contains(observations["robot_0"]))
        for step in range(5):
            self.assertEqual(env.agents, env.possible_agents)
            told = {agent: [0.1, 0.0] for agent in env.agents}
            observations, rewards, terminated, truncated, infos = env.step(told)
        self.assertEqual(truncated, {"robot_0": True, "robot_1": True})
        self.assertEqual(env.agents, [])
        self.assertEqual(infos["robot_1"]["truth"]["linear"], 0.1)
        with self.assertRaises(screed.InputError):
            env.step({"robot_0": [0.0, 0.0]})

    def test_as_stable_baselines_takes_it(self):
        env = screed.vec_env(screed.VectorEnv("level_bed", n=2, set={"soil.cell": 0.03}, duration=0.3,
                                              autoreset="same_step"))
        env.seed(1)
        self.assertEqual(env.reset().shape, (2, 11))
        for _ in range(3):
            observation, rewards, done, infos = env.step(np.zeros((2, 2)))
        self.assertTrue(done.all())
        self.assertTrue(infos[0]["TimeLimit.truncated"])
        self.assertEqual(infos[1]["terminal_observation"].shape, (11,))
        self.assertEqual(env.get_attr("num_envs"), [2, 2])


if __name__ == "__main__":
    unittest.main()
