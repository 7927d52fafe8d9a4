"""A strict reader of LaTeX: what a fragment may contain, its labeled equations, and their values at numbers."""

from __future__ import annotations

import math
import re

#: Commands of LaTeX and amsmath.
COMMANDS = frozenset(
    re.findall(
        r"\w+",
        """section subsection label texttt cite begingroup endgroup allowdisplaybreaks begin end notag eqref frac
        partial alpha beta gamma delta zeta eta theta kappa lambda mu nu xi rho sigma tau phi psi omega varepsilon chi
        det left right bigl bigr Bigl Bigr quad sqrt int exp log sin cos tan
        sinh cosh tanh max min operatorname mathrm text neq ge le to infty cdot surd times nabla pm
        textbackslash textasciitilde""",
    )
)
ENVIRONMENTS = frozenset(["equation", "split", "align", "subequations", "bmatrix", "cases"])
_TOKEN = re.compile(r"\\left\||\\right\||\\[a-zA-Z]+|\\.|\d+\.?\d*|[a-zA-Z]|\S")
_SILENT = ("\\left", "\\right", "\\bigl", "\\bigr", "\\Bigl", "\\Bigr", "\\,")
_ENDS = ("", "+", "-", "/", ")", "}", "\\right|", ",", "&", "<", ">", "\\\\", "\\text", "\\end")
_FUNCTIONS = {
    "\\log": math.log,
    "\\sin": math.sin,
    "\\cos": math.cos,
    "\\exp": math.exp,
    "sign": lambda v: (v > 0) - (v < 0),
}


def check(latex):
    """Assert that a fragment is LaTeX with amsmath: balanced, with known commands, and a label for every reference."""
    assert not re.search(r"[^\x00-\x7f]", latex)
    body, comments = re.sub(r"(?<!\\)%.*", "", latex), re.findall(r"^% ?(.*)$", latex, re.MULTILINE)
    depth, open_environments = 0, []
    for character in re.sub(r"\\[{}\\]", "", body):
        depth += {"{": 1, "}": -1}.get(character, 0)
        assert depth >= 0
    assert depth == 0
    for word, name in re.findall(r"\\(begin|end)\{(\w+\*?)\}", body):
        assert name in ENVIRONMENTS
        if word == "begin":
            open_environments.append(name)
        else:
            assert open_environments.pop() == name
    assert not open_environments
    assert not set(re.findall(r"\\([a-zA-Z]+)", body)) - COMMANDS
    assert re.sub(r"\\\$", "", body).count("$") % 2 == 0
    labels = re.findall(r"\\label\{([^}]*)\}", body)
    assert len(labels) == len(set(labels))
    assert set(re.findall(r"\\(?:eq)?ref\{([^}]*)\}", body)) <= set(labels)
    cited = set(re.findall(r"\\cite(?:\[[^]]*\])?\{([^}]*)\}", body))
    assert cited == set(re.findall(r"@\w+\{(\w+),", "\n".join(comments)))


def rows(latex):
    """Yield the lines of the numbered displays."""
    for _, text in re.findall(r"\\begin\{(equation|align)\}\n(.*?)\n\\end\{\1\}", latex, re.DOTALL):
        yield from text.split("\n")
        yield ""


def equations(latex):
    """Return the left and the right side of every numbered equation, by its label; every row has a number or none."""
    found, label, parts = {}, "", []
    for row in rows(latex):
        own = re.search(r"\\label\{([^}]*)\}", row)
        label = own[1] if own else label
        text = re.sub(r"\\label\{[^}]*\}|\\notag|\\quad|\\(begin|end)\{split\}|(\\\\)$|\{\}", "", row).strip()
        parts.append(text if r"\begin" in text else text.replace("&", " "))
        if label and ("".join(parts).strip() and (row == "" or (own and not row.startswith("\\label")))):
            left, _, right = "".join(f"{part} " for part in parts).strip().rstrip(".,").rpartition("=")
            assert label not in found
            found[label], label, parts = (left.strip(), right.strip()), "", []
    return found


