"""Where a C++ source can be mutated, and how: as an edit of its own, and as a switch that is compiled in beside all
others. No parser: tokens, their brackets, and the spaces that clang-format sets round an operator of two operands."""
import re
from collections import namedtuple
from dataclasses import dataclass, field
from decimal import Decimal

Token = namedtuple("Token", "kind text begin end spaced")  # kind: word, number, text or sign
Edit = namedtuple("Edit", "begin end text")  # what stands from begin to end becomes the text
Wrap = namedtuple("Wrap", "begin end before behind")  # @0 and @1 stand for the numbers of a site's mutants
Mutant = namedtuple("Mutant", "edit name")  # named after the operator, with a number where it makes several


@dataclass
class Site:
    """One place and its mutants, which share a switch."""
    mutants: list
    wraps: list = field(default_factory=list)
    replacements: list = field(default_factory=list)
    first_number: int = 0  # of its mutants, counted from 1 through the source
    function: int = 0  # offset of the body that it lies in; 0: in none
    constant: str = ""  # the constexpr name whose declaration it lies in


# A constexpr declaration: with a switch in it, it is one no longer.
Constant = namedtuple("Constant", "name begin end is_function")

# operator: what it becomes, its type in mutant_switch.h, the name of the change
BINARY = {
    "+": (["-"], "Plus", "arithmetic"), "-": (["+"], "Minus", "arithmetic"), "*": (["/"], "Times", "arithmetic"),
    "/": (["*"], "Over", "arithmetic"), "%": (["*"], "Modulo", "arithmetic"),
    "&": (["|"], "BitAnd", "bits"), "|": (["&"], "BitOr", "bits"), "^": (["|"], "BitXor", "bits"),
    "<<": ([">>"], "ShiftLeft", "bits"), ">>": (["<<"], "ShiftRight", "bits"),
    "<": (["<=", ">="], "Less", "comparison"), "<=": (["<", ">"], "LessEqual", "comparison"),
    ">": ([">=", "<="], "Greater", "comparison"), ">=": ([">", "<"], "GreaterEqual", "comparison"),
    "==": (["!="], "Equal", "comparison"), "!=": (["=="], "NotEqual", "comparison"),
}
COMPARISONS = [sign for sign, change in BINARY.items() if change[2] == "comparison"]
ASSIGNMENTS = {"+=": ("-=", "add"), "-=": ("+=", "subtract"), "*=": ("/=", "multiply"), "/=": ("*=", "divide"),
               "|=": ("&=", "set_bits"), "&=": ("|=", "keep_bits")}
BEFORE_EXPRESSION = [";", ",", "?", ":", "=", "return", "+=", "-=", "*=", "/=", "|=", "&=", "case", "{", "}"]
NO_EXPRESSION = set("""if for while switch do else try case default using typedef static_assert constexpr const auto
    static struct class enum goto template unsigned extern catch alignas""".split())

LEXER = re.compile(r"""
    (?P<avr>^[^\S\n]*\#ifdef\ __AVR__$)
  | (?P<ignored>^[^\S\n]*\#(?:\\.|[^\\\n])* | \s+ | //[^\n]* | /\*.*?(?:\*/|\Z))
  | (?P<number>0[xX](?:[\w.]|'(?=\w))* | \.?\d(?:[eE][+-]|[\w.]|'(?=\w))*)
  | (?P<text>\w*R"(?P<close>[^(]*)\(.*?\)(?P=close)" | "(?:\\.|[^"\\])*" | '(?:\\.|[^'\\])*')
  | (?P<word>\w+)
  | (?P<sign><<=|>>=|->\*|\.\.\.|<=>|::|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|\#\#|.)
""", re.VERBOSE | re.MULTILINE | re.DOTALL | re.ASCII)
DIRECTIVE = re.compile(r"^ *#(if|el|endif)", re.MULTILINE)


