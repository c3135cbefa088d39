"""A policy of PPO or A2C, saved by `model.policy.save`, as an agent. Usage: sb3_policy.py POLICY HISTORY DOMAIN RUN WORKER NAME"""

import sys

import torch
from stable_baselines3.common.policies import ActorCriticPolicy

from aloft.dds import PolicyAgent

if __name__ == "__main__":
    file, history, domain, *place = sys.argv[1:]
    torch.set_num_threads(1)  # one decision at a time
    policy = ActorCriticPolicy.load(file, device="cpu")
    PolicyAgent(policy, history=int(history), deterministic=True).run(int(domain), *place)
