"""Which changes of a Rust source file are tried, and the file that holds all of them, each behind a switch."""

import re
from dataclasses import dataclass

import tree_sitter
import tree_sitter_rust

SWITCH = "crate::mutant_switch::is"
# What an operator becomes. A limit moves onto its neighbour and to the other side; a sum and a product to their inverse.
OPERATORS = {
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["/"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="],
    "==": ["!="], "!=": ["=="],
    "<": ["<=", ">"], "<=": ["<", ">"], ">": [">=", "<"], ">=": [">", "<"],
    "&&": ["||"], "||": ["&&"],
    "&": ["|"], "|": ["&"], "^": ["|"], "<<": [">>"], ">>": ["<<"],
}  # fmt: skip
# What a function answers without doing anything, by its type.
ANSWERS = [
    (r"bool", ["true", "false"]),
    (r"f64|f32", ["0.0", "1.0", "-1.0"]),
    (r"[iu](8|16|32|64|size)", ["0", "1"]),
    (r"\(\)", [""]),
    (r"(std::)?result::Result<\(\),.*|Result<\(\)(,.*)?>", ["Ok(())"]),
    (r"Option<.*>", ["None"]),
    (r"String", ["String::new()", '"xyzzy".into()']),
    (r"Vec<.*>", ["Vec::new()"]),
    (r"\[f64; *\w+\]", ["[0.0; _]"]),
]
# Values that the compiler works out itself: no switch can be read there. Macros are not looked into.
FIXED = {"const_item", "static_item", "enum_variant", "attribute_item", "inner_attribute_item", "macro_invocation",
         "macro_definition", "const_block", "array_type", "type_arguments", "match_pattern", "range_pattern"}  # fmt: skip
PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))


@dataclass
class Change:
    """One fault: `text` in place of the bytes from `start` to `end`."""

    file: str
    line: int
    what: str
    start: int
    end: int
    text: str
    kind: str  # "expression", "statement" or "answer"
    number: int = 0

    def __str__(self):
        return f"{self.file}:{self.line}: {self.what}"


def of(file, source):
    """All changes of a file, outer ones before those within them."""
    found = []
    visit(PARSER.parse(source).root_node, source, file, "", found)
    return found


def text_of(node, source):
    return source[node.start_byte : node.end_byte].decode()


# Tests, and what is not compiled where this runs: on Linux, x86-64.
ELSEWHERE = re.compile(r"cfg\((all\()?(test\b|doctest|not\((unix|isolation|any\(target_|target_os)|target_arch = \"aarch64\")")


def elsewhere(node, source):
    """Whether `#[cfg(test)]` or the like stands before it."""
    before = node.prev_sibling
    while before is not None and before.type in ("attribute_item", "line_comment"):
        if ELSEWHERE.search(text_of(before, source)):
            return True
        before = before.prev_sibling
    return False


def visit(node, source, file, within, found):
    if node.type in FIXED or elsewhere(node, source):
        return
    if node.type == "impl_item":
        of_trait, of_type = node.child_by_field_name("trait"), node.child_by_field_name("type")
        if of_trait is not None and text_of(of_trait, source).endswith("Debug"):
            return
        within = text_of(of_type, source).split("<")[0] + "::"
    if node.type == "function_item":
        modifiers = [text_of(child, source) for child in node.children if child.type == "function_modifiers"]
        if any("const" in words for words in modifiers):
            return
        within += text_of(node.child_by_field_name("name"), source)
        answers(node, source, file, within, found)
    operator(node, source, file, within, found)
    for child in node.children:
        if node.type == "array_expression" and child.type != "[" and child == node.child_by_field_name("length"):
            continue
        if child.type.endswith("_pattern") or (node.type == "match_arm" and child.type == "match_pattern"):
            continue
        visit(child, source, file, within, found)


def answers(node, source, file, name, found):
    body = node.child_by_field_name("body")
    inside = [child for child in body.named_children if "comment" not in child.type]
    if not inside:
        return
    kind = node.child_by_field_name("return_type")
    kind = " ".join(text_of(kind, source).split()) if kind is not None else "()"
    here = text_of(body, source).strip("{ \n}")
    for pattern, values in ANSWERS:
        if re.fullmatch(pattern, kind):
            for value in values:
                if here in (value, f"{value}.into()"):
                    continue
                what = f"{name} answers {value or 'at once'}"
                place = inside[0].start_byte
                line = node.child_by_field_name("name").start_point[0] + 1
                found.append(Change(file, line, what, place, place, f"return {value};", "answer"))
            return


def operator(node, source, file, within, found):
    line = node.start_point[0] + 1
    if node.type in ("binary_expression", "compound_assignment_expr"):
        left, sign, right = (node.child_by_field_name(part) for part in ("left", "operator", "right"))
        if holds_let(node):
            return
        old = text_of(sign, source)
        kind = "expression" if node.type == "binary_expression" else "statement"
        for new in OPERATORS.get(old, []):
            head = source[left.start_byte : sign.start_byte].decode()
            text = f"{head}{new}{source[sign.end_byte : right.end_byte].decode()}"
            column = sign.start_point[1] + 1
            what = f"{old} becomes {new} in {within} (column {column})"
            found.append(Change(file, sign.start_point[0] + 1, what, node.start_byte, node.end_byte, text, kind))
    elif node.type == "unary_expression" and source[node.start_byte : node.start_byte + 1] in (b"-", b"!"):
        inner = node.named_children[-1]
        old = source[node.start_byte : node.start_byte + 1].decode()
        what = f"{old} goes in {within} (column {node.start_point[1] + 1})"
        found.append(Change(file, line, what, node.start_byte, node.end_byte, text_of(inner, source), "expression"))


def holds_let(node):
    return node.type in ("let_condition", "let_chain") or any(map(holds_let, node.children))


def behind_switches(source, changes):
    """The source with each change behind its switch. Where changes lie within each other, a changed branch is as written."""
    changes = sorted(changes, key=lambda change: (change.start, -change.end, change.number))
    # Bytes of the source with what was made of them: from the inside to the outside.
    edits = []
    by_place = {}
    for change in changes:
        by_place.setdefault((change.start, change.end), []).append(change)
    for (start, end), here in by_place.items():
        if here[0].kind == "answer":
            text = "".join(f"if {SWITCH}({change.number}) {{ {change.text} }} " for change in here)
            edits.append((start, 0, text))
            continue
        opening = "("
        for change in here:
            opening += f"if {SWITCH}({change.number}) {{ {change.text} }} else "
        edits.append((start, 1, opening + "{ "))
        edits.append((end, -1, " })"))
    # At one place: what ends comes before what begins; of those that begin, the longest first, as sorted above.
    edits.sort(key=lambda edit: (edit[0], edit[1]))
    made, at = [], 0
    for place, _, text in edits:
        made += [source[at:place], text.encode()]
        at = place
    return b"".join([*made, source[at:]])
