"""Texts and pictures of a flight."""

from typing import Any

import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray

from aloft import _core

_WIDTH, _HEIGHT = 960, 600
_SCALE = 2  # drawn larger and scaled down, which makes smooth edges
_MAP = (16, 52, 560, 596)  # left, top, right, bottom
_CHART_LEFT, _CHART_RIGHT = 628, 940
_PAPER, _INK, _FAINT, _GRID = "#ffffff", "#1f2933", "#6b7785", "#dfe3e8"
_GROUND = (244, 245, 243)
_LOW, _TALL = (214, 219, 224), (58, 70, 84)  # buildings, by height
_UAV, _STATION, _LINK, _QUALITY = "#1565c0", "#c2410c", "#2e9e5b", "#2e7d4f"
# Dark violet, blue, green, yellow: from poor to good quality.
_HEAT = np.array([(48, 18, 84), (44, 92, 140), (42, 160, 132), (158, 214, 74), (253, 231, 76)], np.float64)

_X, _Y, _Z, _QOS, _CELL = range(5)  # columns of what was flown


class Painter:
    """Shows one environment of a fleet."""

    def __init__(self, worlds: _core.Worlds, fleet: _core.Fleet, index: int = 0) -> None:
        self._worlds = worlds
        self._fleet = fleet
        self._index = index
        self._flight: tuple[int, int, int] | None = None
        self._background: Any = None
        self._stations: Any = None  # an array of places, or None
        self._rows = 1  # of the picture of a measurement without places
        self._tallest = 1.0
        self._view = (0.0, 0.0, 1.0)  # of the map: left and lower edge, width; m

    def text(self) -> str:
        facts, flown = self._fleet.facts(self._index), self._fleet.flown(self._index)
        low, high = facts["height_min_m"], facts["height_max_m"]
        now = flown[-1]
        place = round(39 * (now[_Z] - low) / (high - low)) if high > low else 0
        lines = [
            f"seed {facts['seed']}, trial {facts['trial']}, condition {facts['condition']}: "
            f"step {len(flown) - 1} of {facts['steps']}",
            f"{low:g} m |{'.' * place}#{'.' * (39 - place)}| {high:g} m   height {now[_Z]:g} m",
        ]
        if len(flown) > 1:
            scored = flown[1:, _QOS]
            unit = _unit(facts)
            lines.append(f"quality {_shown(facts, now[_QOS]):.2f} {unit}, mean {_shown(facts, scored.mean()):.2f} {unit}")
        return "\n".join(lines) + "\n"

    def picture(self) -> NDArray[np.uint8]:
        try:
            from PIL import Image, ImageDraw, ImageFont
        except ModuleNotFoundError as error:
            raise DependencyNotInstalled('render_mode "rgb_array" needs Pillow: pip install "aloft[render]"') from error
        self._Image, self._ImageDraw, self._ImageFont = Image, ImageDraw, ImageFont
        facts, flown = self._fleet.facts(self._index), self._fleet.flown(self._index)
        flight = facts["condition"], facts["seed"], facts["trial"]
        if flight != self._flight:
            self._draw_background(facts)
            self._flight = flight
        image = self._background.copy()
        draw = ImageDraw.Draw(image)
        self._text(draw, (16, 14), f"Step {len(flown) - 1} of {facts['steps']}", 18, _INK)
        self._text(draw, (_CHART_RIGHT, 18), self._name(facts), 12, _FAINT, "ra")
        self._draw_flight(image, draw, facts, flown)
        heights, quality = flown[:, _Z], _shown(facts, flown[1:, _QOS])
        steps = facts["steps"]
        height_range = facts["height_min_m"], facts["height_max_m"]
        self._chart(draw, (70, 300), "Height, m", _UAV, np.arange(len(heights)), heights, steps, height_range)
        top = max(1.0, float(quality.max(initial=0.0)))
        title = f"Quality, {_unit(facts)}"
        self._chart(draw, (346, 576), title, _QUALITY, np.arange(1, len(heights)), quality, steps, (0.0, _round_up(top)))
        small = image.reduce(_SCALE)
        return np.asarray(small.convert("RGB"), np.uint8)

    def _name(self, facts: dict[str, Any]) -> str:
        name = self._worlds.conditions[facts["condition"]]
        return f"{name[:40]}, seed {facts['seed']}, trial {facts['trial']}"

    # What stays the same during a flight.

    def _draw_background(self, facts: dict[str, Any]) -> None:
        image = self._Image.new("RGB", (_WIDTH * _SCALE, _HEIGHT * _SCALE), _PAPER)
        scene = self._worlds.scene(facts["condition"], facts["seed"], facts["trial"])
        self._stations = scene.get("base_stations_m")
        if self._stations is None:
            image.paste(self._heat_map(), (_MAP[0] * _SCALE, _MAP[1] * _SCALE))
        else:
            self._choose_view(facts["route_m"], scene)
            image.paste(self._city(scene, facts["route_m"]), (_MAP[0] * _SCALE, _MAP[1] * _SCALE))
        self._background = image

    def _choose_view(self, route: NDArray[np.float64], scene: dict[str, Any]) -> None:
        """A square around the route; without a city, with the base stations that are not too far away."""
        low, high = route.min(axis=0), route.max(axis=0)
        size = 1.15 * max(float((high - low).max()), 200.0)
        if "building_height_m" not in scene and len(self._stations):
            far = np.abs(self._stations - (low + high) / 2).max(axis=1)
            size = max(size, min(2.2 * float(np.median(far)), 4 * size))
        middle = (low + high) / 2
        self._view = (middle[0] - size / 2, middle[1] - size / 2, size)

    def _pixels(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places in m on the map as pixels of the map's image."""
        left, lower, size = self._view
        pixels = _SCALE * (_MAP[2] - _MAP[0])
        places = np.asarray(places, np.float64)
        shares = np.stack([(places[..., 0] - left) / size, 1.0 - (places[..., 1] - lower) / size], -1)
        return np.asarray(shares * pixels, np.float64)

    def _city(self, scene: dict[str, Any], route: NDArray[np.float64]) -> Any:
        image = self._Image.new("RGB", (_SCALE * (_MAP[2] - _MAP[0]), _SCALE * (_MAP[3] - _MAP[1])), _GROUND)
        draw = self._ImageDraw.Draw(image)
        if "building_height_m" in scene:
            self._draw_buildings(draw, scene)
        way = self._pixels(route)
        for first, second in zip(way[::2], way[1::2], strict=False):
            draw.line([*first, *second], fill=_FAINT, width=_SCALE)
        size = 5.5 * _SCALE
        for x, y in self._pixels(self._stations):
            corners = [(x, y - 1.2 * size), (x - size, y + 0.8 * size), (x + size, y + 0.8 * size)]
            draw.polygon(corners, fill=_STATION, outline=_PAPER)
        self._draw_scale(draw, scene)
        return image

    def _draw_buildings(self, draw: Any, scene: dict[str, Any]) -> None:
        heights, window, width = scene["building_height_m"], scene["window_m"], scene["building_width_m"]
        if heights.size == 0:
            return
        rows, columns = heights.shape
        x = -window / 2 + window * (np.arange(columns) + 0.5) / columns
        y = -window / 2 + window * (np.arange(rows) + 0.5) / rows
        left, lower, size = self._view
        inside_x = np.flatnonzero((x > left - width) & (x < left + size + width))
        inside_y = np.flatnonzero((y > lower - width) & (y < lower + size + width))
        shown = heights[np.ix_(inside_y, inside_x)]
        if shown.size == 0:
            return
        self._tallest = float(np.quantile(heights, 0.98)) or 1.0
        for row in inside_y:
            for column in inside_x:
                middle = np.array([x[column], y[row]])
                corners = self._pixels(np.array([middle - width / 2, middle + width / 2]))
                box = [corners[0][0], corners[1][1], corners[1][0], corners[0][1]]
                share = min(1.0, float(heights[row, column]) / self._tallest)
                if width * _SCALE * (_MAP[2] - _MAP[0]) / size > 10:
                    lift = (2 + 5 * share) * _SCALE / 2
                    draw.rectangle([box[0] + lift, box[1] + lift, box[2] + lift, box[3] + lift], fill=(228, 230, 229))
                draw.rectangle(box, fill=_mixed(_LOW, _TALL, share))

    def _draw_scale(self, draw: Any, scene: dict[str, Any]) -> None:
        """A bar of a round length, and what the shades of buildings mean."""
        edge = _SCALE * (_MAP[3] - _MAP[1])
        length = _round_down(self._view[2] / 4)
        bar = length / self._view[2] * edge
        left, base = 10 * _SCALE, edge - 12 * _SCALE
        shades = "building_height_m" in scene and scene["building_height_m"].size > 0
        panel = bar + (210 if shades else 84) * _SCALE
        draw.rounded_rectangle(
            [4 * _SCALE, edge - 30 * _SCALE, left + panel, edge - 4 * _SCALE], 4 * _SCALE, fill=_PAPER, outline=_GRID
        )
        draw.line([left, base, left + bar, base], fill=_INK, width=2 * _SCALE)
        label = f"{length:g} m" if length < 1000 else f"{length / 1000:g} km"
        after = left + bar + 6 * _SCALE
        draw.text((after, base), label, fill=_INK, font=self._font(11), anchor="lm")
        if not shades:
            return
        start = after + 58 * _SCALE
        for column in range(60 * _SCALE):
            shade = _mixed(_LOW, _TALL, column / (60 * _SCALE))
            draw.line([start + column, base - 5 * _SCALE, start + column, base + 5 * _SCALE], fill=shade)
        text = f"0 to {self._tallest:.0f} m tall"
        draw.text((start + 66 * _SCALE, base), text, fill=_INK, font=self._font(11), anchor="lm")

    def _heat_map(self) -> Any:
        """Quality over steps and heights: what there is to see of a measurement without places."""
        quality = self._fleet.profiles(self._index).T[::-1]
        self._rows = len(quality)
        best = float(quality.max(initial=0.0)) or 1.0
        share = np.clip(quality / best, 0.0, 1.0) * (len(_HEAT) - 1)
        colours = np.stack([np.interp(share, np.arange(len(_HEAT)), _HEAT[:, one]) for one in range(3)], -1)
        image = self._Image.fromarray(colours.astype(np.uint8))
        size = (_SCALE * (_MAP[2] - _MAP[0]), _SCALE * (_MAP[3] - _MAP[1]))
        return image.resize(size, self._Image.Resampling.NEAREST)

    # What changes with each step.

    def _draw_flight(self, image: Any, draw: Any, facts: dict[str, Any], flown: NDArray[np.float64]) -> None:
        size = _SCALE * (_MAP[2] - _MAP[0])
        panel = image.crop([_SCALE * edge for edge in _MAP])
        on_map = self._ImageDraw.Draw(panel)
        if self._stations is None:
            heights = (flown[:, _Z] - facts["height_min_m"]) / max(facts["height_max_m"] - facts["height_min_m"], 1e-9)
            steps = np.maximum(np.arange(len(flown)) - 0.5, 0.0) / facts["steps"]
            way = np.stack([steps * size, size - (0.5 + (self._rows - 1) * heights) / self._rows * size], -1)
            trace, colour = "#ffffff", "#ffffff"
        else:
            way = self._pixels(flown[:, :2])
            trace, colour = _UAV, _UAV
            cell = int(flown[-1, _CELL])
            if 0 <= cell < len(self._stations):
                station = self._pixels(self._stations[cell])
                on_map.line([*way[-1], *station], fill=_LINK, width=3 * _SCALE)
                radius = 9 * _SCALE
                ring = [station[0] - radius, station[1] - radius, station[0] + radius, station[1] + radius]
                on_map.ellipse(ring, outline=_LINK, width=2 * _SCALE)
        if len(way) > 1:
            on_map.line([tuple(point) for point in way], fill=trace, width=3 * _SCALE, joint="curve")
        x, y = way[-1]
        for radius, fill in ((8 * _SCALE, _PAPER), (6 * _SCALE, colour if self._stations is not None else _UAV)):
            on_map.ellipse([x - radius, y - radius, x + radius, y + radius], fill=fill)
        on_map.rectangle([0, 0, panel.width - 1, panel.height - 1], outline=_GRID, width=_SCALE)
        image.paste(panel, (_SCALE * _MAP[0], _SCALE * _MAP[1]))
        if self._stations is None:
            title = "Quality over steps and heights, brighter is better"
        else:
            title = f"Serving: cell {int(flown[-1, _CELL])}" if flown[-1, _CELL] >= 0 else "Serving: unknown"
        self._text(draw, (_MAP[2], 18), title, 12, _FAINT, "ra")

    def _chart(
        self,
        draw: Any,
        vertical: tuple[int, int],
        title: str,
        colour: str,
        steps: NDArray[np.int64],
        values: NDArray[np.float64],
        last: int,
        bounds: tuple[float, float],
    ) -> None:
        top, bottom = vertical
        low, high = bounds
        self._text(draw, (_CHART_LEFT, top - 8), title, 13, _INK, "ls")

        def place(step: Any, value: Any) -> tuple[float, float]:
            share = (value - low) / (high - low) if high > low else 0.0
            x = _CHART_LEFT + (_CHART_RIGHT - _CHART_LEFT) * step / max(last, 1)
            return _SCALE * x, _SCALE * (bottom - (bottom - top) * share)

        for tick in np.linspace(low, high, 5):
            y = place(0, tick)[1]
            draw.line([_SCALE * _CHART_LEFT, y, _SCALE * _CHART_RIGHT, y], fill=_GRID, width=_SCALE)
            self._text(draw, (_CHART_LEFT - 8, y / _SCALE), f"{tick:g}", 11, _FAINT, "rm")
        for tick in (0, last):
            self._text(draw, (place(tick, low)[0] / _SCALE, bottom + 6), f"{tick}", 11, _FAINT, "ma")
        points = [place(step, value) for step, value in zip(steps, values, strict=True)]
        if len(points) > 1:
            draw.line(points, fill=colour, width=2 * _SCALE, joint="curve")
        if points:
            (x, y), radius = points[-1], 4 * _SCALE
            draw.ellipse([x - radius, y - radius, x + radius, y + radius], fill=colour)
            self._text(draw, (_CHART_RIGHT, top - 8), f"{values[-1]:.4g}", 13, colour, "rs")

    def _text(self, draw: Any, at: tuple[float, float], text: str, size: int, colour: str, anchor: str = "la") -> None:
        draw.text((at[0] * _SCALE, at[1] * _SCALE), text, fill=colour, font=self._font(size), anchor=anchor)

    def _font(self, size: int) -> Any:
        return self._ImageFont.load_default(size * _SCALE)


def _unit(facts: dict[str, Any]) -> str:
    return "Mbit/s" if facts["throughput"] else "bit/s/Hz"


def _shown(facts: dict[str, Any], quality: Any) -> Any:
    return quality * 1e-3 if facts["throughput"] else quality


def _mixed(first: tuple[int, int, int], second: tuple[int, int, int], share: float) -> tuple[int, ...]:
    return tuple(round(a + (b - a) * share) for a, b in zip(first, second, strict=True))


def _round_down(value: float) -> float:
    """The greatest of 1, 2, 5, 10, 20, ... that is not above."""
    decade = 10.0 ** np.floor(np.log10(value))
    return float(max(step * decade for step in (1, 2, 5) if step * decade <= value * (1 + 1e-9)))


def _round_up(value: float) -> float:
    """The smallest number that is not below, and has round quarters."""
    decade = 10.0 ** np.floor(np.log10(value))
    return float(min(one * decade for one in (1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10) if one * decade >= value * (1 - 1e-9)))
