"""Runs the Python of python/README.md, block by block, with the interpreter that runs this.

    python readme.py README.md BLOCKS...        e.g. 1, or 1 2
"""

import re
import sys
from pathlib import Path

text = Path(sys.argv[1]).read_text("utf-8")
blocks = re.findall(r"```python\n(.*?)```", text, flags=re.S)
scope: dict[str, object] = {}
for number in map(int, sys.argv[2:]):
    print(f"-- block {number}")
    exec(compile(blocks[number - 1], f"README.md, block {number}", "exec"), scope)