def branch_end(source, at):
    """Where the line that ends a preprocessor branch begins: #else, #elif or #endif."""
    depth = 0
    for directive in DIRECTIVE.finditer(source, at):
        if depth == 0 and directive[1] != "if":
            return directive.start()
        depth += {"if": 1, "el": 0, "endif": -1}[directive[1]]
    return len(source)


def tokens_of(source):
    """Comments, preprocessor lines, spaces and what only the microcontroller's compiler sees are left out."""
    tokens = []
    at = 0
    while at < len(source):
        match = LEXER.match(source, at)
        at = match.end()
        if match.lastgroup == "avr":
            at = branch_end(source, at)
        elif match.lastgroup == "ignored":
            if match[0].isspace() and "\n" in match[0]:
                at = source.rfind("\n", 0, at) + 1  # spaces before a # are of its line
        else:
            begin, end = match.span()
            spaced = source[begin - 1:begin].isspace() and source[end:end + 1].isspace()
            kind = "text" if match.lastgroup == "close" else match.lastgroup
            tokens.append(Token(kind, match[0], begin, end, spaced))
    return tokens


class Syntax:
    """The tokens of a source with what their brackets hold: ( [ block class enum namespace list; a block holds
    statements. Indices beyond the ends are those of an empty text."""

    def __init__(self, source):
        self.tokens = tokens_of(source)
        self.size = len(self.tokens)
        self.texts = [token.text for token in self.tokens]
        self.partner = [None] * self.size  # the other bracket of a pair
        self.around = [None] * self.size  # the open bracket around a token
        self.kind = [""] * self.size
        opened = []
        for i, text in enumerate(self.texts):
            if text in (")", "]", "}") and opened:
                self.partner[i] = opened[-1]
                self.kind[i] = self.kind[opened[-1]]
                self.partner[opened.pop()] = i
            if opened:
                self.around[i] = opened[-1]
            if text in ("(", "[", "{"):
                self.kind[i] = self.brace_kind(i) if text == "{" else text
                opened.append(i)
        self.starts = [False] * self.size
        self.mark_statements()

    def text(self, i):
        return self.texts[i] if 0 <= i < self.size else ""

    def is_word(self, i):
        return 0 <= i < self.size and self.tokens[i].kind == "word"

    def joined(self, i):
        """Without a space to the token before it."""
        return 0 < i < self.size and self.tokens[i].begin == self.tokens[i - 1].end

    def within(self, i, kind):
        return self.around[i] is not None and self.kind[self.around[i]] == kind

    def brace_kind(self, i):
        has_round = False
        declared = None
        k = i - 1
        while k >= 0 and self.text(k) not in (";", "{", "}", "(", "["):
            if self.text(k) in (")", "]") and self.partner[k] is not None:
                has_round = has_round or self.text(k) == ")"
                k = self.partner[k]
            elif self.text(k) in ("namespace", "extern"):
                declared = "namespace"
            elif self.text(k) in ("class", "struct", "union"):
                declared = "class"
            elif self.text(k) == "enum":
                declared = "enum"
            k -= 1
        if declared and not has_round:
            return declared
        before = self.text(i - 1)
        if before in (")", "else", "do", "try", "const", "noexcept", "override", "mutable"):
            return "block"
        if before in (";", "{", "}", ":"):
            return "list" if self.within(i, "list") else "block"
        k = i - 1  # over the result type of a lambda
        while k > 0 and (self.is_word(k) or self.text(k) in ("::", "<", ">", "&", "*", ",")):
            k -= 1
        return "block" if self.text(k) == "->" and self.text(k - 1) == ")" else "list"

    def mark_statements(self):
        for i in range(1, self.size):
            if not self.within(i, "block"):
                continue
            before = self.text(i - 1)
            if before in (";", "else", "do", "{") or (before == "}" and self.kind[i - 1] == "block"):
                self.starts[i] = True
            if before == ")" and self.partner[i - 1]:
                header = self.partner[i - 1] - 1
                self.starts[i] = (self.text(header) in ("if", "for", "while", "switch") or
                                  (self.text(header) == "constexpr" and self.text(header - 1) == "if"))
            if self.starts[i] and self.text(i) in ("case", "default"):
                colon = self.find(i, [":", ";"])
                if colon + 1 < self.size:
                    self.starts[colon + 1] = True

    def find(self, i, ends):
        """The first token from i on, outside of brackets that open on the way, that is one of `ends`; or the bracket
        that closes around it."""
        while i < self.size and self.texts[i] not in (")", "]", "}") and self.texts[i] not in ends:
            opens = self.texts[i] in ("(", "[", "{") and self.partner[i] is not None
            i = self.partner[i] + 1 if opens else i + 1
        return i

    def find_back(self, i, ends):
        while i >= 0 and self.texts[i] not in ("(", "[", "{") and self.texts[i] not in ends:
            closes = self.texts[i] in (")", "]", "}") and self.partner[i] is not None
            i = self.partner[i] - 1 if closes else i - 1
        return i

    def behind_arguments(self, i):
        """Behind the template arguments at i, or i."""
        if self.text(i) != "<" or not self.joined(i):
            return i
        depth = 0
        for k in range(i, self.size):
            if self.texts[k] in (";", "{", "}", "&&", "||"):
                return i
            depth += {"<": 1, ">": -1, ">>": -2}.get(self.texts[k], 0)
            if depth <= 0:
                return k + 1
        return i

    def behind_operand(self, i):
        """Behind the operand of a prefix operator that begins at i; None where it is not understood."""
        while self.text(i) in ("!", "-", "*", "&", "~"):
            i += 1
        if i >= self.size:
            return None
        if self.tokens[i].kind == "number":
            return i + 1
        if self.is_word(i):
            i += 1
        elif self.text(i) == "(" and self.partner[i] is not None:
            i = self.partner[i] + 1
        else:
            return None
        while i < self.size:
            behind = self.behind_arguments(i)
            if behind != i:
                i = behind
            elif self.text(i) in ("::", ".", "->"):
                i += 2
            elif (self.text(i) in ("(", "[", "{") and self.partner[i] is not None and self.joined(i)):
                i = self.partner[i] + 1
            else:
                break
        return i

    def operand_ending_at(self, i):
        """First token of the operand whose last one is i."""
        while i > 0:
            if self.text(i) in (")", "]") and self.partner[i] is not None:
                i = self.partner[i]
                if not self.joined(i) or not (self.is_word(i - 1) or self.text(i - 1) in (")", "]", "}")):
                    break
                i -= 1
            elif self.text(i - 1) in ("::", ".", "->"):
                i -= 2
            else:
                break
        return i - 1 if self.text(i - 1) == "*" and not self.tokens[i - 1].spaced else i

    def is_expression(self, i):
        """Whether the statement that begins at i is an expression, and so can be left out."""
        if self.text(i) in ("++", "--", "*", "(", "throw", "break", "continue", "delete"):
            return True
        if self.text(i) == "return":
            return self.text(i + 1) == ";"
        if self.text(i) in NO_EXPRESSION or not self.is_word(i):
            return False
        i += 1
        while self.text(i) == "::":
            i += 2
        behind = self.behind_arguments(i)
        if behind != i and self.text(behind) != "(":
            return False
        return (self.text(behind) in ("(", "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=",
                                      ".", "->", "[", "++", "--") or
                (self.text(behind) == "<<" and self.tokens[behind].spaced))


