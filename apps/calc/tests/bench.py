"""Speed of the functions in Calc against Calc's own array formula: python3 apps/calc/tests/bench.py shisei.oxt [ROWS]

Prints the ratio of the two times, each the best of several runs taken in turn; exits with 1 above the limit.
"""
import math
import sys
import time

from office import Office

LIMIT = 2.5
RUNS = 5


def seconds(sheet, cells, formula, last):
    """From entering the formula until the last value is there."""
    target = sheet.getCellRangeByName(cells)
    target.clearContents(1023)
    started = time.perf_counter()
    target.setArrayFormula(formula)
    value = sheet.getCellRangeByName(last).Value
    assert math.isfinite(value) and value != 0
    return time.perf_counter() - started


def main(oxt, rows=100_000):
    rows = int(rows)
    end = rows + 1
    with Office(oxt) as office:
        doc = office.new()
        sheet = doc.Sheets.getByIndex(0)
        sheet.getCellRangeByName("A1:D1").setDataArray(((1.0, 0.0, 0.0, 0.0),))
        sheet.getCellRangeByName("B2:G%d" % end).setDataArray(tuple(
            (0.3 * math.sin(i * 0.1), 0.02, 9.8, 0.1, 0.2 * math.cos(i * 0.05), 0.01) for i in range(rows)))
        own, ours = [], []
        for _ in range(RUNS):
            # as many cells: E:G is three columns, and D one more
            own.append(seconds(sheet, "S2:V%d" % end, "=D2:G%d*1" % end, "V%d" % end))
            ours.append(seconds(sheet, "I2:L%d" % end,
                                "=UpdateQuatsByMahony(A1:D1;E2:G%d;B2:D%d;0.01;2;0)" % (end, end), "L%d" % end))
        doc.close(True)
    ratio = min(ours) / min(own)
    print("Calc, %d rows: =D2:G%d*1 %.2f s, UpdateQuatsByMahony %.2f s; ratio %.2f (limit %.1f)"
          % (rows, end, min(own), min(ours), ratio, LIMIT))
    return 0 if ratio <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
