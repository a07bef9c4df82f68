"""Holds tool.sto and tool.mot against OpenSim's documented layout, and against each other: check_sto.py FOLDER.

"Storage (.sto) files", "Motion (.mot) files" and "OpenSense - Kinematics with IMU data" of OpenSim's documentation:
lines of key=value up to `endheader`, a line of labels of which the first is `time`, rows parted by tabs; a table of
quaternions says DataType=Quaternion and has four numbers parted by commas in a cell. Where OpenSim's own Python package is there, it must read the same numbers.
"""
import math
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])


def table(path):
    lines = path.read_text(encoding="utf-8").split("\n")
    assert lines[-1] == "" and "\r" not in "".join(lines), "ends with one line feed"
    end = lines.index("endheader")
    header = dict(line.split("=", 1) for line in lines[:end] if "=" in line)
    labels = lines[end + 1].split("\t")
    rows = [line.split("\t") for line in lines[end + 2:-1]]
    assert labels[0] == "time" and len(set(labels)) == len(labels) and all(labels)
    assert not any(c.isspace() for label in labels for c in label)
    assert all(len(row) == len(labels) for row in rows)
    times = [float(row[0]) for row in rows]
    assert all(a < b for a, b in zip(times, times[1:])) and len(rows) > 100
    return header, lines[:end], labels, rows, times


header, _, labels, rows, sto_times = table(folder / "tool.sto")
assert header["DataType"] == "Quaternion" and header["version"] == "3" and "OpenSimVersion" in header
assert abs(float(header["DataRate"]) - 120.0) < 1.0 and len(labels) == 2
quaternions = [[float(x) for x in row[1].split(",")] for row in rows]
assert all(len(q) == 4 and abs(math.hypot(*q) - 1) < 1e-9 for q in quaternions)

header, lines, labels, rows, mot_times = table(folder / "tool.mot")
assert "=" not in lines[0] and header["version"] == "1" and header["inDegrees"] == "yes"
assert int(header["nRows"]) == len(rows) and int(header["nColumns"]) == len(labels) == 7
assert [label.rsplit("_", 1)[1] for label in labels[1:]] == ["tx", "ty", "tz", "rx", "ry", "rz"]
assert mot_times == sto_times
# the angles are body-fixed X-Y-Z: R = Rx Ry Rz, as the quaternions say (w, x, y, z)
for q, row in zip(quaternions, rows):
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a), math.sin(a)) for a in (math.radians(float(v)) for v in row[4:7]))
    angles = ((cy * cz, -cy * sz, sy), (sx * sy * cz + cx * sz, cx * cz - sx * sy * sz, -sx * cy),
              (sx * sz - cx * sy * cz, cx * sy * sz + sx * cz, cx * cy))
    w, x, y, z = q
    turned = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
              (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
              (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    assert all(abs(angles[i][j] - turned[i][j]) < 1e-9 for i in range(3) for j in range(3))
try:
    import opensim
except ImportError:
    opensim = None
    print("skipped: the Python package opensim is absent; the layout was checked without it")
if opensim:
    sto = opensim.TimeSeriesTableQuaternion(str(folder / "tool.sto"))
    mot = opensim.TimeSeriesTable(str(folder / "tool.mot"))
    assert sto.getNumRows() == mot.getNumRows() == len(rows)
    assert list(mot.getColumnLabels()) == labels[1:] and mot.getTableMetaDataString("inDegrees") == "yes"
    for k in range(0, len(rows), 100):
        read = sto.getRowAtIndex(k).getElt(0, 0)
        assert all(abs(read.get(i) - quaternions[k][i]) < 1e-12 for i in range(4))
        assert all(abs(mot.getRowAtIndex(k)[i] - float(rows[k][i + 1])) < 1e-12 for i in range(6))
    print(f"OpenSim {opensim.GetVersion()} reads both")
print(f"{len(rows)} rows of tool.sto and tool.mot as OpenSim's documentation has them")
