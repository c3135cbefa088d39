"""Agents in Python that fly in ``aloft run``, over Eclipse Cyclone DDS: ``pip install aloft[dds]``.

    from aloft.dds import Action, Agent

    class MinHeight(Agent):
        def act(self, report):
            return Action.ACTION_DOWN if report.height_m > report.height_min_m else Action.ACTION_HOLD

    MinHeight().run(domain=0, run="demo", worker="w0", name="visitor")

docs/external-agent.md of Aloft tells how an experiment names such an agent, and what its commands mean.
"""

import contextlib
import copy
import ctypes
import itertools
import os
import signal
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType
from typing import Any, Self

try:
    from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState, WaitSet
    from cyclonedds.domain import Domain, DomainParticipant
    from cyclonedds.idl import IdlStruct
    from cyclonedds.internal import InvalidSample, c_call, dds_c_t
    from cyclonedds.pub import DataWriter, Publisher
    from cyclonedds.qos import Policy, Qos
    from cyclonedds.sub import DataReader, Subscriber
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "aloft.dds needs Eclipse Cyclone DDS: run 'pip install aloft[dds]' (or 'pip install cyclonedds')",
        name=error.name,
    ) from error

from aloft import _core, wire
from aloft.wire import Action

__all__ = ["Action", "Agent", "Flights", "PolicyAgent", "wire"]

_PRIVILEGES = {"": wire.Privilege.PRIVILEGE_NONE, "site-map": wire.Privilege.PRIVILEGE_SITE_MAP}
_COMMANDS = (Action.ACTION_DOWN, Action.ACTION_HOLD, Action.ACTION_UP)


class Agent:
    """What flies. Write `act`; and `begin`, if the agent has to remember something of a flight.

    A worker has many flights in the air at the same time, and each is flown by a copy of the object that was run
    (`copy.copy`). So what `begin` assigns to `self` belongs to one flight, and what `__init__` made, such as a network,
    is shared by all.
    """

    stateless = False
    """Needs none of the earlier reports of a flight: after a restart of the process its flights simply go on."""

    privilege = ""
    """"site-map": `survey` is called. The experiment must state the same privilege."""

    def begin(self, report: wire.ChannelReport) -> None:
        """A flight begins with this report, of step 0; or of a later one in a relay, or if the agent is stateless."""

    def survey(self, site_map: wire.SiteMap) -> None:
        """Called before the first `act` of a flight, and before each, if the route is told in parts."""

    def act(self, report: wire.ChannelReport) -> Action:
        """ACTION_DOWN, ACTION_HOLD or ACTION_UP. Called once per report, in the order of the steps."""
        raise NotImplementedError(f"{type(self).__name__} must define act(report)")

    def end(self, report: wire.ChannelReport) -> None:
        """The last report of a flight, with the reward of the last action."""

    def run(self, domain: int = 0, run: str = "aloft", worker: str = "w0", name: str = "external") -> None:
        """Flies as agent `name` of the experiment on one worker, until Ctrl-C, SIGTERM or `stop`.

        On the loopback interface, as `aloft run` does, unless the environment variable CYCLONEDDS_URI configures Cyclone DDS.
        """
        if self.privilege not in _PRIVILEGES:
            raise ValueError(
                f"{type(self).__name__}.privilege is {self.privilege!r}; use one of {', '.join(map(repr, _PRIVILEGES))}"
            )
        if not 0 < len(name.encode()) <= 64:
            raise ValueError(f"name {name!r} has {len(name.encode())} bytes; use the agent's name in the experiment, 1 to 64")
        self._stopped = threading.Event()
        flights = Flights(self, name)
        place = _Place(domain, f"aloft/{run}/{worker}", self.privilege == "site-map")
        with _stopped_by_signals(self._stopped), _SignsOfLife(place, flights) as life:
            while not self._stopped.is_set():
                life.check()
                place.answer(flights)

    def stop(self) -> None:
        """Ends `run`, from another thread."""
        self._stopped.set()


