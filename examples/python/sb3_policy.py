"""A PPO model of Stable-Baselines3 as an agent. Usage: sb3_policy.py MODEL.zip HISTORY DOMAIN RUN WORKER NAME"""

import sys

import torch
from stable_baselines3 import PPO

from aloft.dds import PolicyAgent

if __name__ == "__main__":
    model, history, domain, *place = sys.argv[1:]
    torch.set_num_threads(1)  # one decision at a time
    PolicyAgent(PPO.load(model, device="cpu"), history=int(history), deterministic=True).run(int(domain), *place)
