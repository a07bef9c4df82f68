"""The OpenDocument versions of the sample workbooks: python3 apps/calc/make_samples.py shisei.oxt FOLDER

Opens each .xlsx of FOLDER in a LibreOffice that has the extension, enters the formulas of formulas.json as Calc
takes them, checks that every value is what the workbook said, and stores the .ods beside it.
"""
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "tests"))
from office import Office, pv  # noqa: E402


def enter(sheet, f):
    cells = sheet.getCellRangeByPosition(f["col"], f["row"], f["col"] + f["cols"] - 1, f["row"] + f["rows"] - 1)
    before = cells.getDataArray()
    cells.clearContents(1023 & ~32)  # all but the formats
    formula = f["formula"].replace("'Six faces'!", "$'Six faces'.")
    if f["rows"] == f["cols"] == 1:
        cells.getCellByPosition(0, 0).setFormula(formula)
    else:
        cells.setArrayFormula(formula)
    return cells, before, formula


def agrees(cells, before):
    for old_row, new_row in zip(before, cells.getDataArray()):
        for old, new in zip(old_row, new_row):
            numbers = isinstance(old, float) and isinstance(new, float)
            if numbers and not math.isclose(old, new, rel_tol=1e-12, abs_tol=1e-12):
                return False
    return all(cells.getCellByPosition(0, r).getError() == 0 for r in range(cells.Rows.Count))


def main(oxt, folder):
    folder = pathlib.Path(folder)
    formulas = json.loads((folder / "formulas.json").read_text(encoding="utf-8"))
    with Office(oxt) as office:
        for name in sorted({f["file"] for f in formulas}):
            doc = office.open(str(folder / name), AsTemplate=True)
            entered = [enter(doc.Sheets.getByName(f["sheet"]), f) for f in formulas if f["file"] == name]
            doc.calculateAll()
            for cells, before, formula in entered:
                assert agrees(cells, before), (name, formula)
            out = pathlib.Path(office.dir, name).with_suffix(".ods")
            doc.storeToURL("file://" + str(out), (pv("FilterName", "calc8"),))
            doc.close(True)
            (folder / out.name).write_bytes(out.read_bytes())
            print("wrote", folder / out.name, "with", len(entered), "formulas")


if __name__ == "__main__":
    main(*sys.argv[1:])