class PolicyAgent(Agent):
    """Flies a policy that was trained in `aloft.HeightEnv`: anything with ``predict(observation, **options)``.

    That returns an action of the environment (0 down, 1 hold, 2 up), alone or first in a tuple, as models of
    Stable-Baselines3 do. `history` and `site_map` are those of the environment; its observation must be "flat". Give a
    stochastic policy the option ``deterministic=True``, so that a flight that starts again is the same.
    """

    def __init__(self, policy: Any, *, history: int = 0, site_map: int = 0, **options: Any) -> None:
        self.policy = policy
        self.stateless = history == 0
        self.privilege = "site-map" if site_map else ""
        self._layout = (history, site_map)
        self._options = options
        _core.Observer(*self._layout)  # numbers that it does not take are refused here

    def begin(self, report: wire.ChannelReport) -> None:
        self._observer = _core.Observer(*self._layout)
        self._observer.begin(report)

    def survey(self, site_map: wire.SiteMap) -> None:
        self._observer.survey(site_map)

    def act(self, report: wire.ChannelReport) -> Action:
        predicted = self.policy.predict(self._observer.note(report), **self._options)
        action = predicted[0] if isinstance(predicted, tuple) else predicted
        if action not in (0, 1, 2):
            raise ValueError(f"{type(self.policy).__name__}.predict returned {action!r}; return 0 (down), 1 (hold) or 2 (up)")
        return Action(int(action) + 1)


@dataclass
class _Flight:
    """A flight that the agent knows."""

    attempt: int
    episode_id: int
    agent: Agent
    told_in_parts: bool  # every report comes with the route ahead
    step: int = -1  # of the latest report that was answered
    command: wire.HeightCommand | None = None


class Flights:
    """From reports to commands, for all flights of a worker. Knows no bus and no clock."""

    def __init__(self, agent: Agent, name: str) -> None:
        self.agent = agent
        self.name = name
        self.served = 0  # seen to their end
        self._flights: dict[int, _Flight] = {}  # by stream, as all of these
        self._attempts: dict[int, int] = {}
        self._site_maps: dict[int, wire.SiteMap] = {}
        self._waiting: dict[int, wire.ChannelReport] = {}  # for their site maps

    @property
    def flying(self) -> int:
        return len(self._flights)

    def waiting(self, stream: int) -> wire.ChannelReport | None:
        """The report that waits for its site map."""
        return self._waiting.get(stream)

    def survey(self, site_map: wire.SiteMap) -> wire.HeightCommand | None:
        """Takes a site map; returns the command after the report that has waited for it, if one has."""
        known = self._site_maps.get(site_map.stream)
        if known is not None and _older(site_map.attempt, known.attempt):
            return None
        self._site_maps[site_map.stream] = site_map
        waiting = self.waiting(site_map.stream)
        return None if waiting is None else self.answer(waiting)

    def answer(self, report: wire.ChannelReport) -> wire.HeightCommand | None:
        """The command after this report; None if another agent is asked, the report is old, or its map is missing."""
        if report.protocol_version != wire.PROTOCOL_VERSION:
            raise RuntimeError(
                f"the worker speaks version {report.protocol_version} of Aloft's protocol, this package version "
                f"{wire.PROTOCOL_VERSION}: install the package of the version that 'aloft --version' names"
            )
        if _older(report.attempt, self._attempts.get(report.stream, report.attempt)):
            return None
        self._attempts[report.stream] = report.attempt
        self._waiting.pop(report.stream, None)
        flight = self._flights.get(report.stream)
        if flight is not None and (flight.attempt, flight.episode_id) != (report.attempt, report.episode_id):
            del self._flights[report.stream]
            flight = None
        if report.last:
            # A later run of the same name may count its attempts anew.
            del self._attempts[report.stream]
            site_map = self._site_maps.get(report.stream)
            if site_map is not None and site_map.attempt == report.attempt:
                del self._site_maps[report.stream]
            if flight is not None:
                del self._flights[report.stream]
                self.served += 1
                flight.agent.end(report)
            return None
        if report.agent != self.name:
            return None
        if flight is not None and report.step <= flight.step:
            return flight.command if report.step == flight.step else None
        if flight is None or report.step > flight.step + 1:
            return self._begin(report)
        site_map = self._site_map_for(report) if flight.told_in_parts else None
        if flight.told_in_parts and site_map is None:
            return None
        return self._act(flight, report, site_map)

    def _begin(self, report: wire.ChannelReport) -> wire.HeightCommand | None:
        self._flights.pop(report.stream, None)
        if report.executed_by == self.name and not self.agent.stateless:
            # This agent flew the last step, in a process that is gone: nobody knows the steps before.
            return _command(report, self.name, Action.ACTION_UNKNOWN_FLIGHT)
        site_map = self._site_map_for(report) if self.agent.privilege else None
        if self.agent.privilege and (site_map is None or site_map.update):
            self._waiting[report.stream] = report
            return None
        told_in_parts = site_map is not None and site_map.route_points > 0
        flight = _Flight(report.attempt, report.episode_id, copy.copy(self.agent), told_in_parts)
        self._flights[report.stream] = flight
        flight.agent.begin(report)
        return self._act(flight, report, site_map)

    def _site_map_for(self, report: wire.ChannelReport) -> wire.SiteMap | None:
        """The site map that was sent with the report; without it, the report waits."""
        site_map = self._site_maps.get(report.stream)
        if site_map is not None and (site_map.attempt, site_map.step) == (report.attempt, report.step):
            return site_map
        self._waiting[report.stream] = report
        return None

    def _act(
        self, flight: _Flight, report: wire.ChannelReport, site_map: wire.SiteMap | None
    ) -> wire.HeightCommand:
        if site_map is not None:
            flight.agent.survey(site_map)
        action = flight.agent.act(report)
        if action not in _COMMANDS:
            raise TypeError(
                f"{type(self.agent).__name__}.act returned {action!r} after step {report.step} of trial {report.trial}; "
                f"return one of {', '.join(f'Action.{command.name}' for command in _COMMANDS)}"
            )
        flight.step = report.step
        flight.command = _command(report, self.name, action)
        return flight.command


