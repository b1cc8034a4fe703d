#!/usr/bin/env python3
"""Draws docs/images/rooms.svg from rooms.json: the rooms and the direct arrows between them. With --check: fails if the file is out of date."""
import json
import pathlib
import sys
from html import escape

HERE = pathlib.Path(__file__).resolve().parent
DRAWING = HERE.parent.parent / "docs/images/rooms.svg"
ROOMS = json.loads((HERE / "rooms.json").read_text())["rooms"]
BOX = "fluid/sim"  # drawn as one box with rooms in it

# Layout, in pixels of a drawing 960 wide.
LEFT, TOP, WIDTH, HEIGHT = 20, 20, 200, 48
COLUMNS = [LEFT, 310, 523, 736]  # engine/, then fluid/
ROW_GAPS = [34, 34, 34, 58, 52, 34, 34]  # below each row
CELL, CELL_GAP, CELL_HEIGHT, CELL_ROW = 140, 14, 40, 64  # rooms inside the box
BOX_ROWS = 4
BOX_HEIGHT = 40 + BOX_ROWS * CELL_ROW
COLOURS = {"engine": ("#e8f0fb", "#3d6fb4"), "fluid": ("#e3f4f1", "#23857a"), "shaders": ("#f4efe3", "#94752c")}
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"


def reach(arrows, start):
    """The nodes that can be reached from `start` by one arrow or more."""
    found, open_ = set(), list(arrows[start])
    while open_:
        node = open_.pop()
        if node not in found:
            found.add(node)
            open_ += arrows[node]
    return found


def reduced(arrows):
    """Without the arrows that a longer way implies. `arrows` has no circles."""
    return {a: [b for b in to if not any(b in reach(arrows, c) for c in to if c != b)] for a, to in arrows.items()}


def groups():
    """Room -> the room itself, or the sorted names of rooms in one circle, joined."""
    arrows = {room: rule["includes"] for room, rule in ROOMS.items()}
    name = {}
    for room in ROOMS:
        circle = sorted({room} | {other for other in reach(arrows, room) if room in reach(arrows, other)})
        name[room] = "+".join(circle)
    return name


class Box:
    def __init__(self, x, y, width, height):
        self.x, self.y, self.width, self.height = x, y, width, height
        self.right, self.bottom = x + width, y + height
        self.centre, self.middle = x + width / 2, y + height / 2


def places():
    """Every room, the box and the groups -> Box."""
    tops = [TOP]
    for row, gap in enumerate(ROW_GAPS):
        tops.append(tops[-1] + (BOX_HEIGHT if row == 5 else HEIGHT) + gap)
    found = {BOX: Box(COLUMNS[1], tops[5], COLUMNS[3] + WIDTH - COLUMNS[1], BOX_HEIGHT)}
    box = found[BOX]
    inset = (box.width - 4 * CELL - 3 * CELL_GAP) / 2
    for room, rule in ROOMS.items():
        column, row = rule["place"]
        if room.startswith(BOX + "/"):
            span = rule.get("span", 1)
            found[room] = Box(box.x + inset + column * (CELL + CELL_GAP), box.y + 42 + row * CELL_ROW,
                              span * CELL + (span - 1) * CELL_GAP, CELL_HEIGHT)
        else:
            middle = (BOX_HEIGHT - HEIGHT) / 2 if row == 5 else 0
            found[room] = Box(COLUMNS[column], tops[row] + middle, WIDTH, HEIGHT)
    for members in {g for g in groups().values() if "+" in g}:
        boxes = [found[room] for room in members.split("+")]
        x, y = min(b.x for b in boxes) - 7, min(b.y for b in boxes) - 7
        found[members] = Box(x, y, max(b.right for b in boxes) + 7 - x, max(b.bottom for b in boxes) + 7 - y)
    return found


def arrows():
    """(from, to, dashed): `to` may include `from`. Inside the box between its rooms; from outside, to or from the box."""
    group = groups()
    outer, inner, single = {BOX: set()}, {}, set()
    for room, rule in ROOMS.items():
        inside = room.startswith(BOX + "/")
        if inside:
            inner.setdefault(group[room], set())
        else:
            outer.setdefault(room, set())
        for other in rule["includes"]:
            if inside and other.startswith(BOX + "/"):
                if group[other] != group[room]:
                    inner[group[room]].add(group[other])
            else:
                outer[BOX if inside else room].add(BOX if other.startswith(BOX + "/") else other)
        if not inside:
            single |= {(header.rsplit("/", 1)[0], room) for header in rule.get("headers", [])}
    result = []
    for graph in (outer, inner):
        direct = reduced(graph)
        result += [(b, a, False) for a in sorted(direct) for b in sorted(direct[a])]
    return result + [(a, b, True) for a, b in sorted(single)]


