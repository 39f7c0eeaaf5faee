"""llguidance and xgrammar with a small vocabulary: whether a grammar accepts a text, and random walks over what it allows."""

from __future__ import annotations

import ast
import random
import re
from functools import cache
from typing import Any, Protocol

import llguidance
import llguidance.numpy
import numpy as np

from hymeko_x.language.models.printing import PRINTERS, gbnf
from hymeko_x.language.models.printing import llguidance as for_llguidance

_SIGNS = '{ } [ ] ( ) : = , + - -> <- <> ~ @ |> *|> <<copy>> <?> ${ " \' ` \\ \\" // /* */ * / # < > . % """'
_NAMES = "a b base robot world joint mass com import as use rel seq concurrent inf nan impor ass E e mm deg é 関 _ x1 a.b"
_VALUES = "0 1 12 -1 +2 2.5 1e-3 \"c\" 'd' `e`"
WORDS = [*_SIGNS.split(), *_NAMES.split(), *_VALUES.split()]
TOKENS = [bytes([code]) for code in range(256)] + [word.encode() for word in WORDS] + [b" ", b"\n", b"{ ", b" }", b" a ", b"\n  "]
END = len(TOKENS)
CLOSING = [b"}", b"]", b")", b">", b" }", b"?", b">>", b"|>", b"{"]
"""What ends a text soonest, in order of preference."""
FILLING = [b" a ", b"a", b" ", b"1", b"=", b"\n", b"-"]
"""What may be missing before it can end: each in its turn."""
QUOTES = [b'"""', b'"', b"'", b"`", b"*/", b"}", b"\n"]
"""What ends a quoted text or a comment: each in its turn."""
MOST_OF_ALL = 150
"""Where so many bytes are allowed, the text is within quotes or in a comment."""


class _Vocabulary:
    eos_token_id = END
    bos_token_id = None
    special_token_ids = (END,)
    tokens = (*TOKENS, b"<end>")

    def __call__(self, text: bytes) -> list[int]:
        return list(text)


@cache
def _tokenizer() -> llguidance.LLTokenizer:
    return llguidance.LLTokenizer(llguidance.TokenizerWrapper(_Vocabulary()), n_vocab=END + 1, slices=[])


@cache
def grammar(name: str) -> str:
    """The grammar as llguidance takes it; that of llama.cpp and xgrammar as rules over single letters, which it is there."""
    return llguidance.LLMatcher.grammar_from_lark(for_llguidance() if name == "llguidance" else _over_letters(gbnf()))


_GBNF = re.compile(r'"(?:[^"\\]|\\.)*"|\[(?:[^\]\\]|\\.)*\]|[A-Za-z][\w-]*|[()|*+?]')


def _over_letters(text: str) -> str:
    """A text in GBNF in the notation of llguidance, each letter a terminal of its own."""
    rules = re.findall(r"^([\w-]+) ::= (.*(?:\n .*)*)", text, re.MULTILINE)
    lines = [f"{_symbol(name)}: {' '.join(map(_symbol, _GBNF.findall(body)))}" for name, body in rules]
    return "\n".join(["%llguidance {}", *lines, ""])


def _symbol(word: str) -> str:
    if word[0] == '"' and word != '""':
        return " ".join(f"/{re.escape(letter)}/".replace("///", "/\\//").replace("\n", "n") for letter in ast.literal_eval(word))
    if word[0] == "[":
        return f"/{word.replace('/', chr(92) + '/')}/"
    return {"root": "start"}.get(word, word.replace("-", "_"))


def fault(name: str) -> str:
    """Why llguidance refuses a grammar; empty when it takes it."""
    return llguidance.LLMatcher.validate_grammar(grammar(name), _tokenizer())


class _Matcher(Protocol):
    """A text of a grammar as far as it is written."""

    def allowed(self) -> list[int]:
        """The tokens that may follow."""

    def take(self, token: int) -> bool:
        """Whether a token may follow; the text goes on with it."""


