"""All commands as a group: their order, what is said without any, and how completion is named."""

from typing import Any

from typer.core import TyperGroup

FIRST_STEPS = """\
jaxsusp plans how several robots carry one load on cables past obstacles. To begin with:

  jaxsusp plan scenario-1       plan a built-in task; figures are in results/
  jaxsusp new my.toml           write a scenario of your own, every key explained
  jaxsusp check my.toml         what it states, what blocks it, and a picture
  jaxsusp plan my.toml          plan it, with all limits checked and certified clear
  jaxsusp compare --runs 5      compare algorithms on the six benchmark scenarios

jaxsusp --help lists all commands, and jaxsusp COMMAND --help what one of them takes.
jaxsusp --install-completion lets this shell complete commands and names."""

ORDER = ("new", "check", "plan", "verify", "freespace", "workspace", "compare", "report")
"""Commands as a person comes to need them; others follow."""


INSTALL = "Let this shell complete commands and names."


class Commands(TyperGroup):
    """All commands in their order; its help names how completion is installed, and no more."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands."""
        names = super().list_commands(ctx)
        return [*(name for name in ORDER if name in names), *(n for n in names if n not in ORDER)]

    def get_params(self, ctx: Any) -> list:
        """Options of the program."""
        params = super().get_params(ctx)
        said = {
            "install_completion": {"help": INSTALL, "metavar": ""},
            "show_completion": {"hidden": True},
        }
        for param in params:
            vars(param).update(said.get(str(param.name), {}))
        return params

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The command and what it is given; without any, first steps are told."""
        if not args and not ctx.resilient_parsing:
            print(FIRST_STEPS)
            ctx.exit()
        return super().parse_args(ctx, args)
