"""A function of ours as a flow: which steps it calls, in which loops and under which conditions.

Read from its source, so that a chart of it cannot say anything else than the code does: steps are
called by their names and described by the first sentence of their docstrings.
"""

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Collection, Iterator
from typing import Any, NamedTuple


class Step(NamedTuple):
    """A call of a function of ours."""

    name: str
    says: str  # the first sentence of its docstring


class Loop(NamedTuple):
    """What is done again and again."""

    head: str
    body: tuple["Element", ...]


class Choice(NamedTuple):
    """What is done under a condition, and otherwise."""

    condition: str
    then: tuple["Element", ...]
    otherwise: tuple["Element", ...] = ()


class Leave(NamedTuple):
    """The end of the function, or of the innermost loop."""

    how: str  # "return region", "break"


Element = Step | Loop | Choice | Leave


def flow(function: Callable, leave_out: Collection[str] = ()) -> tuple[Element, ...]:
    """The flow of a function.

    Args:
        function: any function of this package.
        leave_out: names of functions that are no steps of their own.
    """
    (definition,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(definition, ast.FunctionDef)
    return tuple(_Reader(_names_of(function), frozenset(leave_out)).block(definition.body))


def step(function: Callable) -> Step:
    """A function as a step: its name, and what its docstring says first."""
    return Step(function.__name__.lstrip("_"), first_sentence(function))


def first_sentence(thing: Any) -> str:
    """The first sentence of a docstring, on one line; "" where there is none."""
    text = " ".join((inspect.getdoc(thing) or "").partition("\n\n")[0].split())
    return re.split(r"(?<!Eq)(?<!Fig)(?<!Sect)\.(?: |$)", text, maxsplit=1)[0]


def reached(function: Callable) -> set[Callable]:
    """All functions of this package that a function calls, directly or through others."""
    found, todo = set(), [function]
    while todo:
        names, source = _names_of(here := todo.pop()), inspect.getsource(here)
        calls = (
            node for node in ast.walk(ast.parse(textwrap.dedent(source)))
            if isinstance(node, ast.Call)
        )  # fmt: skip
        new = {each for each in (_called(call, names) for call in calls) if each} - found
        found |= new
        todo += new
    return found


class _Reader:
    """Reads statements of one function."""

    def __init__(self, names: dict[str, Any], leave_out: frozenset[str]):
        self.names, self.leave_out = names, leave_out
        self.local: dict[str, ast.FunctionDef] = {}

    def block(self, statements: list[ast.stmt]) -> Iterator[Element]:
        """The elements of statements, in the order in which they are executed."""
        for statement in statements:
            yield from self.statement(statement)

    def statement(self, statement: ast.stmt) -> Iterator[Element]:
        match statement:
            case ast.For(target=target, iter=each):
                yield from self.steps(each)
                head = f"for {ast.unparse(target)} in {ast.unparse(each)}"
                yield Loop(head, tuple(self.block(statement.body)))
            case ast.While(test=test):
                yield Loop(f"while {ast.unparse(test)}", tuple(self.block(statement.body)))
            case ast.If(test=test):
                yield from self.steps(test)
                then, otherwise = (
                    tuple(self.block(part)) for part in (statement.body, statement.orelse)
                )
                if then or otherwise:
                    yield Choice(ast.unparse(test), then, otherwise)
            case ast.Return(value=value):
                yield from self.steps(value) if value else ()
                yield Leave(f"return {value.id}" if isinstance(value, ast.Name) else "return")
            case ast.Break():
                yield Leave("break")
            case ast.With(items=items):
                for item in items:
                    yield from self.steps(item.context_expr)
                yield from self.block(statement.body)
            case ast.FunctionDef(name=name):
                self.local[name] = statement
            case _:
                yield from self.steps(statement)

    def steps(self, node: ast.AST) -> Iterator[Step | Loop]:
        """Calls within an expression, what is called first before what is given its value."""
        match node:
            case ast.Call(func=ast.Attribute(attr="scan"), args=[ast.Name(id=name), _, each]):
                body = tuple(self.block(self.local[name].body)) if name in self.local else ()
                kept = tuple(part for part in body if not isinstance(part, Leave))
                yield Loop(f"for each of {ast.unparse(each)}", kept)
                return
        for child in ast.iter_child_nodes(node):
            yield from self.steps(child)
        if isinstance(node, ast.Call):
            called = _called(node, self.names)
            if called and called.__name__ not in self.leave_out:
                yield step(called)


def _names_of(function: Callable) -> dict[str, Any]:
    return inspect.unwrap(function).__globals__


def _called(call: ast.Call, names: dict[str, Any]) -> Callable | None:
    """The function of ours that is called, None for anything else."""
    try:
        thing = _resolved(call.func, names)
    except (KeyError, AttributeError):
        return None
    thing = inspect.unwrap(thing) if callable(thing) else None
    ours = (inspect.isfunction(thing) or inspect.ismethod(thing)) and (
        thing.__module__.partition(".")[0] == __name__.partition(".")[0]
    )
    return thing if ours else None


def _resolved(node: ast.expr, names: dict[str, Any]) -> Any:
    match node:
        case ast.Name(id=name):
            return names[name]
        case ast.Attribute(value=base, attr=name):
            return getattr(_resolved(base, names), name)
    raise KeyError