class Finder(Syntax):
    """All sites of a source, in its order, and its constants."""

    def __init__(self, source):
        super().__init__(source)
        self.source = source
        self.sites = []
        self.constants = []
        self.find_constants()
        i = 0
        while i < self.size:
            if self.text(i) == "static_assert" and self.text(i + 1) == "(":
                i = self.partner[i + 1]
            else:
                self.find_sites(i)
            i += 1
        self.sites.sort(key=lambda site: site.mutants[0].edit.begin)
        number = 1
        for site in self.sites:
            site.first_number = number
            number += len(site.mutants)

    def find_sites(self, i):
        text = self.text(i)
        kind = self.tokens[i].kind
        if self.starts[i]:
            self.statement(i)
        if text in ("if", "while"):
            self.condition(i)
        if kind == "number":
            self.number(i)
        if text in ("true", "false"):
            self.replace(i, i, ["false" if text == "true" else "true"], "boolean")
        if text in ("min", "max"):
            self.min_max(i)
        if kind != "sign":
            return
        if self.tokens[i].spaced and text in BINARY:
            self.two_operands(i, *BINARY[text])
        if text in ASSIGNMENTS:
            self.change(i, *ASSIGNMENTS[text])
        if text in ("&&", "||"):
            self.logical(i)
        if text == "?":
            self.ternary(i)
        if text in ("++", "--"):
            self.step(i)
        if text == "!" or (text == "-" and not self.tokens[i].spaced):
            self.prefix(i)

    def begin(self, i):
        return self.tokens[i].begin

    def end(self, i):
        return self.tokens[i].end

    def token_edit(self, i, text):
        return Edit(self.begin(i), self.end(i), text)

    def add(self, i, mutants, wraps=(), replacements=()):
        site = Site(mutants, list(wraps), list(replacements))
        outer = self.around[i]
        while outer is not None:
            if self.kind[outer] == "block":
                site.function = self.begin(outer)
            outer = self.around[outer]
        for constant in self.constants:
            if constant.begin < self.begin(i) < constant.end:
                site.constant = constant.name
        self.sites.append(site)

    def find_constants(self):
        for i in range(self.size):
            if self.text(i) != "constexpr" or self.text(i - 1) == "if":
                continue
            behind = self.find(i + 1, ["=", "{", "[", "(", ";"])  # the name stands before it
            end = self.find(behind, [";"])
            is_function = self.text(behind) == "("
            if is_function:
                body = self.find(behind, ["{", ";"])
                end = self.partner[body] if self.text(body) == "{" else body
            if end is not None and end < self.size:
                self.constants.append(Constant(self.text(behind - 1), self.begin(i), self.end(end), is_function))

    def statement(self, i):
        last = self.find(i, [";"])
        if self.is_expression(i) and self.text(last) == ";":
            begin, end = self.begin(i), self.end(last)
            self.add(i, [Mutant(Edit(begin, end, ";"), "statement")],
                     [Wrap(begin, end, "{ if (!::mutants::on(@0)) { ", " } }")])

    def decided_by_one_sign(self, begin, end):
        """Whether a comparison or a ! decides it alone: the opposite is a mutant of that already."""
        if self.text(begin) == "!" and self.behind_operand(begin + 1) == end:
            return True
        comparisons = 0
        i = begin
        while i < end:
            if self.text(i) in ("(", "[", "{"):
                i = self.partner[i]
            elif self.text(i) in ("&&", "||"):
                return False
            elif self.tokens[i].spaced and self.text(i) in COMPARISONS:
                comparisons += 1
            i += 1
        return comparisons == 1

    def condition(self, i):
        close = self.partner[i + 1] if self.text(i + 1) == "(" else None
        if close is None or self.find(i + 2, ["=", ";"]) != close:
            return
        begin, end = self.begin(i + 2), self.begin(close)
        mutants = []
        numbers = ["-1", "-1"]
        if not self.decided_by_one_sign(i + 2, close):
            numbers[0] = "@0"
            mutants.append(Mutant(Edit(begin, end, f"!({self.source[begin:end]})"), "condition"))
        if self.text(i) == "if":
            numbers[1] = f"@{len(mutants)}"
            mutants.append(Mutant(Edit(begin, end, "true"), "guard"))
        if mutants:
            before = f"::mutants::condition({numbers[0]}, {numbers[1]}, static_cast<bool>("
            self.add(i, mutants, [Wrap(begin, end, before, "))")])

    def number(self, i):
        before, behind = self.text(i - 1), self.text(i + 1)
        template_argument = ((before == "<" and not self.tokens[i - 1].spaced) or
                             (behind in (">", ">>") and self.joined(i + 1)))
        pure_virtual = (before == "=" and behind == ";" and
                        self.text(i - 2) in (")", "const", "noexcept", "override"))
        # The size of an array where it is declared: what goes beyond it is no behaviour.
        array_size = (before == "[" and behind == "]" and self.is_word(i - 2) and self.is_word(i - 3) and
                      self.text(i - 3) != "return")
        if not (template_argument or pure_virtual or array_size or before == "case" or self.within(i, "enum")):
            self.replace(i, i, other_numbers(self.text(i)), "constant")

    def min_max(self, i):
        if self.text(i - 1) != "::" or self.text(i - 2) != "std" or self.text(i + 1) not in ("(", "<"):
            return
        name = self.text(i)
        switched = f"::mutants::{name.capitalize()}{{@0}}{'.template of' if self.text(i + 1) == '<' else '.of'}"
        self.replace(i - 2, i, ["std::max" if name == "min" else "std::min"], "min-max", switched)

    def replace(self, first, last, others, name, switched=None):
        """Tokens first to last become one of `others`; all of them as one expression."""
        if not others:
            return
        begin, end = self.begin(first), self.end(last)
        mutants = [Mutant(Edit(begin, end, other), f"{name}.{k}" if len(others) > 1 else name)
                   for k, other in enumerate(others, 1)]
        choice = "".join(f"::mutants::on(@{k}) ? {other} : " for k, other in enumerate(others))
        self.add(first, mutants, (), [Edit(begin, end, switched or f"({choice}{self.source[begin:end]})")])

    def two_operands(self, i, others, switch, name):
        mutants = [Mutant(self.token_edit(i, other), f"{name}.{k}" if len(others) > 1 else name)
                   for k, other in enumerate(others, 1)]
        sign = self.text(i)
        self.add(i, mutants, (), [self.token_edit(i, f"{sign} ::mutants::{switch}{{@0}} {sign}")])

    def change(self, i, other, function):
        left = self.begin(self.operand_ending_at(i - 1))
        right = self.end(self.find(i + 1, [";", ","]) - 1)
        self.add(i, [Mutant(self.token_edit(i, other), "assignment")],
                 [Wrap(left, right, f"::mutants::{function}(@0, ", ")")], [self.token_edit(i, ",")])

    def logical(self, i):
        """a && b is !(!a || !b): one switch turns a, b and the whole."""
        if not self.tokens[i].spaced:
            return
        is_and = self.text(i) == "&&"
        left = self.find_back(i - 1, BEFORE_EXPRESSION + ["||"] * is_and) + 1
        right = self.find(i + 1, [";", ",", "?", ":", "||"] + ["&&"] * is_and) - 1
        self.add(i, [Mutant(self.token_edit(i, "||" if is_and else "&&"), "logical")],
                 [Wrap(self.begin(first), self.end(last), "::mutants::flip(@0, static_cast<bool>(", "))")
                  for first, last in ((left, right), (left, i - 1), (i + 1, right))])

    def ternary(self, i):
        first = self.find_back(i - 1, BEFORE_EXPRESSION) + 1
        if self.decided_by_one_sign(first, i):
            return
        begin, end = self.begin(first), self.end(i - 1)
        self.add(i, [Mutant(Edit(begin, end, f"!({self.source[begin:end]})"), "condition")],
                 [Wrap(begin, end, "::mutants::flip(@0, static_cast<bool>(", "))")])

    def step(self, i):
        up = self.text(i) == "++"
        name = "increment" if up else "decrement"
        mutants = [Mutant(self.token_edit(i, "--" if up else "++"), "step")]
        behind = self.behind_operand(i + 1)
        if self.joined(i + 1) and behind is not None and (self.is_word(i + 1) or self.text(i + 1) == "*"):
            self.add(i, mutants, [Wrap(self.begin(i), self.end(behind - 1), "", ")")],
                     [self.token_edit(i, f"::mutants::{name}(@0, ")])
        elif self.joined(i):
            left = self.begin(self.operand_ending_at(i - 1))
            self.add(i, mutants, [Wrap(left, self.end(i), f"::mutants::post_{name}(@0, ", ")")],
                     [self.token_edit(i, "")])

    def prefix(self, i):
        minus = self.text(i) == "-"
        before = self.text(i - 1)
        if minus and i > 0 and (before in (")", "]") or self.tokens[i - 1].kind == "number" or
                                (self.is_word(i - 1) and before != "return")):
            return
        behind = self.behind_operand(i + 1)
        if behind is None:
            return
        wrap = Wrap(self.begin(i), self.end(behind - 1), "" if minus else "::mutants::flip(@0, ", ")")
        self.add(i, [Mutant(self.token_edit(i, ""), "sign" if minus else "negation")], [wrap],
                 [self.token_edit(i, "::mutants::negative(@0, ")] if minus else [])


