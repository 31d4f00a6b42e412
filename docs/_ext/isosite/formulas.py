"""Formulas as they stand in the source, and as mathematics on the page.

A docstring says ``B(S, T) = (B00 B11 - B01 B10) / D``, which one can read in an editor. The page
shows the same as mathematics. Nothing is marked in the source: what can be read as a formula is
one, by the grammar below, and what cannot stays as it is.

    list      = relation ("," relation)*
    relation  = sum (("=" | "<" | ..) sum)*
    sum       = product (("+" | "-") product)*
    product   = power (("*" | "/" | nothing) power)*
    power     = ["-"] atom ["!"] [("^" | "**") power]
    atom      = number | symbol ["(" list ")"] | "(" list ")" | "|" sum "|" | ".."

A symbol is a letter or a Greek letter's name, with an index, primes or a hat: ``B00``,
``c_1``, ``v_(k-1)``, ``e'``, ``phi^``.
"""

from __future__ import annotations

import itertools
import re
from typing import NamedTuple

GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda"),
    *("mu", "nu", "xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega"),
    *("Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Phi", "Psi", "Omega"),
)
FUNCTIONS = ("det", "sin", "cos", "exp", "log", "min", "max", "arg")
RELATIONS = {
    "=": "=", "==": "=", "<": "<", ">": ">", "<=": r"\le", ">=": r"\ge", "!=": r"\ne",
    "~": r"\sim", "->": r"\to",
}  # fmt: skip
INDEX = r"(?:_\([^()]*\)|_[A-Za-z0-9]+|[0-9]+)"
# No power follows.
HAT = r"(?:\^(?![\w(-]))?"
SYMBOL = re.compile(
    rf"(?:(?:{'|'.join(GREEK)})(?![A-Za-z])|[A-Za-z]){INDEX}?'*(?![A-Za-z_0-9']){HAT}"
)
# Alone a symbol too: a letter with a short index, and these letters by their names.
ALONE = re.compile(
    rf"(?:{'|'.join(GREEK)}|[A-Za-z])_(?:[A-Za-z0-9]{{1,3}}|\([^()]*\))'*{HAT}|(?:alpha|phi|chi|psi){HAT}"
)
TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?(?![A-Za-z_]))"
    rf"|(?P<function>(?:{'|'.join((*FUNCTIONS, 'sqrt'))})(?=\s?\())"
    rf"|(?P<symbol>{SYMBOL.pattern})|(?P<op>->|<=|>=|!=|==|\*\*|\.\.(?!\.)|[-+*/^=<>(),|!~]))"
)


class Token(NamedTuple):
    """A piece of a formula: what it is, how it is written, where it begins and ends."""

    kind: str
    text: str
    start: int
    end: int


class NotAFormulaError(ValueError):
    """The text cannot be read by the grammar."""


def tokens(text: str) -> list[Token]:
    """The text's tokens from its beginning on, as far as there are any."""
    found: list[Token] = []
    at = 0
    while match := TOKEN.match(text, at):
        kind = match.lastgroup or "op"
        found.append(Token(kind, match[kind], match.start(kind), match.end()))
        at = match.end()
    return found


