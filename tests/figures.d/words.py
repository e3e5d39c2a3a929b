"""Numbers and tables as people read them: to the digits that are known."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple


class Table(NamedTuple):
    """A table of measured figures."""

    # In words, for who decides whether to measure.
    cost: str
    # Leaves what it measures in a folder and tells the commit of what was measured, perhaps its whole note.
    measure: Callable[[Path], dict]
    # Reads that folder; the first row is the head.
    rows: Callable[[Path], list[list[str]]]
    # Takes logs of runs made elsewhere into that folder, where a table is made of logs.
    told: Callable[[Path, list[Path]], None] | None = None


def digits(value: float) -> str:
    """Two significant digits at least: 0.031, 7.7, 34, 1234."""
    if value <= 0:
        return "0"
    if value >= 10:
        return f"{value:.0f}"
    return f"{value:.{min(max(1 - math.floor(math.log10(value)), 0), 6)}f}"


def percent(error: float) -> str:
    """Two significant digits in %, one below a thousandth, and nothing below a millionth."""
    value = 100 * abs(error)
    if value < 1e-6:
        return "0"
    if value < 1e-3:
        return f"{power(float(f'{value:.0e}'), 1e-4)} %"
    return f"{digits(value)} %"


def signed(error: float, standard_error: float | None) -> str:
    """In %, to the first digit of its standard error: +4 ± 4 %, −0.3 ± 0.4 %."""
    value, spread = 100 * error, 100 * (standard_error or 0)
    decimals = max(-math.floor(math.log10(spread)), 0) if spread > 0 else 0
    number = f"{value:+.{decimals}f}".replace("-", "−")
    if float(f"{value:.{decimals}f}") == 0:
        number = "0"
    # beside hundreds of percent the scatter says nothing
    if abs(value) > 300:
        return f"{value:+.0f} %".replace("-", "−")
    return f"{number} ± {spread:.{decimals}f} %" if spread > 0 else f"{number} %"


def seconds(value: float) -> str:
    """7.1 s, or from ten minutes on 12 min."""
    return f"{digits(value)} s" if value < 600 else f"{digits(value / 60)} min"


class Digits:
    """How a mean and what belongs to it are written: to the second digit of its deviation, or to four
    digits of its own where it has none; in powers of ten where digits would hide it."""

    def __init__(self, mean: float, deviation: float | None) -> None:
        deviation = deviation or None
        size = max(abs(mean), deviation or 0.0)
        self.exponent = self.decimals = 0
        if size == 0:
            return
        place = lambda value: math.floor(math.log10(abs(value)))
        self.exponent = 0 if 1e-3 <= size < 1e6 else place(size)
        if deviation:
            last = place(deviation) - 1
        elif self.exponent == 0 and mean == int(mean):
            last = 0
        else:
            last = place(mean) - 3
        self.decimals = min(max(self.exponent - last, 0), 15)

    def show(self, value: float) -> str:
        if self.exponent == 0:
            return f"{value:.{self.decimals}f}"
        return f"{value / 10.0**self.exponent:.{self.decimals}f}e{self.exponent}"


def raised(number: int) -> str:
    """A power as it is printed: 10⁻⁴."""
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def power(value: float, smallest: float = 0.02) -> str:
    """2·10⁻³, 10⁸, 0.4: as short as it is exact; from `smallest` to 10⁴ without a power."""
    if smallest <= abs(value) < 1e4:
        return f"{value:g}"
    factor, exponent = f"{value:e}".split("e")
    ten = f"10{raised(int(exponent))}"
    return ten if float(factor) == 1 else f"{float(factor):g}·{ten}"


def table(rows: list[list[str]]) -> str:
    """A Markdown table; the first row is its head."""
    head, *rest = [[str(cell).replace("|", "\\|") for cell in row] for row in rows]
    return "".join(f"| {' | '.join(row)} |\n" for row in [head, ["---"] * len(head), *rest])
