"""Plots of the guide, drawn from the rows of tables: points with lines between, both axes logarithmic."""

import math
from html import escape
from typing import NamedTuple

from measuring import ROOT

PICTURES = ROOT / "server" / "guide" / "pictures"

WIDTH, HEIGHT = 640, 400
LEFT, RIGHT, TOP, BOTTOM = 60, 20, 20, 50
# Dark enough on white, and told apart without colour by their marks.
COLOURS = ["#1f4e8c", "#b3541e", "#2e7d32"]


class Series(NamedTuple):
    name: str
    points: list[tuple[float, float]]


class Plot(NamedTuple):
    """Series over one quantity."""

    across: str
    series: list[Series]

    def svg(self) -> str:
        points = [point for one in self.series for point in one.points]
        x_ticks, y_ticks = (ticks([point[axis] for point in points]) for axis in (0, 1))
        x = lambda value: LEFT + share(value, x_ticks) * (WIDTH - LEFT - RIGHT)
        y = lambda value: HEIGHT - BOTTOM - share(value, y_ticks) * (HEIGHT - TOP - BOTTOM)
        parts = [f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>']
        for tick in x_ticks:
            at = f"{x(tick):.1f}"
            parts.append(f'<path d="M{at} {TOP}V{HEIGHT - BOTTOM}" stroke="#dddddd"/>')
            parts.append(text(at, HEIGHT - BOTTOM + 18, number(tick), "middle"))
        for tick in y_ticks:
            at = f"{y(tick):.1f}"
            parts.append(f'<path d="M{LEFT} {at}H{WIDTH - RIGHT}" stroke="#dddddd"/>')
            parts.append(text(LEFT - 6, f"{float(at) + 4:.1f}", number(tick), "end"))
        parts.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, self.across, "middle"))
        for index, one in enumerate(self.series):
            colour = COLOURS[index % len(COLOURS)]
            line = " L".join(f"{x(across):.1f} {y(up):.1f}" for across, up in one.points)
            parts.append(f'<path d="M{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
            parts += [mark(index, x(across), y(up), colour) for across, up in one.points]
            # names stand below on the right, where few quantities that grow come
            below = HEIGHT - BOTTOM - 16 - 20 * (len(self.series) - 1 - index)
            parts.append(mark(index, WIDTH - RIGHT - 250, below, colour))
            parts.append(text(WIDTH - RIGHT - 238, below + 4, one.name, "start"))
        title = escape(", ".join(one.name for one in self.series) + f" over {self.across}")
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" '
            f'font-family="sans-serif" font-size="13"><title>{title}</title>\n' + "\n".join(parts) + "\n</svg>\n"
        )


def ticks(values: list[float]) -> list[float]:
    """1, 2 and 5 of every power of ten from one below the values to one above."""
    low, high = min(values), max(values)
    exponents = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
    all_ticks = [factor * 10.0**exponent for exponent in exponents for factor in (1, 2, 5)]
    first = max(tick for tick in all_ticks if tick <= low)
    last = min(tick for tick in [*all_ticks, 10.0 ** (exponents[-1] + 1)] if tick >= high)
    return [tick for tick in all_ticks if first <= tick <= last] + ([last] if last > all_ticks[-1] else [])


def share(value: float, of: list[float]) -> float:
    return math.log(value / of[0]) / math.log(of[-1] / of[0])


def number(value: float) -> str:
    return f"{value:,.0f}".replace(",", " ") if value >= 1 else f"{value:g}"


def text(x, y, words: str, anchor: str) -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="#333333">{escape(words)}</text>'


def mark(index: int, x: float, y: float, colour: str) -> str:
    """A circle, a square, a diamond."""
    match index % 3:
        case 0:
            return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>'
        case 1:
            return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" fill="{colour}"/>'
    return f'<path d="M{x:.1f} {y - 5:.1f}l5 5l-5 5l-5 -5z" fill="{colour}"/>'