class _Reader:
    """A formula, read from left to right."""

    def __init__(self, row: list[Token], inline: bool) -> None:
        self.row = row
        self.at = 0
        self.inline = inline

    def next_is(self, *texts: str) -> bool:
        return self.at < len(self.row) and self.row[self.at].text in texts

    def take(self) -> Token:
        if self.at >= len(self.row):
            raise NotAFormulaError("it ends too early")
        self.at += 1
        return self.row[self.at - 1]

    def close(self, text: str) -> None:
        if self.take().text != text:
            raise NotAFormulaError(f"no {text}")

    def list(self) -> str:
        parts = [self.relation()]
        while self.next_is(","):
            self.take()
            parts.append(self.relation())
        return r",\; ".join(parts)

    def relation(self) -> str:
        tex = self.sum()
        while self.next_is(*RELATIONS):
            tex += f" {RELATIONS[self.take().text]} {self.sum()}"
        return tex

    def sum(self) -> str:
        tex = self.product()
        while self.next_is("+", "-"):
            tex += f" {self.take().text} {self.product()}"
        return tex

    def starts_a_power(self) -> bool:
        if self.at >= len(self.row):
            return False
        token = self.row[self.at]
        return token.kind != "op" or token.text in ("(", "..")

    def product(self) -> str:
        tex, bare = self.power()
        while True:
            if self.next_is("/"):
                self.take()
                under, under_bare = self.power()
                tex = f"{tex} / {under}" if self.inline else rf"\frac{{{bare}}}{{{under_bare}}}"
                bare = tex
            elif self.next_is("*"):
                self.take()
                tex = bare = rf"{tex} \cdot {self.power()[0]}"
            elif self.starts_a_power():
                tex = bare = rf"{tex}\, {self.power()[0]}"
            else:
                return tex

    def power(self) -> tuple[str, str]:
        """The power, and the same without a pair of brackets that a fraction makes needless."""
        minus = "-" if self.next_is("-") else ""
        if minus:
            self.take()
        tex, bare = self.atom()
        if self.next_is("!"):
            self.take()
            tex = bare = tex + "!"
        if self.next_is("^", "**"):
            self.take()
            tex = bare = f"{{{tex}}}^{{{self.power()[1]}}}"
        return minus + tex, minus + bare

    def atom(self) -> tuple[str, str]:
        token = self.take()
        if token.kind == "number":
            return token.text, token.text
        if token.kind == "symbol":
            tex = symbol(token.text)
            # A bracket right behind a symbol holds a function's arguments.
            if self.next_is("(") and self.row[self.at].start == token.end:
                self.take()
                tex += f"({self.list()})"
                self.close(")")
            return tex, tex
        if token.kind == "function":
            self.close("(")
            inner = self.list()
            self.close(")")
            tex = rf"\sqrt{{{inner}}}" if token.text == "sqrt" else rf"\{token.text}({inner})"
            return tex, tex
        if token.text == "(":
            inner = self.list()
            self.close(")")
            return f"({inner})", inner
        if token.text == "|":
            inner = self.sum()
            self.close("|")
            return f"|{inner}|", f"|{inner}|"
        if token.text == "..":
            return r"\dots", r"\dots"
        raise NotAFormulaError(f"{token.text} begins nothing")


def symbol(text: str) -> str:
    r"""A symbol of the source as TeX.

    >>> symbol("B00"), symbol("alpha"), symbol("v_(k-1)"), symbol("e'"), symbol("phi^")
    ('B_{00}', '\\alpha', 'v_{k-1}', "e'", '\\hat{\\phi}')
    """
    if text.endswith("^"):
        return rf"\hat{{{symbol(text[:-1])}}}"
    match = re.fullmatch(r"([A-Za-z]+?)(?:_\((.*)\)|_([A-Za-z0-9]+)|([0-9]+))?('*)", text)
    assert match is not None, text
    name = "\\" + match[1] if match[1] in GREEK else match[1]
    index = match[2] or match[3] or match[4]
    return name + (f"_{{{index}}}" if index else "") + match[5]


def as_tex(text: str, *, inline: bool = False) -> str | None:
    r"""The formula as TeX; None where the whole text is no formula.

    >>> as_tex("S = (a c - b d) / (a + c - b - d)")
    'S = \\frac{a\\, c - b\\, d}{a + c - b - d}'
    >>> as_tex("the value at the saddle") is None
    True
    """
    row = tokens(text)
    if not row or text[row[-1].end :].strip():
        return None
    reader = _Reader(row, inline)
    try:
        tex = reader.list()
    except NotAFormulaError:
        return None
    return tex if reader.at == len(row) else None


def says_something(row: list[Token]) -> bool:
    """The formula is more than a name, a number or words that happen to be letters."""
    # Symbols alone, in a row or in a list: "v_0 .. v_n".
    if {t.text for t in row if t.kind != "symbol"} <= {"..", ","} and any(
        ALONE.fullmatch(t.text) for t in row
    ):
        return all(t.kind != "symbol" or ALONE.fullmatch(t.text) for t in row)
    symbols = sum(token.kind in ("symbol", "function") for token in row)
    joined = any(t.kind == "op" and t.text not in ("(", ")", ",", "..", "|", "!") for t in row)
    call = any(
        one.kind == "symbol"
        and one.text not in ("a", "A", "I")
        and two.text == "("
        and two.start == one.end
        for one, two in itertools.pairwise(row)
    )
    return symbols > 0 and (joined or call)


