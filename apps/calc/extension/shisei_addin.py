"""shisei's functions for LibreOffice Calc: cells to arrays, arrays to the C library, results to cells.

The functions come from table.json; this file holds no formula. It runs on the Python that LibreOffice brings
(3.8 and later, standard library only).

Errors leave as NaN with Calc's error code in the low bits, as Calc itself keeps them: every cell of an array
formula then shows the same code.
"""
import array
import ctypes
import json
import os
import platform
import struct
import sys

import uno
import unohelper
from com.sun.star.beans import PropertyValue
from com.sun.star.lang import XServiceInfo, XServiceName

from org.shisei.sheet import XShisei

IMPLEMENTATION = "org.shisei.sheet.ShiseiImpl"
SERVICE = "org.shisei.sheet.Shisei"
HERE = os.path.dirname(os.path.abspath(uno.fileUrlToSystemPath(__file__) if __file__.startswith("file:") else __file__))

D, I, P = ctypes.c_double, ctypes.c_int32, ctypes.POINTER(ctypes.c_double)
NAN = float("nan")


def calc_error(code):
    return struct.unpack("<d", struct.pack("<Q", 0x7FF8 << 48 | code))[0]


ILLEGAL_ARGUMENT, ILLEGAL_NUMBER, NOT_AVAILABLE = calc_error(502), calc_error(503), calc_error(0x7FFF)
BY_CODE = {-1: ILLEGAL_ARGUMENT, -2: ILLEGAL_NUMBER, -3: NOT_AVAILABLE, -4: ILLEGAL_ARGUMENT, -5: ILLEGAL_ARGUMENT}


class Refused(Exception):
    """An argument that never reaches the library; its sentence in both languages."""


def load_library():
    machine = {"AMD64": "x86_64", "x64": "x86_64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
    system, name = {"win32": ("windows", "shisei.dll"), "darwin": ("macos", "libshisei.dylib")}.get(
        sys.platform, ("linux", "libshisei.so"))
    return ctypes.CDLL(os.path.join(HERE, "lib", system + "-" + machine, name))


with open(os.path.join(HERE, "table.json"), encoding="utf-8") as _file:
    TABLE = json.load(_file)
LIBRARY = load_library()
LIBRARY.shisei_last_error.argtypes = [ctypes.c_char_p, I, ctypes.c_char_p]
LATEST = {"en": "", "ja": ""}


def refuse(key, **places):
    raise Refused({lang: text.format(**places) for lang, text in TABLE[key].items()})


def cells(value, arg):
    """A range to (numbers, rows, cols): wholly blank rows at the end are dropped, all other cells are numbers."""
    rows, cols = len(value), len(value[0]) if value else 0
    blank = ("",) * cols
    while rows and tuple("" if x is None else x for x in value[rows - 1]) == blank:
        rows -= 1
    try:
        return array.array("d", [x for row in value[:rows] for x in row]), rows, cols
    except TypeError:
        for r, row in enumerate(value):
            for c, x in enumerate(row):
                if not isinstance(x, (int, float)):
                    refuse("blank" if x is None or x == "" else "text", arg=arg, row=r + 1, col=c + 1)
        raise


def referenced(reference):
    """The cells of a reference; an error cell becomes NaN."""
    values = reference.getDataArray()
    error = any(reference.getCellByPosition(c, r).getError() for r in range(len(values)) for c in range(len(values[0])))
    return tuple((NAN,) * len(row) for row in values) if error else values


def number(value, arg, optional):
    """A scalar; a single cell serves."""
    while isinstance(value, tuple):
        if len(value) != 1:
            refuse("text", arg=arg, row=1, col=1)
        value = value[0]
    if value is None or value == "":
        if optional and value is None:
            return NAN
        refuse("missing", arg=arg)
    if not isinstance(value, (int, float)):
        refuse("text", arg=arg, row=1, col=1)
    return float(value)


def make(entry):
    name, (kind, size), args = entry["name"], entry["returns"], entry["args"]
    if kind == "sentence":
        return (lambda self: TABLE["version"]) if name == "ShiseiVersion" else (lambda self: LATEST[self.lang])
    function = getattr(LIBRARY, entry["export"])
    function.argtypes = [t for _, k, _ in args for t in ([D] if k == "number" else [P, I, I])] + [P, I]

    def shape(ranges):
        if kind == "row":
            return 1, size
        if kind == "series":
            # the series comes first, or after the initial attitude
            rows = [r for (_, r, c), a in zip(ranges, [a for a in args if a[1] == "range"]) if a[0] != "qInitial"]
            return rows[0], size
        if kind == "rows":  # at most
            return ranges[0][1], size
        if kind == "first":
            return ranges[0][1], ranges[0][2]
        return (1, 1) if kind == "number" else divmod(size, 1000)

    def call(self, *values):
        code = -1  # what this file refuses itself is a matter of shape
        try:
            passed, ranges = [], []
            for (arg, arg_kind, optional), value in zip(args, values):
                if arg_kind == "number":
                    passed.append(number(value, arg, optional))
                else:
                    ranges.append(cells(referenced(value) if entry["not_finite"] else value, arg))
                    numbers, rows, cols = ranges[-1]
                    passed += [ctypes.cast(numbers.buffer_info()[0], P), rows, cols]
            rows, cols = shape(ranges)
            out = array.array("d", bytes(8 * max(rows * cols, 1)))
            code = function(*passed, ctypes.cast(out.buffer_info()[0], P), len(out))
            if code < 0:
                raise Refused({lang: last_error(lang) for lang in LATEST})
        except Refused as refused:
            sentences = refused.args[0]
            LATEST.update({k: v if v.startswith(name) else name + ": " + v for k, v in sentences.items()})
            return BY_CODE[code] if kind == "number" else ((BY_CODE[code],),)
        if kind == "number":
            return out[0]
        if kind == "table":
            flat = iter([NOT_AVAILABLE if x != x else x for x in out])
        else:
            flat = iter(out[:code] if kind == "rows" else out)
        return tuple(zip(*[flat] * cols))

    return call


def last_error(lang):
    text = ctypes.create_string_buffer(2048)
    LIBRARY.shisei_last_error(text, len(text), lang.encode())
    return text.value.decode("utf-8", "replace")


def user_language(ctx):
    """The language of the program's windows."""
    try:
        provider = ctx.ServiceManager.createInstanceWithContext("com.sun.star.configuration.ConfigurationProvider", ctx)
        path = PropertyValue()
        path.Name, path.Value = "nodepath", "/org.openoffice.Setup/L10N"
        access = provider.createInstanceWithArguments("com.sun.star.configuration.ConfigurationAccess", (path,))
        return "ja" if access.getPropertyValue("ooLocale").startswith("ja") else "en"
    except Exception:  # the configuration is not ours; English then
        return "en"


class Shisei(unohelper.Base, XShisei, XServiceName, XServiceInfo):
    def __init__(self, ctx):
        self.lang = user_language(ctx)

    def getServiceName(self):
        return SERVICE

    def getImplementationName(self):
        return IMPLEMENTATION

    def supportsService(self, name):
        return name == SERVICE

    def getSupportedServiceNames(self):
        return (SERVICE,)


for _entry in TABLE["functions"]:
    for _method in _entry["methods"]:
        setattr(Shisei, _method, make(_entry))

g_ImplementationHelper = unohelper.ImplementationHelper()
g_ImplementationHelper.addImplementation(Shisei, IMPLEMENTATION, (SERVICE,))
