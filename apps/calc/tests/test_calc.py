"""shisei.oxt in a real LibreOffice: python3 apps/calc/tests/test_calc.py shisei.oxt

Every example of the table, the wizard's texts, the cell errors, the worked examples from CSV files. Prints a line
a test; exits with 1 when one failed.
"""
import csv
import json
import math
import pathlib
import sys
import traceback

from office import Office, pv

ROOT = pathlib.Path(__file__).resolve().parents[3]
EXAMPLES = json.loads((ROOT / "fixtures/functions/examples.json").read_text(encoding="utf-8"))
NUMERIC = [e for e in EXAMPLES if e["expected"] is not None]
NEED_MORE_ROWS = ("GetBiasCalib", "GetIMUCalib", "FitSphere", "AllanDev", "EarthRate")
VALUE, NUM, NA = 502, 503, 32767
BY_REFERENCE = ("IsFiniteQuat", "IsFiniteVec3")


def column(n):
    return (column(n // 26 - 1) if n >= 26 else "") + chr(65 + n % 26)


class Sheet:
    """One sheet; arguments go to the left, results to the right of column 40."""

    def __init__(self, office):
        self.doc = office.new()
        self.sheet = self.doc.Sheets.getByIndex(0)

    def close(self):
        self.doc.close(True)

    def put(self, rows, at):
        """Cells from column `at` on: numbers, text; None stays blank. Returns the range's address."""
        for r, row in enumerate(rows):
            for c, x in enumerate(row):
                cell = self.sheet.getCellByPosition(at + c, r)
                if x is None:
                    cell.setString("")
                    cell.clearContents(1023)
                elif isinstance(x, str) and x.startswith("="):
                    cell.setFormula(x)
                elif isinstance(x, str):
                    cell.setString(x)
                else:
                    cell.setValue(x)
        return "%s1:%s%d" % (column(at), column(at + len(rows[0]) - 1), len(rows))

    def formula(self, name, args):
        """The formula of a call; ranges are written into the sheet."""
        self.sheet.clearContents(1023)
        parts, at = [], 0
        for a in args:
            if isinstance(a, list):
                parts.append(self.put(a, at))
                at += len(a[0]) + 1
            else:
                parts.append("" if a is None else a if isinstance(a, str) else repr(float(a)))
        return "=%s(%s)" % (name, ";".join(parts))

    def result(self, formula, rows=1, cols=1):
        """(values, errors) of the formula as an array formula over rows × cols cells."""
        cells = self.sheet.getCellRangeByName("%s1:%s%d" % (column(40), column(39 + cols), rows))
        if rows == cols == 1:
            cells.getCellByPosition(0, 0).setFormula(formula)
        else:
            cells.setArrayFormula(formula)
        each = [[cells.getCellByPosition(c, r) for c in range(cols)] for r in range(rows)]
        return [[x.Value for x in row] for row in each], {x.getError() for row in each for x in row}

    def error(self, name, args):
        return self.result(self.formula(name, args))[1]


def shape_of(e):
    if isinstance(e["expected"], bool):
        return 1, 1
    return len(e["expected"]), len(e["expected"][0])


def expected(e):
    return [[float(e["expected"])]] if isinstance(e["expected"], bool) else e["expected"]


def close_to(got, want, tolerance, what):
    for g, w in zip(got, want):
        for a, b in zip(g, w):
            assert abs(a - b) <= tolerance, "%s: %r, expected %r" % (what, a, b)


def every_example(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        for name in (e["name"], "_xll." + e["name"]):
            values, errors = sheet.result(sheet.formula(name, e["args"]), *shape_of(e))
            assert errors == {0}, (name, errors)
            close_to(values, expected(e), e["tolerance"], name)
    sheet.close()


def results_work_inside_other_functions(office):
    sheet = Sheet(office)
    sheet.put([[1.0, 0.0, 0.0, 0.0], [0.9, 0.1, -0.3, 0.3]], 0)
    assert sheet.result("=SUM(ConjugateQuat(A1:D1))") == ([[1.0]], {0})
    values, _ = sheet.result("=INDEX(Quats2Yprs(A1:D2);2;1)")
    close_to(values, [[0.6435011087932843]], 1e-12, "INDEX")
    values, _ = sheet.result("=SUMPRODUCT(Quat2WorldQuat(NormalizeQuat(A2:D2);A2:D2))")
    close_to(values, [[1.0]], 1e-15, "nested")
    sheet.close()


def wizard_texts_in_both_languages(office):
    provider = office.make("com.sun.star.configuration.ConfigurationProvider")
    table = json.loads((ROOT / "apps/calc/extension/table.json").read_text(encoding="utf-8"))
    node = "/org.openoffice.Office.CalcAddIns/AddInInfo/org.shisei.sheet.ShiseiImpl/AddInFunctions"
    for locale, sample in (("en-US", "Mean of each axis"), ("ja", "各軸の平均")):
        access = provider.createInstanceWithArguments("com.sun.star.configuration.ConfigurationAccess",
                                                      (pv("nodepath", node), pv("Locale", locale)))
        assert sample in access.getByName("vec3Mean").getPropertyValue("Description")
        for f in table["functions"]:
            entry = access.getByName(f["methods"][0])
            assert entry.getPropertyValue("DisplayName") == f["name"]
            assert entry.getPropertyValue("Description")
            for arg, _, _ in f["args"]:
                parameter = entry.getPropertyValue("Parameters").getByName(arg)
                assert parameter.getPropertyValue("DisplayName") and parameter.getPropertyValue("Description")
    for f in table["functions"]:
        shown = office.function_description(f["name"])
        arguments = shown["Arguments"] or ()
        assert [a.Name for a in arguments].count("###") == 0, (f["name"], shown)
        assert len(arguments) == len(f["args"]), f["name"]


def kinds(e):
    """(index, shape words) of every argument the example gives."""
    return [(i, s.split()) for i, s in enumerate(e["arg_shapes"][:len(e["args"])])]


def changed(e, i, value):
    args = list(e["args"])
    args[i] = value
    return args


def text_and_blank_cells(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        for i, shape in kinds(e):
            if shape[0] == "number":
                assert sheet.error(e["name"], changed(e, i, '"abc"')) == {VALUE}, (e["name"], i)
                continue
            for bad in ("abc", None):
                rows = [list(r) for r in e["args"][i]]
                rows[0][-1] = bad
                assert sheet.error(e["name"], changed(e, i, rows)) == {VALUE}, (e["name"], i, bad)
                sentence = sheet.result("=ShiseiLastError()")
                text = sheet.sheet.getCellByPosition(40, 0).String
                column_number = str(len(rows[0]))
                assert e["name"] in text and "row 1" in text and column_number in text, (text, sentence)
    sheet.close()


def wrong_shapes(office):
    sheet = Sheet(office)
    square = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for e in NUMERIC:
        for i, shape in kinds(e):
            if shape[0] == "number" or shape[:2] == ["series", "3"]:
                continue
            assert sheet.error(e["name"], changed(e, i, square)) == {VALUE}, (e["name"], i)
    sheet.close()


def no_rows_and_one_row(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        series = [i for i, s in kinds(e) if s[0] == "series"]
        for i in series:
            blank = [[None] * len(e["args"][i][0])] * 2
            assert sheet.error(e["name"], changed(e, i, blank)) == {VALUE}, (e["name"], i)
        if not series:
            continue
        one = [a[:1] if i in series else a for i, a in enumerate(e["args"])]
        got = sheet.error(e["name"], one)
        # one row has no six faces, no sphere and no deviation; all others take it
        assert got == ({NA} if e["name"] in NEED_MORE_ROWS else {0}), (e["name"], got)
    sheet.close()


def blank_rows_at_the_end_are_dropped(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        for i, shape in kinds(e):
            if shape[0] != "series" or sum(s[0] == "series" for _, s in kinds(e)) > 1:
                continue
            longer = e["args"][i] + [[None] * len(e["args"][i][0])] * 3
            values, errors = sheet.result(sheet.formula(e["name"], changed(e, i, longer)), *shape_of(e))
            assert errors == {0}, (e["name"], errors)
            close_to(values, expected(e), e["tolerance"], e["name"])
    sheet.close()


def zero_quaternions(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        for i, shape in kinds(e):
            if shape[-1] != "4" or shape[0] == "number":
                continue
            want = {0} if e["name"] in ("ConjugateQuat", "IsFiniteQuat") else {NUM}
            assert sheet.error(e["name"], changed(e, i, [[0.0, 0.0, 0.0, 0.0]])) == want, e["name"]
    sheet.close()


def out_of_domain(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        for i, name in enumerate(e["arg_names"][:len(e["args"])]):
            bad = {"dt": [0.0, -0.01], "gravity": [0.0], "varThreshold": [-1.0], "kp": [-1.0], "ki": [-1.0],
                   "windowSec": [0.0], "kpMin": [99.0], "accelUpperStart": [99.0]}.get(name, [])
            for value in bad:
                assert sheet.error(e["name"], changed(e, i, value)) == {NUM}, (e["name"], name, value)
    assert sheet.error("AxisAngle2Quat", [0.0, 0.0, 0.0, 1.0]) == {NUM}
    sheet.close()


def conditions_not_met(office):
    sheet = Sheet(office)
    by_name = {e["name"]: e for e in EXAMPLES}
    still = by_name["Accs2InitialQuat"]
    assert sheet.error("Accs2InitialQuat", changed(still, 1, 1e-9)) == {NA}
    assert sheet.result(sheet.formula("IsAccStable", changed(still, 1, 1e-9))) == ([[0.0]], {0})
    for name in ("GetBiasCalib", "GetIMUCalib"):
        six = by_name[name]
        assert sheet.error(name, changed(six, 0, six["args"][0][:8])) == {NA}
        sheet.result("=ShiseiLastError()")
        assert "up was found" in sheet.sheet.getCellByPosition(40, 0).String
        assert sheet.error(name, changed(six, 7, 0.999)) == {NA}
    values, errors = sheet.result(sheet.formula("CalibFaces", [by_name["GetIMUCalib"]["args"][0][:4], 0.5, 2.0, 0.5]), 6, 5)
    assert [r[0] for r in values] == [1, 0, 0, 0, 0, 0] and errors == {0, NA}, (values, errors)
    sheet.close()


def error_cells(office):
    """Calc itself answers for an array with an error cell; a reference gives FALSE."""
    sheet = Sheet(office)
    for name, n in (("IsFiniteQuat", 4), ("IsFiniteVec3", 3)):
        for bad in ("=1/0", "=NA()"):
            row = [1.0] * (n - 1) + [bad]
            assert sheet.result(sheet.formula(name, [[row]])) == ([[0.0]], {0}), name
    for e in NUMERIC:
        for i, shape in kinds(e):
            if shape[0] == "number" or e["name"] in BY_REFERENCE:
                continue
            rows = [list(r) for r in e["args"][i]]
            rows[-1][0] = "=1/0"
            assert 0 not in sheet.error(e["name"], changed(e, i, rows)), e["name"]
    sheet.close()


def missing_arguments(office):
    sheet = Sheet(office)
    for e in NUMERIC:
        if e["required"] and e["arg_shapes"][e["required"] - 1] == "number":
            args = e["args"][:e["required"] - 1]
            assert sheet.error(e["name"], args) == {VALUE}, e["name"]
    sheet.close()


def version_and_last_error(office):
    sheet = Sheet(office)
    sheet.result("=ShiseiVersion()")
    table = json.loads((ROOT / "apps/calc/extension/table.json").read_text(encoding="utf-8"))
    assert sheet.sheet.getCellByPosition(40, 0).String == table["version"]
    sheet.close()


CSV_FILTER = {"FilterName": "Text - txt - csv (StarCalc)", "FilterOptions": "44,34,76,1,,1033,false,true",
              "AsTemplate": True}  # a copy, for the office may run as a user who cannot write the file
HEAD = ["Time", "Ax[m/s2]", "Ay[m/s2]", "Az[m/s2]", "Gx[rad/s]", "Gy[rad/s]", "Gz[rad/s]", "Temp"]


def published(name):
    with open(ROOT / "fixtures/published" / name, encoding="utf-8") as f:
        return [[float(x) for x in row[1:]] for row in list(csv.reader(f))[1:]]


def opened_csv(office, name, rows):
    path = pathlib.Path(office.dir, name)
    with open(path, "w", newline="", encoding="utf-8") as f:
        csv.writer(f).writerows([HEAD, *rows])
    return office.open(str(path), **CSV_FILTER)


def first_worked_example(office):
    """Rows 301–315 as printed; the start is moved within its own rounding, as its digits allow."""
    rows = published("pelvis_rows.csv")
    body = [["31:27.8", *rows[0][:6], 4095]] * 299 + [["31:30.8", *r[:6], 4095] for r in rows]
    doc = opened_csv(office, "pelvis_rows.csv", body)
    sheet = doc.Sheets.getByIndex(0)
    assert sheet.getCellRangeByName("B303").Value == 9.696517
    start = sheet.getCellRangeByName("I301:L301")
    series = sheet.getCellRangeByName("I302:L315")
    series.setArrayFormula("=UpdateQuatsByMahony(I301:L301;E302:G315;B302:D315;0.01;2;0;9.80665)")
    half = (5e-7, 5e-7, 5e-6)

    def worst_at(shares):
        w, x, y = (p + s * h for p, s, h in zip(rows[0][6:9], shares, half))
        z = math.sqrt(1 - w * w - x * x - y * y)
        if abs(z - 0.673724) > 5e-7 or max(map(abs, shares)) > 1:
            return math.inf
        start.setDataArray(((w, x, y, z),))
        return max(abs(g[k] - r[6 + k]) / half[k] for g, r in zip(series.getDataArray(), rows[1:]) for k in range(3))

    centre, width = (0.0, 0.0, 0.0), 1.0
    for _ in range(4):  # a grid, then finer ones about the best
        around = [tuple(c + width * k / 3 for c, k in zip(centre, (i, j, l)))
                  for i in range(-3, 4) for j in range(-3, 4) for l in range(-3, 4)]
        centre = min(around, key=worst_at)
        width /= 2.5
    best = worst_at(centre)
    assert best <= 1.0, "%r half units of print" % best
    ypr = sheet.getCellRangeByName("M301:O315")
    ypr.setArrayFormula("=Quats2WorldYprs(I301:L315;I301:L301)")
    assert max(abs(x) for x in ypr.getDataArray()[0]) < 1e-15, "the start is the reference"
    doc.close(True)


def second_worked_example(office):
    rows = published("calibrated_rows.csv")
    doc = opened_csv(office, "calibrated.csv", [["00:48.2", *r[:6], 4095] for r in rows])
    sheet = doc.Sheets.getByIndex(0)
    sheet.getCellRangeByName("I1:T1").setDataArray(((-0.0272, -0.07121, 0.106377, 0.999356, 0.999585, 0.999567,
                                                     0.006784, 0.009346, 0.008648, 1.0, 1.0, 1.0),))
    out = sheet.getCellRangeByName("I2:N11")
    out.setArrayFormula("=ApplyIMUCalib(B2:G11;I1:T1)")
    close_to(out.getDataArray(), [r[6:] for r in rows], 1.1e-5, "ApplyIMUCalib")
    doc.close(True)


def formulas_as_printed_on_the_example_files(office):
    doc = office.open(str(ROOT / "examples/pelvis.csv"), **CSV_FILTER)
    sheet = doc.Sheets.getByIndex(0)
    sheet.getCellRangeByName("I301:L301").setArrayFormula("=Accs2InitialQuat(B2:D301;0.02;9.6;10)")
    sheet.getCellRangeByName("I302:L1672").setArrayFormula(
        "=UpdateQuatsByMahony(I301:L301;E302:G1672;B302:D1672;0.01;2;0;9.80665)")
    ypr = sheet.getCellRangeByName("M301:O1672")
    ypr.setArrayFormula("=Quats2WorldYprs(I301:L1672;I301:L301)")
    quats = sheet.getCellRangeByName("I301:L1672").getDataArray()
    assert all(abs(sum(x * x for x in q) - 1) < 1e-12 for q in quats)
    with open(ROOT / "examples/pelvis.truth.csv", encoding="utf-8") as f:
        truth = list(csv.DictReader(f))
    assert len(truth) >= 1671
    first, worst = None, 0.0
    for row, q in zip(truth[299:1671], quats):
        t = [float(row[k]) for k in ("q_w", "q_x", "q_y", "q_z")]
        # tilt: where both attitudes put the vertical in sensor axes
        dot = sum(a * b for a, b in zip(up(t), up(q)))
        worst = max(worst, math.acos(max(-1.0, min(1.0, dot))))
    assert math.degrees(worst) < 2.0, "tilt is off by %.2f degrees" % math.degrees(worst)
    assert max(abs(x) for row in ypr.getDataArray() for x in row) > 0.3, "nothing moved"
    doc.close(True)

    doc = office.open(str(ROOT / "examples/six-face.csv"), **CSV_FILTER)
    sheet = doc.Sheets.getByIndex(0)
    sheet.getCellRangeByName("I1:T1").setArrayFormula("=GetIMUCalib(B2:G9241;0.01)")
    got = sheet.getCellRangeByName("I1:T1").getDataArray()[0]
    truth = json.loads((ROOT / "examples/six-face.truth.json").read_text(encoding="utf-8"))
    acc, gyro = truth["accelerometer"], truth["gyroscope"]
    close_to([got[0:3], got[3:6], got[6:9]],
             [acc["bias_m_s2"], [acc["matrix"][k][k] for k in range(3)], gyro["bias_rad_s"]], 0.005, "GetIMUCalib")
    sheet.getCellRangeByName("I2:N9241").setArrayFormula("=ApplyIMUCalib(B2:G9241;I1:T1)")
    assert sheet.getCellRangeByName("N9241").getError() == 0
    doc.close(True)


def up(q):
    w, x, y, z = q
    return 2 * (x * z - w * y), 2 * (w * x + y * z), w * w - x * x - y * y + z * z


def the_vba_module_compiles(office):
    """LibreOffice's Basic reads VBA too: the helpers of shisei.bas run, so the module has no mistake of syntax."""
    text = (ROOT / "crates/shisei-capi/vba/shisei.bas").read_text(encoding="ascii")
    text = "\n".join(line for line in text.splitlines() if not line.startswith("Attribute"))
    probes = """
Function ProbeOut() As Variant
    Dim r(0 To 3) As Double
    r(0) = 1: r(3) = 4
    ProbeOut = FromCells(4, r, 2, 2, KIND_NUMBERS)
End Function
Function ProbeIn() As Variant
    Dim g(1 To 3, 1 To 2) As Variant, c() As Double, rows As Long, cols As Long, failed As Variant
    g(1, 1) = 1: g(1, 2) = 2: g(2, 1) = 3: g(2, 2) = 4
    If ToCells(g, c, rows, cols, failed) Then ProbeIn = rows & " " & cols & " " & c(0) & c(1) & c(2) & c(3)
End Function
"""
    doc = office.new()
    doc.BasicLibraries.VBACompatibilityMode = True
    libraries = doc.BasicLibraries
    library = libraries.getByName("Standard") if libraries.hasByName("Standard") else libraries.createLibrary("Standard")
    library.insertByName("shisei_vba", "Option VBASupport 1\n" + text + probes)

    def run(name):
        uri = "vnd.sun.star.script:Standard.shisei_vba.%s?language=Basic&location=document" % name
        return doc.getScriptProvider().getScript(uri).invoke((), (), ())[0]

    assert run("ProbeOut") == ((1.0, 0.0), (0.0, 4.0)), run("ProbeOut")
    assert run("ProbeIn") == "2 2 1234", run("ProbeIn")
    doc.close(True)


TESTS = [every_example, results_work_inside_other_functions, wizard_texts_in_both_languages, text_and_blank_cells,
         wrong_shapes, no_rows_and_one_row, blank_rows_at_the_end_are_dropped, zero_quaternions, out_of_domain,
         conditions_not_met, error_cells, missing_arguments, version_and_last_error, first_worked_example,
         second_worked_example, formulas_as_printed_on_the_example_files, the_vba_module_compiles]


def main(oxt, *names):
    failed = ran = 0
    with Office(oxt) as office:
        print("LibreOffice", office.version())
        for test in TESTS:
            if names and test.__name__ not in names:
                continue
            try:
                ran += 1
                test(office)
                print("ok     ", test.__name__, flush=True)
            except Exception:
                failed += 1
                print("FAILED ", test.__name__, flush=True)
                traceback.print_exc()
    print("%d tests, %d failed" % (ran, failed))
    return 1 if failed or not ran else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
