"""Reads exported particles by its own lights: python3 read_particles.py [--vtk] FILE.

PLY, XML with base64 and CSV are taken apart here, from their definitions; with --vtk a .vtp goes through VTK's own reader, and 77 is the
exit status where there is none. Prints the time, the type of a coordinate, then "id x y z vx vy vz density mass pressure" by id.
"""
import base64
import csv
import struct
import sys
import xml.etree.ElementTree

TYPES = {"float": "f", "double": "d", "uint": "I", "Float32": "f", "Float64": "d", "UInt32": "I", "Int64": "q"}


def read_ply(path):
    head, data = open(path, "rb").read().split(b"end_header\n", 1)
    lines = head.decode("ascii").split("\n")
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"], lines[:2]
    time = float(next(line for line in lines if " s, +" in line).split(" at ")[1].split(" s")[0])
    count = int(next(line for line in lines if line.startswith("element vertex ")).split()[2])
    properties = [line.split()[1:] for line in lines if line.startswith("property ")]
    row = struct.Struct("<" + "".join(TYPES[kind] for kind, _ in properties))
    assert row.size * count == len(data), (row.size, count, len(data))
    names = [name for _, name in properties]
    return time, properties[0][0], [dict(zip(names, values)) for values in row.iter_unpack(data)]


def read_vtp(path):
    root = xml.etree.ElementTree.parse(path).getroot()
    assert root.attrib["byte_order"] == "LittleEndian" and root.attrib["header_type"] == "UInt64"
    piece = root.find("PolyData/Piece")
    count = int(piece.attrib["NumberOfPoints"])
    arrays = {}
    for array in root.iter("DataArray"):
        raw = base64.b64decode(array.text, validate=True)
        assert struct.unpack("<Q", raw[:8])[0] == len(raw) - 8
        form = "<" + TYPES[array.attrib["type"]]
        arrays[array.attrib["Name"]] = [number for (number,) in struct.iter_unpack(form, raw[8:])]
    assert arrays["connectivity"] == list(range(count)) and arrays["offsets"] == list(range(1, count + 1))
    kind = piece.find("Points/DataArray").attrib["type"]
    return arrays["TimeValue"][0], kind, rows_of(count, arrays["Points"], arrays)


def rows_of(count, points, arrays):
    rows = []
    for i in range(count):
        row = dict(zip("xyz", points[3 * i : 3 * i + 3]))
        row.update(zip(("vx", "vy", "vz"), arrays["velocity"][3 * i : 3 * i + 3]))
        for name in ("density", "mass", "pressure", "id"):
            row[name] = arrays[name][i]
        rows.append(row)
    return rows


def read_csv(path):
    rows = list(csv.reader(open(path, newline="")))
    units = {"x": "m", "y": "m", "z": "m", "vx": "m/s", "vy": "m/s", "vz": "m/s", "density": "kg/m3", "mass": "kg", "pressure": "Pa"}
    assert rows[0] == ["id"] + [f"{name} [{unit}]" for name, unit in units.items()], rows[0]
    names = [title.split(" ")[0] for title in rows[0]]
    return float("nan"), "text", [dict(zip(names, map(float, row))) for row in rows[1:]]


def read_by_vtk(path):
    try:
        import vtkmodules.vtkIOXML as io
    except ImportError:
        sys.exit(77)
    reader = io.vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    assert reader.GetErrorCode() == 0 and data.GetNumberOfVerts() == data.GetNumberOfPoints()
    count = data.GetNumberOfPoints()

    def numbers(array):
        return [array.GetValue(k) for k in range(array.GetNumberOfValues())]

    named = {name: numbers(data.GetPointData().GetArray(name)) for name in ("velocity", "density", "mass", "pressure", "id")}
    points = data.GetPoints().GetData()
    time = data.GetFieldData().GetArray("TimeValue").GetValue(0)
    return time, points.GetDataTypeAsString(), rows_of(count, numbers(points), named)


def main():
    path = sys.argv[-1]
    readers = {"ply": read_ply, "vtp": read_vtp, "csv": read_csv}
    read = read_by_vtk if "--vtk" in sys.argv[1:-1] else readers[path.rsplit(".", 1)[1]]
    time, kind, rows = read(path)
    print("%.17g" % time, kind)
    for row in sorted(rows, key=lambda r: r["id"]):
        print(int(row["id"]), *("%.17g" % row[k] for k in ("x", "y", "z", "vx", "vy", "vz", "density", "mass", "pressure")))


main()
