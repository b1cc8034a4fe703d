#!/usr/bin/env python3
"""python_page.py ROOT [FOLDER]: runs the blocks of Python of docs/python.md one after the other, as one program, and looks at what they print
and draw. FOLDER: where the pictures are left. The package must be importable. Exit 77: NumPy, SciPy or Matplotlib is not installed."""
import io
import os
import pathlib
import re
import shutil
import sys
import tempfile
from contextlib import redirect_stdout

try:
    import matplotlib
    import numpy as np
    import scipy  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing.name} is not installed")
    sys.exit(77)

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402

root = pathlib.Path(sys.argv[1]).resolve()
page = root / "docs/python.md"
text = page.read_text()
found = re.finditer(r"^```python\n(.*?)^```$", text, re.M | re.S)
blocks = ["\n" * text.count("\n", 0, block.start(1)) + block[1] for block in found]  # an error names the page's line
if len(blocks) < 5:
    sys.exit(f"{page} has {len(blocks)} blocks of Python: the test reads it wrongly")
left = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else None
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    pathlib.Path("assets").symlink_to(root / "assets")
    said, names = io.StringIO(), {"__name__": "__main__"}
    for block in blocks:
        with redirect_stdout(said):
            exec(compile(block, str(page), "exec"), names)
    print(said.getvalue())
    for picture in ("front.png", "picture.png") if left else ():
        shutil.copy(picture, left)
    ours, theirs = map(float, re.search(r"speed of the front: ([\d.]+), measured ([\d.]+)", said.getvalue()).groups())
    assert abs(ours / theirs - 1) < 0.05, "the front is not as fast as in the experiment"
    viscosity = float(re.search(r"^viscosity ([\d.]+)", said.getvalue(), re.M)[1])
    assert abs(viscosity / 0.02 - 1) < 0.1, "the fit finds another viscosity"
    assert "fluid.viscosity" in said.getvalue(), "the sentence of an error names no remedy"
    plot = matplotlib.image.imread("front.png")[..., :3]
    line, marks = (np.abs(plot - np.array(colour) / 255).max(axis=2) < 0.1 for colour in ((23, 105, 170), (192, 57, 43)))
    columns = np.flatnonzero(line.any(axis=0))
    assert columns.max() - columns.min() > 0.6 * plot.shape[1] and marks.sum() > 200, "the plot lacks its curve or its marks"
    # The water covers a part of the floor, and is not one colour.
    water = np.abs(names["picture"][..., :3] - np.rint(names["image"] * 255)).max(axis=2) > 2
    assert 0.05 < water.mean() < 0.6 and names["picture"][water][:, :3].std() > 5, water.mean()
