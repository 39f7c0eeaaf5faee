"""The xacro library with its connections to the world replaced."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from hymeko_x.frontends.xacro.child.channel import Trouble
from hymeko_x.frontends.xacro.child.dom import PlacingBuilder, make_quick, written
from hymeko_x.frontends.xacro.child.expressions import eval_extension, safe_eval

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.frontends.xacro.child.desk import Arguments, Desk
    from hymeko_x.frontends.xacro.child.dom import LineNotes


class Expander:
    """The xacro library, made to read from a desk, to keep places, and to evaluate nothing but harmless expressions."""

    def __init__(self, desk: Desk, arguments: Arguments) -> None:
        import xacro
        import yaml  # noqa: F401  (xacro imports it when it is needed first, and then no file can be opened any more)
        from xacro import substitution_args

        make_quick()
        self._xacro = xacro
        self._desk = desk
        self._arguments = arguments
        self.document: Any = None
        xacro.parse = self._parse
        xacro.open = desk.open
        xacro.glob = SimpleNamespace(glob=desk.glob)
        xacro.safe_eval = safe_eval
        dict.pop(xacro._global_symbols["python"], "vars")  # a way round every look at names: vars(type)["__subclasses__"]
        functions = {name: value for name, value in substitution_args._eval_dict.items() if name != "__builtins__"}
        functions |= {"env": desk.variable, "optenv": desk.optional_variable, "find": self._find}
        substitution_args._eval_env = desk.variable
        substitution_args._eval_optenv = desk.optional_variable
        substitution_args._eval_find = self._find
        substitution_args._eval = self._evaluator(substitution_args, functions)

    def expand(self, name: str, shown: str, data: bytes) -> LineNotes:
        """The text of the expanded file, written as xacro writes it."""
        self._xacro.init_stacks(name)
        self.document = self._build(shown, data)
        self._xacro.process_doc(self.document, mappings=self._arguments)
        return written(self.document)

    def _find(self, package: str) -> str:
        return self._desk.find(package, self._xacro.filestack[-1])

    def _parse(self, text: None, path: str) -> Any:
        """The DOM of an included file."""
        try:
            shown, data = self._desk.read(path)
        except FileNotFoundError as error:
            self._xacro.filestack.pop()
            raise self._xacro.XacroException(f"{error.strerror}: {path}", exc=error) from error
        return self._build(shown, data)

    def _build(self, shown: str, data: bytes) -> Any:
        self._desk.files.append(shown)
        try:
            return PlacingBuilder(shown).parseString(_text_of(data))
        except expat.ExpatError as error:
            raise Trouble("xml", file=shown, line=error.lineno, text=expat.ErrorString(error.code)) from error

    def _evaluator(self, substitution: Any, functions: Mapping[str, Any]) -> Callable[[str, Mapping[str, Any]], str]:
        def evaluate(text: str, context: Mapping[str, Any]) -> str:
            known = {**functions, "arg": lambda name: substitution.convert_value(context["arg"][name], "auto")}
            return eval_extension(text, known, context["arg"], substitution.convert_value)

        return evaluate


def _text_of(data: bytes) -> str | bytes:
    """UTF-8 whatever the file says, as in xacro; else the bytes, so that the declaration counts."""
    try:
        return data.decode()
    except UnicodeDecodeError:
        return data
