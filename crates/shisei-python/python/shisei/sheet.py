"""The worksheet functions under their worksheet names, positional arguments in the worksheet's order.

``help(shisei.sheet.UpdateQuatsByMahony)`` shows arguments, shapes and units. A single quaternion or vector may be a
row or a column. A function whose result is one row gives it flat; one whose result is a series gives (N, columns), of one
row too. Refusals raise ShapeError (``#VALUE!``), DomainError
(``#NUM!``) or ConditionError (``#N/A``) with the full sentence.
"""
from __future__ import annotations

import inspect
from typing import Any, Callable

import numpy as np

from ._arrays import as_floats, number, say
from ._native import ShapeError
from ._native import call as _call
from ._native import functions as _functions


def _argument(value: Any, is_number: bool, name: str) -> Any:
    if value is None:
        return None
    if is_number:
        return number(value, name)
    array = as_floats(value, name)
    if array.ndim > 2:
        raise ShapeError(say(f"{name} has {array.ndim} dimensions and must have at most two",
                             f"{name} は {array.ndim} 次元ですが、2 次元以下でなければなりません"))
    return array if array.ndim == 2 else array.reshape(1, -1)


def _make(index: int, entry: dict[str, Any]) -> Callable[..., Any]:
    args, name = entry["args"], entry["name"]
    kinds = [(arg, is_number) for arg, is_number, *_ in args]
    parameters = [inspect.Parameter(arg, inspect.Parameter.POSITIONAL_OR_KEYWORD,
                                    default=inspect.Parameter.empty if default is None else default)
                  for arg, _, _, _, default, _ in args]
    signature = inspect.Signature(parameters)

    def function(*given: Any, **named: Any) -> Any:
        bound = signature.bind(*given, **named)
        values = bound.arguments
        return _call(index, [_argument(values.get(arg), is_number, arg) for arg, is_number in kinds])

    lines = [entry["doc"][0], ""]
    for arg, _, shape, unit, default, (doc, _) in args:
        lines.append(f"{arg}: {shape}{f', {unit}' if unit else ''}. {doc}"
                     + ("" if default is None else f" (default {default:g})"))
    shape, doc, _ = entry["returns"]
    lines += [f"Returns {shape}: {doc}.", "", entry["doc"][1]]
    function.__name__ = function.__qualname__ = name
    function.__module__ = __name__
    function.__doc__ = "\n".join(lines)
    function.__signature__ = signature  # type: ignore[attr-defined]
    return function


__all__ = []
for _index, _entry in enumerate(_functions()):
    globals()[_entry["name"]] = _make(_index, _entry)
    __all__.append(_entry["name"])
del _index, _entry
