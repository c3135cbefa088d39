"""Trains PPO over cities with 1 to 5 base stations per km2, and flies it beside agents of Aloft.

    train_ppo.py train POLICY [--steps N]
    train_ppo.py fly POLICY --out FOLDER [--trials N] [--aloft PROGRAM]

The first needs PyTorch and Stable-Baselines3, the second also the programs of Aloft.
"""

import argparse
import contextlib
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import aloft

DENSITIES = [1, 2, 3, 4, 5]
WORLD = {"kind": "generated", "bs_density_per_km2": DENSITIES}
HISTORY = 4  # earlier reports that the policy sees, as the paper's DQN
SEED = 1000  # of the cities that are flown; training uses the seeds 0 to 99
WORKERS = 2


def train(file: Path, steps: int) -> None:
    """Trains and saves a policy. Each density has the same number of environments."""
    import torch
    from scaled import Scaled
    from stable_baselines3 import PPO

    import aloft.sb3

    torch.set_num_threads(1)
    envs = aloft.sb3.vec_env(100, WORLD, history=HISTORY)
    envs.set_options({"condition": np.arange(100) % len(DENSITIES)})
    divisors = {"sinr_db": 20.0, "neighbours_db": 20.0, "quality": 5.0, "reward": 5.0}
    shapes = aloft.HeightEnv(WORLD, history=HISTORY, observation="dict").observation_space.spaces
    scale = np.concatenate([np.full(box.shape[0], 1.0 / divisors.get(name, 1.0)) for name, box in shapes.items()])
    model = PPO(
        "MlpPolicy",
        envs,
        n_steps=100,
        batch_size=2000,
        n_epochs=6,
        gamma=0.95,
        ent_coef=0.02,
        learning_rate=1e-3,
        seed=0,
        device="cpu",
        policy_kwargs={"features_extractor_class": Scaled, "features_extractor_kwargs": {"scale": scale}},
    )
    model.learn(steps)
    model.policy.save(file)


def fly(agent: list[str | Path], out: Path, trials: int, program: str | Path = "aloft", run: str = "ppo", domain: int = 0) -> None:
    """Flies the agent `ppo`, one process per worker, and writes the report. `agent` is its program and first arguments."""
    experiment = {
        "name": "ppo",
        "seed": SEED,
        "trials": trials,
        "world": WORLD,
        "agents": ["min-height", "height-filter", "pretrained", {"type": "external", "name": "ppo"}],
    }
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as started:
        file = Path(folder, "ppo.json")
        file.write_text(json.dumps(experiment))
        agents = [started.enter_context(ends([*agent, str(domain), run, f"w{worker}", "ppo"])) for worker in range(WORKERS)]
        place = ["--run", run, "--domain", str(domain), "--workers", str(WORKERS), "--out", out]
        flown = started.enter_context(ends([program, "run", file, *place]))
        while flown.poll() is None:
            if any(process.poll() is not None for process in agents):
                raise RuntimeError("an agent has ended before the run; what it printed says why")
            time.sleep(0.1)
        if flown.returncode != 0:
            raise RuntimeError(f"aloft run ended with code {flown.returncode}")
    subprocess.run([program, "report", out], check=True)


@contextlib.contextmanager
def ends(command: list[str | Path]) -> Iterator[subprocess.Popen]:
    """A process that ends with the block, if it has not ended before."""
    process = subprocess.Popen(command)
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def show(out: Path) -> None:
    """Mean gain over min-height on the same cities, by density."""
    flights = aloft.read(out).flights
    print("bit/s/Hz over min-height at " + ", ".join(f"{density}" for density in DENSITIES) + " BS/km2")
    for agent in dict.fromkeys(flights["agent"].tolist()):
        gains = []
        for density in DENSITIES:
            here = flights["bs_density_per_km2"] == density
            mean, lowest = (flights["qos_mean"][here & (flights["agent"] == name)].mean() for name in (agent, "min-height"))
            gains.append(f"{mean - lowest:+.2f}")
        print(f"{agent:15}", *gains)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=["train", "fly"])
    parser.add_argument("policy", type=Path, help="file of the policy")
    parser.add_argument("--steps", type=int, default=500_000, help="of training [%(default)s]")
    parser.add_argument("--out", type=Path, default=Path("results/ppo"), help="result folder [%(default)s]")
    parser.add_argument("--trials", type=int, default=30, help="per density [%(default)s]")
    parser.add_argument("--aloft", default="aloft", help="the program [%(default)s]")
    options = parser.parse_args()
    if options.what == "train":
        train(options.policy, options.steps)
    else:
        agent = Path(__file__).with_name("sb3_policy.py")
        fly([sys.executable, agent, options.policy, str(HISTORY)], options.out, options.trials, options.aloft)
        show(options.out)


if __name__ == "__main__":
    main()
