"""Commands whose help shows a switch as it is typed: ``--json``, with no type behind it that wants a value."""

from typing import Any

from typer.core import TyperCommand, TyperGroup, TyperOption


def _bare(params: list[Any]) -> list[Any]:
    for param in params:
        if isinstance(param, TyperOption) and param.is_flag and param.metavar is None:
            param.metavar = ""
    return params


class Command(TyperCommand):
    """A command of ``susp-ss``."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Arguments and options, ``--help`` among them."""
        return _bare(super().get_params(ctx))


class Commands(TyperGroup):
    """All commands of ``susp-ss``."""

    def get_params(self, ctx: Any) -> list[Any]:
        """The options before a command, ``--help`` among them."""
        return _bare(super().get_params(ctx))
