"""llguidance with a small vocabulary: whether a grammar accepts a text, and random walks over what it allows."""

from __future__ import annotations

import ast
import random
import re
from functools import cache

import llguidance
import llguidance.numpy
import numpy as np

from hymeko_x.language.models.printing import gbnf
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


def accepts(name: str, text: str) -> bool:
    """Whether a text is one of the grammar."""
    matcher = _matcher(name)
    letters = list(text.encode())
    return bool(matcher.try_consume_tokens(letters) == len(letters) and matcher.is_accepting())


def _matcher(name: str) -> llguidance.LLMatcher:
    matcher = llguidance.LLMatcher(_tokenizer(), grammar(name), log_level=0)
    assert not matcher.is_error(), matcher.get_error()
    return matcher


def walk(name: str, seed: int, *, length: int = 40, most: int = 400) -> str | None:
    """A random text of the grammar: so many tokens as chance will have it, and then those that end it; None where they do not."""
    chance, matcher = random.Random(seed), _matcher(name)
    mask = llguidance.numpy.allocate_token_bitmask(1, END + 1)
    text = bytearray()
    for step in range(most):
        llguidance.numpy.fill_next_token_bitmask(matcher, mask, 0)
        allowed = np.nonzero(np.unpackbits(mask.view(np.uint8), bitorder="little")[: END + 1])[0].tolist()
        if not allowed or (END in allowed and (step >= length or allowed == [END])):
            return bytes(text).decode()
        token = _closing(allowed, step) if step >= length or _is_cut(text) else _random(allowed, chance)
        matcher.consume_token(token)
        text += _Vocabulary.tokens[token]
    return None


def _is_cut(text: bytearray) -> bool:
    """Whether a text ends within a letter of several bytes."""
    try:
        text.decode()
    except UnicodeDecodeError:
        return True
    return False


def _random(allowed: list[int], chance: random.Random) -> int:
    words = [token for token in allowed if 256 <= token < END]
    return chance.choice(words if words and chance.random() < 0.95 else [token for token in allowed if token != END])


def _closing(allowed: list[int], step: int) -> int:
    """The token that ends what is open."""
    by_text = {_Vocabulary.tokens[token]: token for token in allowed}
    is_quoted = sum(token < 256 for token in allowed) > MOST_OF_ALL
    turn = step % len(FILLING)
    wanted = [QUOTES[step % len(QUOTES)]] if is_quoted else [*CLOSING, *FILLING[turn:], *FILLING[:turn]]
    return next((by_text[word] for word in wanted if word in by_text), allowed[step % len(allowed)])
