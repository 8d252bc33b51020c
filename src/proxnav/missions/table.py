"""Frozen dataclasses of plain values as TOML tables, and back: every key known, every value of its type."""

from dataclasses import MISSING, fields, is_dataclass, replace
from difflib import get_close_matches
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from proxnav.errors import InputError

T = TypeVar("T")


def from_table(kind: type[T], table: Any, where: str, base: T | None = None, known: dict[str, Any] | None = None) -> T:
    """The dataclass `kind` from a table.

    What the table leaves out is taken from `base`, or is the default; `known` are fields that the table does not hold.
    InputError names the key: one that does not exist, is missing, or has a value of another type.
    """
    if not isinstance(table, dict):
        raise InputError(f"{where} must be a table, found {table!r}")
    hints, known = get_type_hints(kind), known or {}
    names = [field.name for field in fields(kind) if field.name not in known]  # pyright: ignore
    for key in table:
        if key not in names:
            keys = [*names, *known]
            near = get_close_matches(key, keys, 1)
            raise InputError(f"{where}: unknown key '{key}'; {f'did you mean {near[0]}' if near else ', '.join(keys)}")
    values = {key: _typed(value, hints[key], f"{where}: {key}") for key, value in table.items()}
    if base is not None:
        return replace(base, **values)  # pyright: ignore
    missing = [field.name for field in fields(kind) if _is_missing(field, values | known)]  # pyright: ignore
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} missing")
    return kind(**values, **known)


def to_table(value: Any, than: Any = None) -> dict[str, Any]:
    """A dataclass as a table; without what is None, and with `than` only what differs from it."""
    items = {field.name: getattr(value, field.name) for field in fields(value)}
    return {
        key: to_table(item) if is_dataclass(item) else list(item) if isinstance(item, tuple) else item
        for key, item in items.items()
        if item is not None and (than is None or item != getattr(than, key))
    }


def _is_missing(field: Any, values: dict[str, Any]) -> bool:
    return field.default is MISSING and field.default_factory is MISSING and field.name not in values


def _typed(value: Any, hint: Any, where: str) -> Any:
    """The value as `hint` wants it: whole numbers are floats too, arrays are tuples, tables dataclasses."""
    if is_dataclass(hint):
        return from_table(hint, value, where)  # pyright: ignore
    for kind in get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,):
        fits, converted = _as(value, kind)
        if fits:
            return converted
    raise InputError(f"{where} must be {_words(hint)}, found {value!r}")


def _as(value: Any, kind: Any) -> tuple[bool, Any]:
    if get_origin(kind) is Literal:
        return value in get_args(kind), value
    if get_origin(kind) is tuple:
        wanted = get_args(kind)
        if isinstance(value, list) and wanted[1:] == (...,):
            wanted = wanted[:1] * len(value)
        if not isinstance(value, list) or len(value) != len(wanted):
            return False, None
        parts = [_as(item, part) for item, part in zip(value, wanted, strict=True)]
        return all(fits for fits, _ in parts), tuple(part for _, part in parts)
    if kind is float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
        return is_number, float(value) if is_number else None
    return type(value) is kind, value


def _words(hint: Any) -> str:
    if get_origin(hint) in (Union, UnionType):
        return " or ".join(_words(kind) for kind in get_args(hint) if kind is not NoneType)
    if get_origin(hint) is Literal:
        return " or ".join(repr(word) for word in get_args(hint))
    if get_origin(hint) is tuple:
        return "an array of numbers" if ... in get_args(hint) else f"an array of {len(get_args(hint))} numbers"
    return {float: "a number", int: "a whole number", str: "text", bool: "true or false"}.get(hint, str(hint))
