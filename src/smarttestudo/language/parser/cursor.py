# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The place in the words of a file, errors there, and what may have been meant."""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Iterable, Mapping, Sequence
from types import MappingProxyType

from smarttestudo.domain.finding import Finding, Fix, Severity, Span
from smarttestudo.language.parser.lexer import KEYWORDS, Token, TokenKind
from smarttestudo.language.syntax import NO_TRIVIA, Comment, Trivia

SYNONYMS: Mapping[str, str] = MappingProxyType(
    {
        "==": "=",
        "=>": ">=",
        "=<": "<=",
        "<>": "!=",
        "≥": ">=",
        "≤": "<=",
        "≠": "!=",
        "&&": "AND",
        "&": "AND",
        "||": "OR",
        "|": "OR",
        "!": "Not",
        "When": "If",
        "Always": "Full",
        "All": "Full",
        "Never": "Off",
        "None": "Off",
    }
)
"""The words of other languages, and what ADIRF writes for them."""

_HINTS: Mapping[str, str] = MappingProxyType(
    {
        ";": "statements need nothing between them",
        ",": "nothing is separated by commas",
        ":": "there are no colons",
        "{": "a collection is written 'begin … end', a block 'If … Then … EndIf'",
        "}": "a collection is written 'begin … end', a block 'If … Then … EndIf'",
        "%": "numbers carry no unit",
    }
)
_LONGEST_WORD = 24
_SHORTEST_PREFIX = 3
_SHOWN = 40


def closest(word: str, candidates: Iterable[str]) -> str | None:
    """The candidate that ``word`` is a synonym, another case, a beginning or a misspelling of."""
    known = tuple(candidates)
    synonym = SYNONYMS.get(word)
    if synonym in known:
        return synonym
    if len(word) > _LONGEST_WORD:
        return None
    plain = word.casefold()
    near = [(distance, name) for name in known if (distance := _distance(plain, name.casefold())) is not None]
    return min(near, key=lambda pair: pair[0])[1] if near else None


def _distance(word: str, name: str) -> int | None:
    """How far ``word`` is from ``name``, ``None`` when too far to be it."""
    if word == name:
        return 0
    allowed = 1 if len(name) < 6 else 2
    if _may_be_within(allowed, word, name):
        edits = edit_distance(word, name)
        if edits <= allowed:
            return edits
    return allowed + 1 if len(word) >= _SHORTEST_PREFIX and name.startswith(word) else None


def _may_be_within(edits: int, word: str, name: str) -> bool:
    """A cheap bound: an edit changes the length by one, and the set of letters by two, at most."""
    return len(word) > 1 and abs(len(word) - len(name)) <= edits and len(set(word) ^ set(name)) <= 2 * edits


def edit_distance(first: str, second: str) -> int:
    """Insertions, deletions, substitutions and swaps of neighbours between two short words.

    The restricted Damerau-Levenshtein distance (optimal string alignment), by rows.
    """
    before: list[int] = []
    row = list(range(len(second) + 1))
    for i, letter in enumerate(first, start=1):
        last, row, before = before, [i], row
        for j, other in enumerate(second, start=1):
            best = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == second[j - 2] and first[i - 2] == other:
                best = min(best, last[j - 2] + 1)
            row.append(best)
    return row[-1]


def did_you_mean(text: str) -> str:
    """The hint that offers ``text``."""
    return f"did you mean '{text}'?"


def hint_on(token: Token) -> str:
    """Advice on a token of another language."""
    if token.kind is not TokenKind.FOREIGN or not token.text:
        return ""
    if not token.text.isprintable():
        return f"{described(token)} cannot be seen in most editors; delete it"
    return _HINTS.get(token.text[0], "")


def described(token: Token) -> str:
    """The token as a message names it, short and printable."""
    if token.kind is TokenKind.END_OF_FILE:
        return "the end of the file"
    if not token.text.isprintable():
        hidden = next(character for character in token.text if not character.isprintable())
        name = unicodedata.name(hidden, "")
        return f"the character U+{ord(hidden):04X}{f' ({name.lower()})' if name else ''}"
    text = token.text if len(token.text) <= _SHOWN else f"{token.text[: _SHOWN - 1]}…"
    return f'"{text}"' if "'" in text else f"'{text}'"