def _older(attempt: int, other: int) -> bool:
    """Attempts grow, and may wrap around."""
    return (attempt - other) & 0xFFFFFFFF >= 0x80000000


def _command(report: wire.ChannelReport, name: str, action: Action) -> wire.HeightCommand:
    return wire.HeightCommand(
        stream=report.stream,
        protocol_version=wire.PROTOCOL_VERSION,
        episode_id=report.episode_id,
        attempt=report.attempt,
        step=report.step + 1,
        agent=name,
        action=action,
        height_m=0.0,
        has_introspection=False,
        epsilon=0.0,
        loss=0.0,
        q_values=[0.0, 0.0, 0.0],
    )


# Quality of service of the topics that an agent has: the table of docs/external-agent.md.
_RELIABLE = Policy.Reliability.Reliable(max_blocking_time=duration(seconds=1))
_REPORT_QOS = Qos(_RELIABLE, Policy.Durability.Volatile, Policy.History.KeepLast(8))
_COMMAND_QOS = Qos(
    _RELIABLE,
    Policy.Durability.Volatile,
    Policy.History.KeepLast(8),
    Policy.Ownership.Exclusive,
    Policy.OwnershipStrength(10),
    Policy.Liveliness.ManualByTopic(lease_duration=duration(milliseconds=500)),
)
_STATUS_QOS = Qos(_RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))

_LOOPBACK = """<CycloneDDS><Domain id="any"><General><Interfaces>
<NetworkInterface address="127.0.0.1" multicast="true"/></Interfaces></General></Domain></CycloneDDS>"""

_LONGEST_WAIT = duration(milliseconds=100)
_MOST_SAMPLES = 1024  # one of every stream that a worker can have
_TURN_S = 0.1  # between two signs of life; the lease is 500 ms
_TURNS_PER_STATUS = 5


class _CommandWriter(DataWriter):
    """With what the library does not wrap; a writer of this liveliness has to say that it is alive."""

    @c_call("dds_assert_liveliness")
    def _assert_liveliness(self, entity: dds_c_t.entity) -> dds_c_t.returnv:
        pass

    def assert_liveliness(self) -> None:
        code = self._assert_liveliness(self._ref)
        if code < 0:
            raise DDSException(code, "the liveliness of the HeightCommand writer could not be asserted")


class _Seat:
    """The writer of one stream that the agent shares with others: the worker receives the strongest one's commands."""

    def __init__(self, writer: _CommandWriter) -> None:
        self._writer = writer
        self._asked = False
        self._claim: wire.HeightCommand | None = None

    def hear(self, report: wire.ChannelReport, name: str) -> None:
        asked = report.agent == name
        if asked == self._asked:
            return
        self._asked = asked
        # Stronger than all who were asked before: that those lower their strength is noticed late.
        turn = ((report.attempt % 2**17 + 1) << 14) + report.step
        strength = ctypes.c_int32(turn).value if asked else 1
        self._writer.set_qos(Qos(Policy.OwnershipStrength(strength)))
        # A writer owns only streams that it has written to, so it writes before the agent thinks: a command for another step
        # than the one that is asked for, which the worker ignores.
        self._claim = _command(report, name, Action.ACTION_HOLD) if asked else None
        if self._claim is not None:
            self._claim.step = report.step or 2
            self._writer.write(self._claim)

    def write(self, command: wire.HeightCommand) -> None:
        self._claim = None
        self._writer.write(command)

    def assert_liveliness(self) -> None:
        self._writer.assert_liveliness()
        claim = self._claim
        if claim is not None:  # the worker may have read it before it knew the new strength
            self._writer.write(claim)


