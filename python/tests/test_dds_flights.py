"""Reports to commands, without a bus."""

import dataclasses
import subprocess
import sys

import pytest

from aloft import wire
from aloft.dds import Action, Agent, Flights, PolicyAgent


def report(step: int = 0, **changes: object) -> wire.ChannelReport:
    made = wire.ChannelReport(
        stream=3,
        protocol_version=wire.PROTOCOL_VERSION,
        experiment_id="0123456789abcdef",
        agent="visitor",
        relay="",
        episode_id=77,
        attempt=10,
        condition=0,
        trial=4,
        seed=5,
        qos_kind=wire.QosKind.QOS_SPECTRAL_EFFICIENCY,
        height_min_m=40.0,
        height_max_m=240.0,
        height_step_m=10.0,
        steps=100,
        step=step,
        x_m=0.0,
        y_m=0.0,
        height_m=40.0,
        serving_cell=1,
        serving_sinr_db=3.0,
        neighbour_sinr_db=[1.0, 0.0],
        qos=2.0,
        executed=Action.ACTION_NONE if step == 0 else Action.ACTION_UP,
        executed_by="" if step == 0 else "visitor",
        reward=2.0,
        last=False,
    )
    return dataclasses.replace(made, **changes)


def site_map(step: int = 0, **changes: object) -> wire.SiteMap:
    made = wire.SiteMap(
        stream=3,
        protocol_version=wire.PROTOCOL_VERSION,
        episode_id=77,
        attempt=10,
        step=step,
        update=False,
        position_error_m=0.0,
        missing=0.0,
        route_points=0,
        route=[],
        sites=[],
        radio_json=b"{}",
    )
    return dataclasses.replace(made, **changes)


class Counter(Agent):
    """Climbs as often as it has been asked in this flight, and counts what it was told over all flights."""

    def __init__(self) -> None:
        self.told: list[tuple[str, int]] = []

    def begin(self, report: wire.ChannelReport) -> None:
        self.asked = 0
        self.told.append(("begin", report.step))

    def survey(self, site_map: wire.SiteMap) -> None:
        self.told.append(("survey", site_map.step))

    def act(self, report: wire.ChannelReport) -> Action:
        self.asked += 1
        self.told.append(("act", report.step))
        return Action.ACTION_UP if self.asked % 2 else Action.ACTION_DOWN

    def end(self, report: wire.ChannelReport) -> None:
        self.told.append(("end", report.step))


class Mapped(Counter):
    privilege = "site-map"


class Stateless(Counter):
    stateless = True


def test_a_command_is_addressed_as_its_report() -> None:
    command = Flights(Counter(), "visitor").answer(report())
    assert (command.stream, command.episode_id, command.attempt, command.step) == (3, 77, 10, 1)
    assert (command.agent, command.action, command.protocol_version) == ("visitor", Action.ACTION_UP, wire.PROTOCOL_VERSION)


def test_the_same_report_gets_the_same_command_and_the_agent_is_asked_once() -> None:
    agent = Counter()
    flights = Flights(agent, "visitor")
    first = flights.answer(report(0))
    assert flights.answer(report(0)) == first
    second = flights.answer(report(1))
    assert second.action == Action.ACTION_DOWN
    assert flights.answer(report(1)) == second
    assert flights.answer(report(0)) is None
    assert agent.told == [("begin", 0), ("act", 0), ("act", 1)]


def test_each_flight_has_a_copy_of_the_agent() -> None:
    flights = Flights(Counter(), "visitor")
    flights.answer(report(0))
    assert flights.answer(report(1)).action == Action.ACTION_DOWN
    assert flights.answer(report(0, stream=4, attempt=11, episode_id=78)).action == Action.ACTION_UP
    assert flights.answer(report(2)).action == Action.ACTION_UP
    assert flights.flying == 2


def test_a_flight_ends_with_its_last_report() -> None:
    agent = Counter()
    flights = Flights(agent, "visitor")
    flights.answer(report(0))
    assert flights.answer(report(1, last=True)) is None
    assert flights.answer(report(1, last=True)) is None
    assert agent.told == [("begin", 0), ("act", 0), ("end", 1)]
    assert (flights.flying, flights.served) == (0, 1)


def test_a_new_attempt_is_a_new_flight_and_an_older_one_is_stale() -> None:
    flights = Flights(Counter(), "visitor")
    flights.answer(report(0))
    flights.answer(report(1))
    assert flights.answer(report(0, attempt=11)).action == Action.ACTION_UP
    assert flights.answer(report(1, attempt=10)) is None
    assert flights.answer(report(1, attempt=11)).action == Action.ACTION_DOWN


