#!/usr/bin/env python3
"""Environment steps per second in Python, worlds included, beside environments that everybody knows.

    PYTHONPATH=build/python build/python-venv/bin/python bench/python_environments.py

A random policy steps 64 environments. All are measured in turns, and the best turn of each counts. CPU time is that of all
threads, so steps per CPU second are those of one core. EnvPool is measured if it is installed.
"""

import time

import gymnasium as gym
import numpy as np

import aloft

ENVIRONMENTS, TURNS, TURN_S = 64, 5, 1.0


class Vector:
    """A vector environment of Gymnasium, at a random policy."""

    def __init__(self, name, threads, envs, actions):
        self.name, self.threads, self.envs = name, threads, envs
        self.actions = np.random.default_rng(1).integers(actions, size=(256, ENVIRONMENTS))
        self.per_cpu_s = self.per_s = 0.0
        self.begin()

    def begin(self):
        self.envs.reset(seed=1)

    def turn(self):
        calls, wall, cpu = 0, time.perf_counter(), time.process_time()
        while (spent := time.perf_counter() - wall) < TURN_S:
            for actions in self.actions:
                self.envs.step(actions)
            calls += len(self.actions)
        self.per_cpu_s = max(self.per_cpu_s, calls * ENVIRONMENTS / (time.process_time() - cpu))
        self.per_s = max(self.per_s, calls * ENVIRONMENTS / spent)


class EnvPool(Vector):
    def begin(self):
        self.envs.reset()
        self.actions = self.actions.astype(np.int32)


def candidates():
    for density in (1, 2.5, 5):
        for threads in (1, 2):
            envs = aloft.HeightVectorEnv(ENVIRONMENTS, {"bs_density_per_km2": density}, num_threads=threads)
            yield Vector(f"HeightVectorEnv, {density} BS per km2", threads, envs, 3)
    yield Vector("CartPole-v1, SyncVectorEnv", 1, gym.make_vec("CartPole-v1", ENVIRONMENTS, vectorization_mode="sync"), 2)
    try:
        import envpool
    except ImportError as error:
        print(f"EnvPool is not measured: {error}")
        return
    for threads in (1, 2):
        envs = envpool.make_gymnasium("CartPole-v1", num_envs=ENVIRONMENTS, num_threads=threads)
        yield EnvPool("CartPole-v1, EnvPool", threads, envs, 2)


def main():
    measured = list(candidates())
    for _ in range(TURNS):
        for one in measured:
            one.turn()
    print(f"{'64 environments':32} {'threads':>7} {'steps per CPU second':>21} {'steps per second':>17}")
    for one in measured:
        print(f"{one.name:32} {one.threads:7} {one.per_cpu_s:21.0f} {one.per_s:17.0f}")


main()