class _ByLlguidance:
    def __init__(self, name: str) -> None:
        self.matcher = llguidance.LLMatcher(_tokenizer(), grammar(name), log_level=0)
        assert not self.matcher.is_error(), self.matcher.get_error()
        self.mask = llguidance.numpy.allocate_token_bitmask(1, END + 1)

    def allowed(self) -> list[int]:
        llguidance.numpy.fill_next_token_bitmask(self.matcher, self.mask, 0)
        return _numbers(self.mask)

    def take(self, token: int) -> bool:
        return self.matcher.try_consume_tokens([token]) == 1


class _ByXgrammar:
    def __init__(self) -> None:
        import xgrammar  # its torch is too large for every machine

        self.matcher = xgrammar.GrammarMatcher(_for_xgrammar())
        self.mask = xgrammar.allocate_token_bitmask(1, END + 1)

    def allowed(self) -> list[int]:
        self.matcher.fill_next_token_bitmask(self.mask)
        return _numbers(self.mask.numpy())

    def take(self, token: int) -> bool:
        return bool(self.matcher.accept_token(token))


def _numbers(mask: np.ndarray) -> list[int]:
    found: list[int] = np.nonzero(np.unpackbits(mask.view(np.uint8), bitorder="little")[: END + 1])[0].tolist()
    return found


@cache
def _for_xgrammar() -> Any:
    import xgrammar

    vocabulary = xgrammar.TokenizerInfo([*_Vocabulary.tokens], vocab_type=xgrammar.VocabType.RAW, vocab_size=END + 1, stop_token_ids=[END])
    return xgrammar.GrammarCompiler(vocabulary, max_threads=1).compile_grammar(PRINTERS["xgrammar"]())


def accepts(name: str, text: str) -> bool:
    """Whether a text is one of the grammar."""
    matcher = _matcher(name)
    return all(map(matcher.take, text.encode())) and END in matcher.allowed()


def _matcher(name: str) -> _Matcher:
    return _ByXgrammar() if name == "xgrammar" else _ByLlguidance(name)


def walk(name: str, seed: int, *, length: int = 40, most: int = 400) -> str | None:
    """A random text of the grammar: so many tokens as chance will have it, and then those that end it; None where they do not."""
    chance, matcher = random.Random(seed), _matcher(name)
    text = bytearray()
    for step in range(most):
        allowed = matcher.allowed()
        if not allowed or (END in allowed and (step >= length or allowed == [END])):
            return bytes(text).decode()
        allowed = [token for token in allowed if token < 0xA0 or token > 0xFF or text[-1:] != b"\xed"]  # xgrammar allows surrogates
        token = _closing(allowed, step) if step >= length or _is_cut(text) else _random(allowed, chance)
        assert matcher.take(token)
        text += _Vocabulary.tokens[token]
    return None


def _is_cut(text: bytearray) -> bool:
    """Whether a text ends within a letter of several bytes."""
    try:
        text.decode()
    except UnicodeDecodeError:
        return True
    return False


def _is_quoted(allowed: list[int]) -> bool:
    """Whether the text is within quotes or in a comment, where nearly every byte may follow."""
    return sum(token < 256 for token in allowed) > MOST_OF_ALL


def _random(allowed: list[int], chance: random.Random) -> int:
    """A token by chance. Quoted texts and comments, in which everything may stand, are short."""
    ends = [token for token in allowed if _Vocabulary.tokens[token] in QUOTES]
    if ends and chance.random() < 0.3 and _is_quoted(allowed):
        return chance.choice(ends)
    words = [token for token in allowed if 256 <= token < END]
    return chance.choice(words if words and chance.random() < 0.95 else [token for token in allowed if token != END])


def _closing(allowed: list[int], step: int) -> int:
    """The token that ends what is open."""
    by_text = {_Vocabulary.tokens[token]: token for token in allowed}
    turn = step % len(FILLING)
    wanted = [QUOTES[step % len(QUOTES)]] if _is_quoted(allowed) else [*CLOSING, *FILLING[turn:], *FILLING[:turn]]
    return next((by_text[word] for word in wanted if word in by_text), allowed[step % len(allowed)])