def test_after_the_end_of_a_flight_attempts_may_be_counted_anew() -> None:
    flights = Flights(Counter(), "visitor")
    assert flights.answer(report(0, attempt=2**31 + 5))
    assert flights.answer(report(1, attempt=2**31 + 5, last=True)) is None
    assert flights.answer(report(0, attempt=1))


def test_more_history_than_environments_have_is_refused() -> None:
    with pytest.raises(ValueError, match="history: 50000000 is not allowed; use a whole number from 0 to 1024"):
        PolicyAgent(None, history=50_000_000)


def test_attempts_may_wrap_around() -> None:
    flights = Flights(Counter(), "visitor")
    flights.answer(report(0, attempt=2**32 - 1))
    assert flights.answer(report(0, attempt=0)) is not None
    assert flights.answer(report(0, attempt=2**32 - 1)) is None


def test_only_reports_for_this_agent_are_answered() -> None:
    assert Flights(Counter(), "visitor").answer(report(agent="min-height")) is None


def test_a_flight_of_an_earlier_process_starts_again_unless_the_agent_is_stateless() -> None:
    command = Flights(Counter(), "visitor").answer(report(51))
    assert (command.action, command.step) == (Action.ACTION_UNKNOWN_FLIGHT, 52)
    assert Flights(Stateless(), "visitor").answer(report(51)).action == Action.ACTION_UP


def test_in_a_relay_the_agent_comes_aboard_when_it_is_asked() -> None:
    agent = Counter()
    flights = Flights(agent, "visitor")
    assert flights.answer(report(49, agent="dqn", relay="uav", executed_by="dqn")) is None
    assert flights.answer(report(50, relay="uav", executed_by="dqn")).step == 51
    flights.answer(report(51, relay="uav"))
    assert flights.answer(report(52, relay="uav", agent="dqn")) is None
    flights.answer(report(80, relay="uav", executed_by="dqn"))
    assert agent.told == [("begin", 50), ("act", 50), ("act", 51), ("begin", 80), ("act", 80)]


@pytest.mark.parametrize("map_first", [True, False])
def test_a_flight_with_the_site_map_waits_for_it(map_first: bool) -> None:
    agent = Mapped()
    flights = Flights(agent, "visitor")
    assert flights.survey(site_map(attempt=9)) is None
    if map_first:
        assert flights.survey(site_map()) is None
        command = flights.answer(report(0))
    else:
        assert flights.answer(report(0)) is None
        command = flights.survey(site_map())
    assert command.step == 1
    assert flights.survey(site_map()) is None
    assert flights.answer(report(1)).step == 2
    assert agent.told == [("begin", 0), ("survey", 0), ("act", 0), ("act", 1)]


def test_a_route_told_in_parts_is_waited_for_at_every_step() -> None:
    agent = Mapped()
    flights = Flights(agent, "visitor")
    assert flights.survey(site_map(0, route_points=5)) is None
    assert flights.answer(report(0)).step == 1
    assert flights.answer(report(1)) is None
    assert flights.survey(site_map(1, route_points=5, update=True)).step == 2
    assert agent.told == [("begin", 0), ("survey", 0), ("act", 0), ("survey", 1), ("act", 1)]


def test_an_update_is_no_map_to_begin_with() -> None:
    flights = Flights(Mapped(), "visitor")
    assert flights.survey(site_map(0, update=True)) is None
    assert flights.answer(report(0)) is None
    assert flights.survey(site_map(0)).step == 1


def test_an_action_that_is_none_is_refused() -> None:
    class Jumper(Agent):
        def act(self, report: wire.ChannelReport) -> Action:
            return Action.ACTION_ABSOLUTE

    with pytest.raises(TypeError, match=r"Jumper\.act returned .*ABSOLUTE.* after step 0 of trial 4; return one of Action\.ACTION_DOWN"):
        Flights(Jumper(), "visitor").answer(report())
    with pytest.raises(NotImplementedError, match=r"Agent must define act\(report\)"):
        Flights(Agent(), "visitor").answer(report())


def test_another_version_of_the_protocol_is_refused() -> None:
    with pytest.raises(RuntimeError, match="speaks version 2 .* version 1: install"):
        Flights(Counter(), "visitor").answer(report(protocol_version=2))


def test_a_wrong_name_or_privilege_is_refused_before_anything_is_sent() -> None:
    with pytest.raises(ValueError, match=r"name '' has 0 bytes; use .* 1 to 64"):
        Counter().run(name="")
    agent = Counter()
    agent.privilege = "all"
    with pytest.raises(ValueError, match="Counter.privilege is 'all'; use one of '', 'site-map'"):
        agent.run()


def test_without_cyclone_dds_the_error_says_what_to_install() -> None:
    program = "import sys; sys.modules['cyclonedds'] = None; import aloft.dds"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert "ModuleNotFoundError: aloft.dds needs Eclipse Cyclone DDS: run 'pip install aloft[dds]'" in done.stderr