def visible(row):
    """Return about how many letters, digits and signs stand beside each other in a row; of a matrix, in its widest."""
    if r"\begin{bmatrix}" in row:
        before, inside = row.split(r"\begin{bmatrix}")
        return visible(before) + max(map(visible, inside.split(r"\\")))
    row = re.sub(r"\\(label|begin|end)\{[^}]*\}|\\[lrbB][a-z]*(?=[(|)\\{])|\\quad|\\notag", "", row)
    for _ in range(6):
        row = re.sub(r"\\frac\{([^{}]*)\}\{([^{}]*)\}", lambda match: max(match[1], match[2], key=len), row)
        row = re.sub(r"[_^]\{([^{}]*)\}", lambda match: "i" * len(re.findall(r"\\[a-z]+|\w", match[1])), row)
    return len(re.findall(r"\\[a-zA-Z]+|[A-Za-z0-9()+=-]", row))


class Value:
    """The value of a formula, by recursive descent; `Value(text, values).result`."""

    def __init__(self, text, values):
        self.tokens = [token for token in _TOKEN.findall(text) if token not in _SILENT]
        self.values, self.at = values, 0
        self.result = self.sum()
        assert self.at == len(self.tokens), self.tokens[self.at :]

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def sum(self):
        total = -self.product() if self.peek() == "-" and self.take() else self.product()
        while self.peek() in ("+", "-"):
            total += self.product() if self.take() == "+" else -self.product()
        return total

    def product(self):
        result = self.power()
        while self.peek() not in _ENDS:
            if self.peek() == "\\times":
                self.take()
            result *= self.power()
        return result

    def power(self):
        base = self.atom()
        return base ** self.group() if self.peek() == "^" and self.take() else base

    def group(self):
        """Return the value of what is in braces."""
        assert self.take() == "{"
        value = self.quotient()
        assert self.take() == "}"
        return value

    def quotient(self):
        value = self.sum()
        return value / self.sum() if self.peek() == "/" and self.take() else value

    def atom(self):
        token = self.take()
        if token in ("(", "\\left|"):
            value = self.sum()
            assert self.take() == {"(": ")", "\\left|": "\\right|"}[token]
            return value if token == "(" else abs(value)
        if token == "{":
            self.at -= 1
            return self.group()
        if token == "\\frac":
            return self.group() / self.group()
        if token == "\\sqrt":
            return math.sqrt(self.group())
        if token == "\\operatorname":
            name = "".join(self.take() for _ in range(self.tokens.index("}", self.at) - self.at + 1))
            return _FUNCTIONS[name[1:-1]](self.atom())
        if token in ("\\max", "\\min"):
            power = self.group() if self.peek() == "^" and self.take() else 1.0
            return {"\\max": max, "\\min": min}[token](self.arguments()) ** power
        if token == "\\begin":
            return self.cases()
        if token in _FUNCTIONS:
            return _FUNCTIONS[token](self.atom())
        if token == "e" and self.peek() == "^":
            self.take()
            return math.exp(self.group())
        return float(token) if token[0].isdigit() else self.values[self.name(token.lstrip("\\"))]

    def arguments(self):
        """Return the values of what is in brackets, separated by commas."""
        assert self.take() == "("
        values = [self.sum()]
        while self.take() == ",":
            values.append(self.sum())
        return values

    def cases(self):
        """Return the value of an environment `cases` with one comparison."""
        self.skip("{cases}")
        first = self.sum()
        self.skip(r"&\text{if}")
        left, sign, right = self.sum(), self.take(), self.sum()
        self.skip(r"\\")
        second = self.sum()
        self.skip(r"&\text{otherwise}\end{cases}")
        return first if (left < right if sign == "<" else left > right) else second

    def skip(self, text):
        for token in _TOKEN.findall(text):
            assert self.take() == token

    def name(self, head):
        """Return the name in the code of a symbol with its subscript."""
        if self.peek() != "_":
            return head
        self.take()
        assert self.take() == "{"
        parts = [""]
        while (token := self.take()) != "}":
            parts += [""] if token == "," else []
            parts[-1] += "" if token == "," else token.lstrip("\\")
        return "_".join([head + parts[0], *parts[1:]] if parts[0].isdigit() else [head, *parts])
