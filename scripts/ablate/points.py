"""What can be switched off or moved in a Rust source file: conditions, and numbers that have a name."""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "mutants"))
from changes import FIXED, PARSER, tests_only, text_of  # noqa: E402

NUMERIC = re.compile(r"f64|f32|usize|u8|u16|u32|u64|i32|i64")
COMPARED = {"<", ">", "<=", ">=", "==", "!="}


@dataclass
class Point:
    """A condition from `start` to `end`, or all uses of a number."""

    kind: str  # "condition" or "number"
    file: str
    line: int
    text: str
    within: str
    uses: list  # (file, start, end, line)
    number: int = 0

    def __str__(self):
        return f"{self.number} {self.file}:{self.line} {self.kind} {self.within}: {self.text}"


def of(sources):
    """All points of a crate's sources (name: bytes), in the order of the files."""
    trees = {name: PARSER.parse(text).root_node for name, text in sources.items()}
    numbers = {}
    for name, tree in trees.items():
        for node in walk(tree, sources[name], inside_constants=True):
            constant(node, sources[name], name, numbers)
    found = list(numbers.values())
    for name, tree in trees.items():
        source, seen = sources[name], set()
        for node in walk(tree, source):
            for part in conditions(node, source):
                if (part.start_byte, part.end_byte) not in seen:
                    seen.add((part.start_byte, part.end_byte))
                    use = (name, part.start_byte, part.end_byte, part.start_point[0] + 1)
                    text = " ".join(text_of(part, source).split())
                    found.append(Point("condition", name, use[3], text, function(part, source), [use]))
            used = used_number(node, source, name, numbers)
            if used is not None:
                used.uses.append((name, node.start_byte, node.end_byte, node.start_point[0] + 1))
    found.sort(key=lambda point: (point.file, point.line, point.kind == "condition"))
    for number, point in enumerate(found, 1):
        point.number = number
    return found


def walk(node, source, inside_constants=False):
    fixed = FIXED - {"const_item"} if inside_constants else FIXED
    if node.type in fixed or tests_only(node, source):
        return
    if node.type == "function_item" and not inside_constants:
        if any("const" in text_of(child, source) for child in node.children if child.type == "function_modifiers"):
            return
    yield node
    for child in node.children:
        if not (child.type.endswith("_pattern") or (node.type == "match_arm" and child.type == "match_pattern")):
            yield from walk(child, source, inside_constants)
        elif child.type == "match_pattern" and child.child_by_field_name("condition") is not None:
            yield child  # a guard
            yield from walk(child.child_by_field_name("condition"), source, inside_constants)


def constant(node, source, file, numbers):
    """A numeric constant, or a field of the policy's value."""
    line = node.start_point[0] + 1
    if node.type == "const_item":
        kind = text_of(node.child_by_field_name("type"), source)
        name = text_of(node.child_by_field_name("name"), source)
        if NUMERIC.fullmatch(kind):
            value = " ".join(text_of(node.child_by_field_name("value"), source).split())
            numbers[file, name] = Point("number", file, line, value, name, [])
        elif file.endswith("/policy.rs"):
            text = text_of(node, source)
            for field in re.finditer(r"[{,]\s*(\w+): ([^,}]+)", text):
                own, at = f"{name}.{field[1]}", line + text[: field.start(1)].count("\n")
                numbers[file, own] = Point("number", file, at, field[2].strip(), own, [])


def used_number(node, source, file, numbers):
    """The number that a node reads, if any."""
    if node.type == "field_expression":
        name = text_of(node, source)
        return next((point for (_, known), point in numbers.items() if known == name), None) if "." in name else None
    if node.type not in ("identifier", "scoped_identifier"):
        return None
    name = text_of(node, source).split("::")[-1]
    parent = node.parent
    imports = ("scoped_identifier", "use_list", "use_declaration", "scoped_use_list")
    if not re.fullmatch(r"[A-Z][A-Z_0-9]+", name) or parent.type in imports:
        return None
    return numbers.get((file, name)) or imported(name, file, source, numbers)


def imported(name, file, source, numbers):
    """A number of another file: named in a `use`, or of the module above by a glob."""
    defined = [point for (_, known), point in numbers.items() if known == name]
    uses = " ".join(re.findall(r"^\s*(?:pub(?:\(\w+\))? )?use ([^;]+);", source.decode(), re.M | re.S))
    if re.search(rf"\b{name}\b", uses):
        return defined[0] if len(defined) == 1 else None
    if "super::*" in uses:
        above = [point for point in defined if Path(point.file) == Path(file).parent / "mod.rs"]
        return above[0] if above else None
    return None


def function(node, source):
    while node is not None and node.type != "function_item":
        node = node.parent
    return text_of(node.child_by_field_name("name"), source) if node is not None else ""


def conditions(node, source):
    """The parts of this node that are conditions, without those that bind."""
    if node.type in ("if_expression", "match_pattern"):
        yield from parts(node.child_by_field_name("condition"), source)
    elif node.type == "binary_expression":
        sign = text_of(node.child_by_field_name("operator"), source)
        if sign in ("&&", "||"):
            yield from parts(node.child_by_field_name("left"), source)
            yield from parts(node.child_by_field_name("right"), source)
        elif sign in COMPARED:
            yield node


def parts(node, source):
    if node is None or node.type == "let_condition" or "comment" in node.type:
        return
    if node.type == "let_chain":
        for child in node.named_children:
            yield from parts(child, source)
        return
    if node.type == "binary_expression" and text_of(node.child_by_field_name("operator"), source) in ("&&", "||"):
        return  # its operands come by themselves
    yield node


def instrumented(name, source, points):
    """The source with each point behind its switch."""
    edits = []
    for point in points:
        for file, start, end, _ in point.uses:
            if file == name:
                call = "is" if point.kind == "condition" else "number"
                edits.append((start, 1, -end, f"crate::ablation::{call}({point.number}, "))
                edits.append((end, -1, -start, ")"))
    edits.sort(key=lambda edit: edit[:3])
    made, at = [], 0
    for place, _, _, text in edits:
        made += [source[at:place], text.encode()]
        at = place
    return b"".join([*made, source[at:]])