def rounded(points, radius=8):
    """A path through `points`, horizontal and vertical pieces, with round corners."""
    d = f"M{points[0][0]:g} {points[0][1]:g}"
    for before, at, after in zip(points, points[1:], points[2:]):
        ends = []
        for end in (before, after):
            length = max(abs(end[0] - at[0]), abs(end[1] - at[1])) or 1
            step = min(radius, length / 2) / length
            ends.append((at[0] + (end[0] - at[0]) * step, at[1] + (end[1] - at[1]) * step))
        d += f"L{ends[0][0]:g} {ends[0][1]:g}Q{at[0]:g} {at[1]:g} {ends[1][0]:g} {ends[1][1]:g}"
    return d + f"L{points[-1][0]:g} {points[-1][1]:g}"


def routes(boxes):
    """(path, colour, dashed) of every arrow."""
    todo = arrows()
    sides = {}  # (room, side) -> the arrows that end there, in the order of their other ends

    def side(a, b):
        """The sides at which the arrow a -> b leaves and arrives."""
        far = boxes[a].x == LEFT and boxes[b].x > COLUMNS[1]
        if abs(boxes[a].middle - boxes[b].middle) < 1 and not far:
            return ("right", "left") if boxes[a].x < boxes[b].x else ("left", "right")
        if boxes[a].x == LEFT and boxes[b].x == LEFT:
            return ("top", "bottom")
        if boxes[a].x == LEFT:
            return ("right", "bottom" if far else "left")
        if boxes[b].x == LEFT:
            return ("left", "right")
        return ("top", "bottom")

    def order(key, arrow):
        other = boxes[arrow[1] if arrow[0] == key[0] else arrow[0]]
        if key[1] in ("top", "bottom"):
            return (other.centre, -other.y)
        return (other.middle, other.x)

    for arrow in todo:
        out, into = side(*arrow[:2])
        sides.setdefault((arrow[0], out), []).append(arrow)
        sides.setdefault((arrow[1], into), []).append(arrow)
    for key, ending in sides.items():
        ending.sort(key=lambda arrow: order(key, arrow))

    def port(room, name, arrow):
        """An arrow to a room opposite ends in the middle; the others beside it, in order."""
        box, ending = boxes[room], sides[room, name]
        upright = name in ("top", "bottom")
        others = [boxes[a if b == room else b] for a, b, _ in ending]
        straight = [k for k, other in enumerate(others) if (other.centre == box.centre if upright else other.middle == box.middle)]
        spot = ending.index(arrow) - (straight[-1] if straight else (len(ending) - 1) / 2)
        if not upright:
            return (box.x if name == "left" else box.right, box.middle + 13 * spot)
        y = box.y if name == "top" else box.bottom
        other = boxes[arrow[1] if arrow[0] == room else arrow[0]]
        if box.width > 2 * other.width - 1:  # a wide box: straight up
            return (min(max(other.centre, box.x + 20), box.right - 20), y)
        return (box.centre + min(27, box.width / (len(ending) + 1)) * spot, y)

    found = []
    lanes = iter(range(8))
    for arrow in todo:
        a, b, dashed = arrow
        out, into = side(a, b)
        start, end = port(a, out, arrow), port(b, into, arrow)
        colour = COLOURS[a.split("/")[0]][1]
        if out == "top":
            if boxes[a].width > 2 * boxes[b].width - 1:
                start = (end[0], start[1])
            elif boxes[b].width > 2 * boxes[a].width - 1:
                end = (min(max(start[0], boxes[b].x + 24), boxes[b].right - 24), end[1])
            middle = (start[1] + end[1]) / 2
            path = f"M{start[0]:g} {start[1]:g}C{start[0]:g} {middle:g} {end[0]:g} {middle:g} {end[0]:g} {end[1]:g}"
        elif start[1] == end[1]:
            path = rounded([start, end])
        else:
            lane = LEFT + WIDTH + 18 + (24 if out == "left" else 10 * next(lanes))
            points = [start, (lane, start[1])]
            if into == "bottom":  # through the channel below the row
                channel = end[1] + 14 + 10 * sides[b, into].index(arrow)
                points += [(lane, channel), (end[0], channel)]
            else:
                points += [(lane, end[1])]
            path = rounded(points + [end])
        found.append((path, colour, dashed))
    return found