def other_numbers(number):
    """The number's text with other values."""
    plain = number.replace("'", "")
    hexadecimal = plain[:2] in ("0x", "0X")
    if plain.startswith("0b"):
        return []
    if not hexadecimal and re.search("[.eE]", plain):
        digits, suffix = re.fullmatch(r"([\d.]+(?:[eE][+-]?\d+)?)(.*)", plain).groups()
        value = float(digits)
        return [real(other) + suffix for other in ([value / 2, value * 2] if value else [1.0])]
    digits, suffix = re.fullmatch("(0[xX][0-9a-fA-F]+|[0-9]+)(.*)", plain).groups()
    value = int(digits, 16 if hexadecimal else 8 if digits.startswith("0") else 10)
    if value == 0:
        others = [1]
    elif value <= 16:
        others = [value - 1, value + 1]
    else:
        others = [value - value // 8, value + value // 8]
    return [(f"0x{other:X}" if hexadecimal else str(other)) + suffix for other in others]


def real(value):
    """The shortest text of the value."""
    _, digits, exponent = Decimal(repr(value)).normalize().as_tuple()
    mantissa = "".join(map(str, digits))
    power = exponent + len(mantissa) - 1
    scientific = f"{mantissa[0]}{'.' * (len(mantissa) > 1)}{mantissa[1:]}e{power:+03}"
    fixed = f"{Decimal(repr(value)).normalize():f}"
    text = fixed if len(fixed) <= len(scientific) else scientific
    return text if re.search("[.e]", text) else text + ".0"


def with_edit(source, edit):
    return source[:edit.begin] + edit.text + source[edit.end:]


def with_switches(source, mutations, alone=(), kept=(), first=0):
    """The source with the switches of all sites but the `alone` ones; the constants named in `kept` stay constexpr, and
    the sites in them are left alone, too. As many lines as the source. `first` is added to the mutants' numbers."""
    # At one place first what closes, brackets of one kind; then what opens, the outer first; then what stands for a
    # token.
    events = []
    switched = set()
    for i, site in enumerate(mutations.sites):
        if i in alone or site.constant in kept:
            continue
        switched.add(site.constant)

        def numbered(text):
            return re.sub("@([01])", lambda mark: str(first + site.first_number + int(mark[1])), text)

        for wrap in site.wraps:
            order = len(events)
            events.append((wrap.begin, 1, -wrap.end, order, wrap.begin, numbered(wrap.before)))
            events.append((wrap.end, 0, 0, order, wrap.end, numbered(wrap.behind)))
        for edit in site.replacements:
            events.append((edit.begin, 2, 0, 0, edit.end, numbered(edit.text)))
    for constant in mutations.constants:
        if constant.name in switched and constant.name not in kept:
            behind = constant.begin + len("constexpr")
            events.append((constant.begin, 2, 0, 0, behind, "inline" if constant.is_function else "const"))
    parts = []
    at = 0
    for begin, _, _, _, behind, text in sorted(events):
        parts += [source[at:begin], text]
        at = behind
    return "".join(parts) + source[at:]
