"""The first layer of the policy in train_ppo.py. In a file of its own, so that a saved policy finds it."""

import torch
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor


class Scaled(BaseFeaturesExtractor):
    """Brings dB and bit/s/Hz to the order of 1."""

    def __init__(self, observation_space, scale):
        super().__init__(observation_space, len(scale))
        self.register_buffer("scale", torch.tensor(scale, dtype=torch.float32))

    def forward(self, observations):
        return observations * self.scale