def text(x, y, size, words, more=""):
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}"{more}>{escape(words)}</text>'


def draw():
    boxes = places()
    height = max(box.bottom for box in boxes.values()) + 20
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 {height:g}" font-family="{FONT}" fill="#1f2933">',
           "<title>Folders and the includes that are allowed between them</title>",
           "<!-- Written by tests/checks/rooms.py from tests/checks/rooms.json -->", "<defs>"]
    for kind, (_, line) in COLOURS.items():
        out.append(f'<marker id="{kind}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="9" markerHeight="9" '
                   f'markerUnits="userSpaceOnUse" orient="auto"><path d="M0 1L10 5L0 9z" fill="{line}"/></marker>')
    out += ["</defs>", f'<rect width="960" height="{height:g}" fill="#fff"/>']
    box, (fill, line) = boxes[BOX], COLOURS["fluid"]
    out.append(f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" height="{box.height:g}" rx="12" fill="#f5fbfa" stroke="{line}" stroke-width="1.5"/>')
    out.append(text(box.x + 20, box.y + 26, 15, BOX, ' font-weight="600"'))
    out.append(text(box.x + 20, box.y + 45, 12, "particles", ' fill="#52606d"'))
    world = boxes[BOX + "/world"]
    for k, words in enumerate(("every room but kernels", "may read its plain data")):
        out.append(text(world.right + 14, world.middle - 3 + 15 * k, 12, words, ' fill="#52606d"'))
    for name in sorted(name for name in boxes if "+" in name):
        b = boxes[name]
        out.append(f'<rect x="{b.x:g}" y="{b.y:g}" width="{b.width:g}" height="{b.height:g}" rx="11" fill="#d3ece7" stroke="none"/>')
    kind_of = {line: kind for kind, (_, line) in COLOURS.items()}
    for path, colour, dashed in routes(boxes):
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        out.append(f'<path d="{path}" fill="none" stroke="#fff" stroke-width="5" stroke-opacity="0.8"/>')
        out.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.6"{dash} marker-end="url(#{kind_of[colour]})"/>')
    for room, rule in ROOMS.items():
        b, (fill, line) = boxes[room], COLOURS[room.split("/")[0]]
        small = room.startswith(BOX + "/")
        name = room.rsplit("/", 1)[1] if small else room
        out.append(f'<rect x="{b.x:g}" y="{b.y:g}" width="{b.width:g}" height="{b.height:g}" rx="8" fill="{"#fff" if small else fill}" '
                   f'stroke="{line}" stroke-width="1.3"/>')
        middle = ' text-anchor="middle"'
        out.append(text(b.centre, b.middle - 3, 14, name, middle + ' font-weight="600"'))
        out.append(text(b.centre, b.middle + 14, 12, rule["doc"], middle + ' fill="#52606d"'))
    out += legend(COLUMNS[3] - 52, TOP + 10)
    return "\n".join(out + ["</svg>", ""])


def legend(x, y):
    line = COLOURS["fluid"][1]
    out = []
    rows = [("B may include A, and so may all", ""), ("rooms that arrows from B reach", None),
            ("only single headers of A", ' stroke-dasharray="5 4"'), ("rooms that include each other", "band")]
    rows += [(f"{room} includes no {other}", None) for room, rule in ROOMS.items() for other in rule.get("not", [])]
    for k, (words, dash) in enumerate(rows):
        at = y + 19 * k
        if dash == "band":
            out.append(f'<rect x="{x}" y="{at - 11}" width="46" height="15" rx="5" fill="#d3ece7"/>')
        elif dash is not None:
            out.append(text(x - 13, at, 12, "A") + text(x + 50, at, 12, "B"))
            out.append(f'<path d="M{x} {at - 4}L{x + 46} {at - 4}" stroke="{line}" stroke-width="1.6"{dash} marker-end="url(#fluid)"/>')
        out.append(text(x + 66, at, 12, words, ' fill="#52606d"'))
    return out


if __name__ == "__main__":
    drawing = draw()
    if sys.argv[1:] == ["--check"]:
        if not DRAWING.exists() or DRAWING.read_text() != drawing:
            sys.exit("docs/images/rooms.svg is not what rooms.json says: run python3 tests/checks/rooms.py")
    else:
        DRAWING.write_text(drawing)
