"""Builds shisei.oxt: python3 apps/calc/build.py OUT.oxt PLATFORM=LIBRARY …

PLATFORM is linux-x86_64, linux-arm64, windows-x86_64, macos-x86_64 or macos-arm64; the extension carries each
library it is given. Needs unoidl-write (libreoffice-dev).
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OFFICE = pathlib.Path(os.environ.get("LIBREOFFICE", "/usr/lib/libreoffice"))
PLATFORMS = {"linux-x86_64": "libshisei.so", "linux-arm64": "libshisei.so", "windows-x86_64": "shisei.dll",
             "macos-x86_64": "libshisei.dylib", "macos-arm64": "libshisei.dylib"}
STAMP = (2026, 1, 1, 0, 0, 0)  # the same bytes from the same input


def types_rdb(out):
    program = OFFICE / "program"
    subprocess.run([OFFICE / "sdk/bin/unoidl-write", program / "types.rdb", program / "types/offapi.rdb",
                    HERE / "idl/XShisei.idl", out], check=True, env={**os.environ, "LD_LIBRARY_PATH": str(program)})


def main(out, *libraries):
    with tempfile.TemporaryDirectory() as tmp:
        rdb = pathlib.Path(tmp, "types.rdb")
        types_rdb(rdb)
        files = {"types.rdb": rdb, "LICENSE-MIT": ROOT / "LICENSE-MIT", "LICENSE-APACHE": ROOT / "LICENSE-APACHE"}
        files.update({str(p.relative_to(HERE / "extension")): p for p in (HERE / "extension").rglob("*")
                      if p.is_file() and "__pycache__" not in p.parts})
        for spec in libraries:
            platform, path = spec.split("=", 1)
            files["lib/%s/%s" % (platform, PLATFORMS[platform])] = pathlib.Path(path)
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for name in sorted(files):
                info = zipfile.ZipInfo(name, STAMP)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                archive.writestr(info, files[name].read_bytes())
    print("wrote", out)


if __name__ == "__main__":
    main(*sys.argv[1:])
