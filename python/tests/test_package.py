import gymnasium

import aloft


def test_import_registers_the_environment() -> None:
    spec = gymnasium.spec("Aloft/Height-v0")
    assert (spec.entry_point, spec.vector_entry_point) == ("aloft:HeightEnv", "aloft:HeightVectorEnv")
    assert spec.max_episode_steps is None


def test_unknown_names_are_attribute_errors() -> None:
    assert not hasattr(aloft, "no_such_name")
    assert "HeightEnv" in dir(aloft)