class _Place:
    """A worker's partition, as an agent sees it."""

    def __init__(self, domain: int, partition: str, with_site_map: bool) -> None:
        # The domain has to outlive the participant.
        self._domain = Domain(domain, os.environ.get("CYCLONEDDS_URI", _LOOPBACK))
        self._participant = DomainParticipant(domain)
        self._publisher = Publisher(self._participant, Qos(Policy.Partition([partition])))
        self._reports = self._reader(partition, wire.ChannelReport)
        self._site_maps = self._reader(f"{partition}/site-map", wire.SiteMap) if with_site_map else None
        self._command_topic = self._topic(wire.HeightCommand)
        self._commands = self._command_writer()
        self._seats: dict[int, _Seat] = {}  # by stream
        self.statuses = DataWriter(self._publisher, self._topic(wire.AgentStatus), _STATUS_QOS)
        self._news = WaitSet(self._participant)
        for reader in filter(None, [self._reports, self._site_maps]):
            self._news.attach(ReadCondition(reader, SampleState.Any | ViewState.Any | InstanceState.Any))

    def _topic(self, sample: type[IdlStruct]) -> Topic:
        return Topic(self._participant, sample.__name__, sample)

    def _reader(self, partition: str, sample: type[IdlStruct]) -> DataReader:
        subscriber = Subscriber(self._participant, Qos(Policy.Partition([partition])))
        return DataReader(subscriber, self._topic(sample), _REPORT_QOS)

    def _command_writer(self) -> _CommandWriter:
        return _CommandWriter(self._publisher, self._command_topic, _COMMAND_QOS)

    def answer(self, flights: Flights) -> None:
        """Waits for news, for 100 ms at most, and answers them."""
        self._news.wait(_LONGEST_WAIT)
        for site_map in _samples(self._site_maps) if self._site_maps is not None else ():
            waiting = flights.waiting(site_map.stream)
            shared = self._seats.get(site_map.stream) if waiting is not None and waiting.relay else None
            self._write(flights.survey(site_map), self._commands if shared is None else shared)
        for report in _samples(self._reports):
            seat = self._seat(report, flights.name) if report.relay else None
            self._write(flights.answer(report), self._commands if seat is None else seat)

    def _seat(self, report: wire.ChannelReport, name: str) -> _Seat | None:
        """None: in this relay, the agent has not been asked yet."""
        seat = self._seats.get(report.stream)
        if seat is None and report.agent == name:
            seat = self._seats[report.stream] = _Seat(self._command_writer())
        if seat is not None:
            seat.hear(report, name)
        return seat

    @staticmethod
    def _write(command: wire.HeightCommand | None, writer: _CommandWriter | _Seat) -> None:
        if command is not None:
            writer.write(command)

    def assert_liveliness(self) -> None:
        self._commands.assert_liveliness()
        for seat in list(self._seats.values()):
            seat.assert_liveliness()


def _samples(reader: DataReader) -> Iterator[Any]:
    return (sample for sample in reader.take(_MOST_SAMPLES) if not isinstance(sample, InvalidSample))


class _SignsOfLife:
    """Tells the worker ten times a second that the agent lives, also while it thinks."""

    def __init__(self, place: _Place, flights: Flights) -> None:
        self._place = place
        self._flights = flights
        self._over = threading.Event()
        self._failure: DDSException | None = None
        self._thread = threading.Thread(target=self._work, name="signs of life", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        if self._failure is None:
            self._tell(wire.AgentState.AGENT_STOPPED)

    def check(self) -> None:
        if self._failure is not None:
            raise self._failure

    def _work(self) -> None:
        try:
            for turn in itertools.count():
                self._place.assert_liveliness()
                if turn % _TURNS_PER_STATUS == 0:
                    flying = self._flights.flying > 0
                    self._tell(wire.AgentState.AGENT_FLYING if flying else wire.AgentState.AGENT_READY)
                if self._over.wait(_TURN_S):
                    return
        except DDSException as failure:
            self._failure = failure

    def _tell(self, state: wire.AgentState) -> None:
        self._place.statuses.write(
            wire.AgentStatus(
                agent=self._flights.name,
                process="aloft.dds",
                protocol_version=wire.PROTOCOL_VERSION,
                experiment_id="",
                type="external",
                privilege=_PRIVILEGES[self._flights.agent.privilege],
                pid=os.getpid(),
                state=state,
                flights=self._flights.served,
            )
        )


@contextlib.contextmanager
def _stopped_by_signals(stopped: threading.Event) -> Iterator[None]:
    """In the main thread; in others, Python takes no signals. Ctrl-C, too, ends without a stack of calls."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        stopped.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