MAX_FINDINGS = 100


class FindingLog:
    """The errors of one file; a second one in the same statement is mostly an echo of the first."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._findings: list[Finding] = []
        self._is_reported = False
        self._left_out = 0

    def begin_statement(self) -> None:
        """Begin another statement, which the next report is about."""
        self._is_reported = False

    def report(self, code: str, message: str, *, span: Span, hint: str = "", fix: Fix | None = None) -> None:
        """Keep an error, unless its statement has one."""
        if self._is_reported:
            return
        self._is_reported = True
        if len(self._findings) == MAX_FINDINGS:
            self._left_out += 1
            return
        self._findings.append(
            Finding(
                code=code,
                severity=Severity.ERROR,
                message=message,
                path=self._path,
                span=span,
                hint=hint,
                fix=fix,
            )
        )

    def findings(self) -> tuple[Finding, ...]:
        """Everything reported, in the order of the file."""
        found = sorted(self._findings, key=lambda finding: (finding.span.line, finding.span.column))
        if self._left_out:
            last = found[-1]
            message = f"{self._left_out} more errors are not shown"
            found.append(
                Finding(
                    code="too-many-errors",
                    severity=Severity.ERROR,
                    message=message,
                    path=self._path,
                    span=last.span,
                    hint="is this a rule file?",
                )
            )
        return tuple(found)


STATEMENT_STARTS = (
    TokenKind.SET_FREQUENCY,
    TokenKind.KEEP_AT_LEAST,
    TokenKind.KEEP_WITHIN,
    TokenKind.DISABLED,
    TokenKind.RULE,
    TokenKind.IF,
)
SAFE_PLACES = frozenset(
    {
        *STATEMENT_STARTS,
        TokenKind.RECORD,
        TokenKind.SET_PARAMETER,
        TokenKind.CALL,
        TokenKind.NOTIFY,
        TokenKind.BEGIN,
        TokenKind.END,
        TokenKind.THEN,
        TokenKind.ELSE,
        TokenKind.END_IF,
        TokenKind.END_OF_FILE,
    }
)
"""Where parsing can go on after an error."""

_MENDABLE = frozenset({TokenKind.WORD, TokenKind.FOREIGN})
_SAFE_WORDS = tuple(word for word, kind in KEYWORDS.items() if kind in SAFE_PLACES)


class BrokenStatementError(Exception):
    """Inside the parser: the statement cannot be read on, and its finding is reported."""


class Cursor:
    """Looks at one token at a time and never goes back; every look is a step.

    ``is_cut_off`` is whether something was missing at the end of the file, ``is_block_open`` whether the
    statements read last belong to a block without ``EndIf``, ``timed_depth`` how many ``For`` and ``Within``
    the last condition nests.
    """

    def __init__(self, tokens: Sequence[Token], log: FindingLog) -> None:
        self._following = iter(tokens)
        self._end_of_file = tokens[-1]
        self._next = next(self._following)
        self._is_mended = False
        self._loose: list[Comment] = []
        self._log = log
        self.steps = 0
        self.is_cut_off = False
        self.is_block_open = False
        self.timed_depth = 0
        self.previous = tokens[0]

    @property
    def token(self) -> Token:
        """The token to read next, with a misspelt keyword already corrected."""
        self.steps += 1
        return self._next

    @property
    def kind(self) -> TokenKind:
        """The kind of the token to read next."""
        self.steps += 1
        return self._next.kind

    def advance(self) -> Token:
        """Read the next token; the end of the file stays where it is."""
        self.steps += 1
        self.previous = token = self._next
        if token.above:
            self._loose.extend(token.above)
        if token.beside is not None:
            self._loose.append(token.beside)
        self._is_mended = False
        self._next = next(self._following, self._end_of_file)
        return token

    def accept(self, kind: TokenKind) -> Token | None:
        """Read the next token if it is of ``kind``."""
        self.steps += 1
        return self.advance() if self._next.kind is kind else None

    def begin_statement(self) -> None:
        """From here on a finding is about another statement; one a statement is reported."""
        if not self._is_mended:
            self._log.begin_statement()
        self._loose.clear()

    def report(
        self, code: str, message: str, *, span: Span | None = None, hint: str = "", fix: Fix | None = None
    ) -> None:
        """Report an error at ``span``, or at the next token."""
        self._log.report(code, message, span=span or self.token.span, hint=hint, fix=fix)

    def failure(
        self, code: str, expected: str, *, hint: str = "", fix: Fix | None = None
    ) -> BrokenStatementError:
        """Report that ``expected`` was expected here; raise the result to give the statement up."""
        self.report_missing(code, expected, hint=hint, fix=fix)
        return BrokenStatementError()

    def report_missing(self, code: str, expected: str, *, hint: str = "", fix: Fix | None = None) -> None:
        """Report what was expected: behind the token before where the next one starts something else."""
        if self._is_at_gap():
            self.is_cut_off = self.is_cut_off or self.kind is TokenKind.END_OF_FILE
            message = f"expected {expected} after {described(self.previous)}"
            self.report(code, message, span=self.previous.end, hint=hint or self._slashes_hint(), fix=fix)
        else:
            self.report_found(code, expected, hint=hint, fix=fix)

    def report_found(self, code: str, expected: str, *, hint: str = "", fix: Fix | None = None) -> None:
        """Report that the next token is not the ``expected``."""
        found = self.token
        self.report(
            code, f"expected {expected}, found {described(found)}", hint=hint or hint_on(found), fix=fix
        )

    def _is_at_gap(self) -> bool:
        """Whether something is missing behind the token before, the next one being fine where it is."""
        found = self.token
        starts_another = found.starts_line and (found.text in KEYWORDS or found.kind is TokenKind.CLOSE)
        return starts_another or found.kind is TokenKind.END_OF_FILE

    def mend(self, code: str, expected: str, kinds: Collection[TokenKind]) -> bool:
        """Report a misspelt keyword of ``kinds`` and let it count as what it should be."""
        token = self.token
        if token.kind not in _MENDABLE:
            return False
        kind = KEYWORDS.get(closest(token.text, KEYWORDS) or "")
        if kind is None or kind not in kinds:
            return False
        fix = Fix(span=token.span, replacement=kind.value, title=f"write '{kind.value}'")
        self.report_found(code, expected, hint=did_you_mean(kind.value), fix=fix)
        self._next = token._replace(kind=kind)
        self._is_mended = True
        return True

    def skip_to(self, kinds: Collection[TokenKind]) -> None:
        """Skip to the next token of ``kinds``, or of a spelling close to one."""
        while self.kind not in kinds and not self._looks_like(kinds):
            if self.kind is TokenKind.END_OF_FILE:
                return
            self.advance()

    def _looks_like(self, kinds: Collection[TokenKind]) -> bool:
        token = self.token
        if token.kind is not TokenKind.WORD:
            return False
        right = closest(token.text, _SAFE_WORDS)
        return right is not None and KEYWORDS[right] in kinds

    def _slashes_hint(self) -> str:
        beside = self.previous.beside
        if beside is not None and beside.span.column == self.previous.end.column:
            return "'//' starts a comment; no name holds it"
        return ""

    def take_above(self) -> tuple[Comment, ...]:
        """The comments up to the token read last, without the one beside it, which goes to what follows."""
        beside = [self.previous.beside] if self.previous.beside is not None else []
        above = self._loose[: len(self._loose) - len(beside)]
        self._loose = [*beside]
        return tuple(above)

    def take_trivia(self, first: Token) -> Trivia:
        """The comments of what goes from ``first`` to the token read last; those inside it go above."""
        above = self.take_above() if self._loose else ()
        self._loose.clear()
        beside, blank_above = self.previous.beside, first.blank_above
        if not above and beside is None and not blank_above:
            return NO_TRIVIA
        return Trivia(above=above, beside=beside, blank_above=blank_above)

    def span_from(self, first: Token) -> Span:
        """From ``first`` to the token read last."""
        last = self.previous
        return Span(first.line, first.column, last.line, last.column + len(last.text))