# What is not looked into: code, emphasis, references, names in back quotes, roles.
APART = re.compile(
    r"(``.+?``|:[a-z]+:`[^`]+`|`[^`]+`_?|\*\*[^*]+\*\*|(?<![\w)])\*\w[^*\n]*\w?\*|\[[^\]]*\])",
    re.DOTALL,
)
START = re.compile(r"(?<![\w'/.-])(?=[-(|A-Za-z0-9])")
# Not differences or functions: "3-D", the number of a report, an issue of a volume.
WORD = re.compile(r"\d-[A-Z]\b|[A-Z]-\d{3,}|[A-Z]\d{2,}\(\d+\)")


def with_formulas(text: str, mark: str = ":math:`{}`") -> str:
    r"""The paragraph with each formula in it marked as one.

    >>> with_formulas("It is joined if a c > b d, else cut.")
    'It is joined if :math:`a\\, c > b\\, d`, else cut.'
    """
    pieces = APART.split(text)
    return "".join(p if n % 2 else _marked(p, mark) for n, p in enumerate(pieces))


def _marked(text: str, mark: str) -> str:
    done, at = "", 0
    while match := START.search(text, at):
        begin = match.start()
        found = _longest(text[begin:])
        if found is None:
            step = re.match(r"[A-Za-z0-9_]+|.", text[begin:], re.DOTALL)
            end = begin + (step.end() if step else 1)
            done += text[at:end]
        else:
            tex, length = found
            end = begin + length
            done += text[at:begin] + mark.format(tex)
        at = end
    return done + text[at:]


def _longest(text: str) -> tuple[str, int] | None:
    """The longest formula that begins here, and its length; None where there is none.

    Of formulas in a row it is the first, so that a line may end behind a comma.
    """
    if WORD.match(text):
        return None
    row = tokens(text)
    # An article is no symbol: "a (p+q)-simplex", "a < b" are told apart by what follows.
    if (
        len(row) > 1
        and row[0].text in ("a", "A", "I")
        and row[1].text not in (*RELATIONS, "+", "-", "*", "/")
    ) and (row[1].kind != "symbol" or text[row[0].end : row[1].start] != " "):
        return None
    for count in range(len(row), 0, -1):
        part = row[:count]
        end = part[-1].end
        # A hyphen or a letter that goes on is a word's.
        if re.match(r"[\w'-]", text[end:]) or part[-1].text in ("..",):
            continue
        if not says_something(part):
            return None
        tex = as_tex(text[:end], inline=True)
        parts = _listed(part)
        if tex is not None and all(says_something(one) for one in parts):
            end = parts[0][-1].end
            return as_tex(text[:end], inline=True) or tex, end
    return None


def _listed(row: list[Token]) -> list[list[Token]]:
    """The parts of a formula between commas outside brackets."""
    parts: list[list[Token]] = [[]]
    depth = 0
    for token in row:
        depth += (token.text == "(") - (token.text == ")")
        if token.text == "," and depth == 0:
            parts.append([])
        else:
            parts[-1].append(token)
    return parts


def displayed(paragraph: str) -> str | None:
    """A paragraph of formulas, one a line, as displayed mathematics; else None.

    What stands beside a formula, two spaces away or more, is set beside it as text.
    """
    rows = []
    for line in paragraph.strip("\n").splitlines():
        formula, _, beside = re.sub(r"(\S) {2,}(?=\S)", "\\1\0", line.strip(), count=1).partition(
            "\0"
        )
        row = tokens(formula)
        tex = as_tex(formula)
        if tex is None or not says_something(row) or not any(t.text in RELATIONS for t in row):
            return None
        if beside:
            told = as_tex(beside.strip())
            tex += rf" \qquad {told}" if told else rf" \qquad \text{{{_plain(beside)}}}"
        rows.append(tex)
    return r" \\ ".join(rows) or None


def _plain(text: str) -> str:
    """Words that TeX takes as they are."""
    return re.sub(r"([#$%&_{}])", r"\\\1", text.strip().replace("\\", "").replace("^", ""))
