"""Responses as files: CSV, Parquet and figures; and input signals from CSV files."""

from __future__ import annotations

import csv
import io
import itertools
import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.dynamics.signals import table
from hymeko_x.ir.digits import number_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from matplotlib.figure import Figure

    from hymeko_x.dynamics.signals import Signal
    from hymeko_x.dynamics.simulation import Response


def csv_text(response: Response) -> str:
    """The response as CSV: a header, and a row for each time with numbers that read back exactly."""
    columns = response.columns()
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([number_text(value) for value in row] for row in zip(*(column.tolist() for column in columns.values()), strict=True))
    return out.getvalue()


def write_table(response: Response, path: Path) -> None:
    """Write the response to a CSV or Parquet file.

    Raises: Refusal (HX002) when it cannot be written, HX003 for another suffix.
    """
    try:
        if path.suffix == ".csv":
            path.write_text(csv_text(response), encoding="utf-8")
        elif path.suffix == ".parquet":
            import polars

            polars.DataFrame(response.columns()).write_parquet(path)
        else:
            raise refuse(codes.UNKNOWN_FORMAT, f"'{path}': a table is written to .csv or .parquet")
    except OSError as error:
        raise refuse(codes.CANNOT_WRITE, f"'{path}' cannot be written: {error.strerror}") from error


@contextmanager
def figure_file(path: Path, title: str) -> Iterator[Figure]:
    """A figure that is written when the block ends.

    Raises: Refusal (HX002) when it cannot be written, HX003 for a suffix that matplotlib does not know.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 6), layout="constrained")
    canvas = FigureCanvasAgg(figure)
    if path.suffix[1:] not in canvas.get_supported_filetypes():
        raise refuse(codes.UNKNOWN_FORMAT, f"'{path}': a figure is written to .png, .svg or .pdf")
    yield figure
    figure.suptitle(title)
    try:
        with rc_context({"svg.hashsalt": title}):
            figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)
    except OSError as error:
        raise refuse(codes.CANNOT_WRITE, f"'{path}' cannot be written: {error.strerror}") from error


def draw(response: Response, title: str, path: Path) -> None:
    """Draw the inputs above the outputs.

    Raises: Refusal (HX002) when it cannot be written, HX003 for a suffix that matplotlib does not know.
    """
    inputs, _, outputs = response.names
    driven = [(variable, response.inputs[:, i]) for i, variable in enumerate(inputs) if not variable.rate_of]
    shown = (driven, [(variable, response.outputs[:, i]) for i, variable in enumerate(outputs)])
    with figure_file(path, title) as figure:
        for axes, curves, kind in zip(figure.subplots(2, 1, sharex=True), shown, ("inputs", "outputs"), strict=True):
            for variable, values in curves:
                axes.plot(response.time, values, label=f"{variable.name} ({variable.unit})", linewidth=1)
            axes.set_ylabel(kind)
            axes.grid(alpha=0.3)
            if curves:
                axes.legend(loc="best")
        axes.set_xlabel("time (s)")


def read_signal(path: Path, column: str) -> Signal:
    """The signal in a column of a CSV file with a header and a column ``time`` in s; straight lines between its rows.

    Raises: Refusal (HX001) when the file cannot be read, HX407 for a column that is not there, no numbers, or times that do not grow.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise refuse(codes.CANNOT_READ, f"'{path}' cannot be read: {error}") from error
    try:
        points = [(float(row["time"]), float(row[column])) for row in rows]
    except KeyError as error:
        raise refuse(codes.BAD_SIGNAL, f"'{path}' has no column {error}; it has {', '.join(rows[0])}") from error
    except (TypeError, ValueError) as error:
        raise refuse(codes.BAD_SIGNAL, f"'{path}': columns 'time' and '{column}' hold numbers: {error}") from error
    finite = all(math.isfinite(value) for point in points for value in point)
    if not points or not finite or any(b[0] <= a[0] for a, b in itertools.pairwise(points)):
        raise refuse(codes.BAD_SIGNAL, f"'{path}': times grow from row to row, and all numbers are finite")
    times, values = zip(*points, strict=True)
    return table(times, values)
