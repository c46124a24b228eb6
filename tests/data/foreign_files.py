"""Writers of maps as instruments and programs write them, cut down to what a reader needs.

Each takes whole numbers ``raw[y, x]`` in units of 1 nm, and options of its kind; the pixel is 2 µm.
"""

import hashlib
import struct
import zipfile
import zlib

import numpy as np

PIXEL = 2e-6


def write_x3p(path, raw, valid=None, **given):
    """`valid` is the mask of the points that have data, all by default."""
    kind = {
        "revision": "ISO5436 - 2000",
        "folder": "",
        "link": "bindata/data.bin",
        "member": "bindata/data.bin",
        "listed": "",
        "axis": "A",
        "type": "D",
        "increment": "",
        "pixel": "2e-6",
        "prefix": "p:",
        "md5": None,
        "main_md5": None,
        "feature": "SUR",
    } | given
    factor = float(kind["increment"].replace(",", ".") or 1.0) or 1.0
    points = (
        np.round(raw * 1e-9 / factor, 12).astype({"D": "<f8", "F": "<f4", "I": "<i2"}[kind["type"]]).tobytes()
    )
    md5 = kind["md5"] if kind["md5"] is not None else hashlib.md5(points).hexdigest().upper()
    if kind["listed"]:
        data = "".join(f"<Datum>{kind['listed'].format(z * 1e-9)}</Datum>" for z in raw.ravel())
        data = f"<DataList>{data}</DataList>"
    else:
        data = (
            f"<PointDataLink>{kind['link']}</PointDataLink><MD5ChecksumPointData>{md5}</MD5ChecksumPointData>"
        )
        if valid is not None:
            bits = np.packbits(valid.ravel(), bitorder="little").tobytes()
            data += "<ValidPointsLink>bindata/valid.bin</ValidPointsLink><MD5ChecksumValidPoints>"
            data += f"{hashlib.md5(bits).hexdigest().upper()}</MD5ChecksumValidPoints>"
        data = f"<DataLink>{data}</DataLink>"

    def axis(name, kinds, numbers, increment):
        increment = f"<Increment>{increment}</Increment>" if increment else ""
        return f"<C{name}><AxisType>{kinds}</AxisType><DataType>{numbers}</DataType>{increment}</C{name}>"

    prefix = kind["prefix"]
    space = f'xmlns{":" if prefix else ""}{prefix.strip(":")}="http://www.opengps.eu/2008/ISO5436_2"'
    axes = axis("X", "I", "D", kind["pixel"]) + axis("Y", "I", "D", kind["pixel"])
    axes += axis("Z", kind["axis"], kind["type"], kind["increment"])
    first = f"<Revision>{kind['revision']}</Revision><FeatureType>{kind['feature']}</FeatureType>"
    size = f"<SizeX>{raw.shape[1]}</SizeX><SizeY>{raw.shape[0]}</SizeY><SizeZ>1</SizeZ>"
    main = (
        f'<?xml version="1.0" encoding="UTF-8"?><{prefix}ISO5436_2 {space}>'
        f"<Record1>{first}<Axes>{axes}</Axes></Record1>"
        f"<Record3><MatrixDimension>{size}</MatrixDimension>{data}</Record3>"
        f"<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></{prefix}ISO5436_2>"
    ).encode()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{kind['folder']}main.xml", main)
        archive.writestr(f"{kind['folder']}{kind['member']}", points)
        if valid is not None:
            archive.writestr(f"{kind['folder']}bindata/valid.bin", bits)
        main_md5 = kind["main_md5"] or hashlib.md5(main).hexdigest()
        archive.writestr(f"{kind['folder']}md5checksum.hex", f"{main_md5} *main.xml")


def write_bruker(path, raw, size, *, listed=None, aspect="1:1", lines=None, slow="", keys=str):
    """`size` is the size of the image, `listed` are the lines of the scan, and `aspect` is its ratio."""
    ny, nx = raw.shape
    points = raw.astype("<i4").tobytes()
    scan = [
        r"\Scan Size: 2000 nm",
        rf"\Samps/line: {nx}",
        rf"\Lines: {listed or ny}",
        rf"\Aspect Ratio: {aspect}",
    ]
    heading = [
        *(r"\*File list", r"\Version: 0x09400202", r"\Date: 09:00:00 AM Fri Jan 3 2020", r"\*Ciao scan list"),
        *map(keys, scan),
        *([rf"\Slow Axis Size: {slow}"] if slow else []),
        r"\@Sens. ZsensSens: V 100.0 nm/V",
        *(r"\*Ciao image list", r"\Data offset: 4096", rf"\Data length: {len(points)}", r"\Bytes/pixel: 4"),
        *map(keys, (rf"\Samps/line: {nx}", rf"\Number of lines: {lines or ny}", rf"\Scan Size: {size}")),
        *(r"\Aspect Ratio: 1:1", r'\@2:Image Data: S [ZSensor] "Height Sensor"'),
        rf"\@2:Z scale: V [Sens. ZsensSens] (0.0 V/LSB) {256**4 / 100:.9f} V",
        r"\*File list end",
    ]
    path.write_bytes("\r\n".join([*heading, "\x1a"]).encode("latin-1").ljust(4096, b"\0") + points)


def write_sdf(path, raw, *, heading="aISO-1.0", keys=str, data_type=5, gap=None, y_scale=PIXEL):
    ny, nx = raw.shape
    numbers = raw.astype({3: "<f4", 4: "i1", 5: "<i2", 7: "<f8"}[data_type])
    if gap is not None:
        numbers[0, 0] = gap
    if heading.startswith("b"):
        sizes = struct.pack("<II" if "2.0" in heading else "<HH", nx, ny)
        rest = struct.pack("<4d3B", PIXEL, PIXEL, 1e-9, -1.0, 0, data_type, 0)
        path.write_bytes(heading.encode() + b"asperity  " + 24 * b"0" + sizes + rest + numbers.tobytes())
        return
    values = {
        "NumPoints": nx,
        "NumProfiles": ny,
        "Xscale": PIXEL,
        "Yscale": y_scale,
        "Zscale": 1e-9,
        "DataType": data_type,
    }
    lines = [heading, "ManufacID = NPL", *(keys(f"{key} = {value}") for key, value in values.items()), "*"]
    path.write_text("\n".join([*lines, *(" ".join(map(str, row)) for row in numbers), "*"]) + "\n")


def write_tmd(path, raw, comment=b"Created by TrueMap v6\r\n", end=b"\r\n"):
    ny, nx = raw.shape
    heading = b"Binary TrueMap Data File v2.0" + end + b"\0" + comment + b"\0"
    sizes = struct.pack("<2I4f", nx, ny, 1e3 * PIXEL * nx, 1e3 * PIXEL * ny, 0, 0)
    path.write_bytes(heading + sizes + (raw * 1e-6).astype("<f4").tobytes())


def write_sur(path, raw, *, unit=b"\xb5m", z_unit=b"nm", packed=0):
    """Compressed in `packed` streams."""
    ny, nx = raw.shape
    heading = bytearray(512)
    heading[:12] = b"DSCOMPRESSED" if packed else b"DIGITAL SURF"
    struct.pack_into(
        "<HiiiiIfff", heading, 98, 16, int(raw.min()), int(raw.max()), nx, ny, nx * ny, 2.0, 2.0, 1.0
    )
    for start, text in zip(range(180, 276, 16), 2 * (unit, unit, z_unit), strict=True):
        heading[start : start + len(text)] = text
    struct.pack_into("<7H", heading, 306, 0, 0, 0, 1, 1, 2020, 0)
    points = raw.astype("<i2").tobytes()
    if packed:
        half = len(points) // packed
        parts = [points[half * n : half * (n + 1) if n + 1 < packed else None] for n in range(packed)]
        streams = [zlib.compress(part) for part in parts]
        sizes = [number for pair in zip(parts, streams, strict=True) for number in map(len, pair)]
        points = struct.pack(f"<{1 + 2 * packed}I", packed, *sizes) + b"".join(streams)
    path.write_bytes(bytes(heading) + points)


def write_nid(path, channels):
    """`channels` are tuples of name, unit along the first axis, unit of the values, and raw numbers."""
    groups = [f"Gr0-Ch{n}=DataSet-0:{n}" for n in range(len(channels))]
    heading = ["[DataSet]", "Version=2", "GroupCount=1", f"Gr0-Count={len(channels)}", *groups]
    heading += ["[DataSet-Info]", "Date=01-02-2020", "Time=10:00:00"]
    for number, (name, along, unit, raw) in enumerate(channels):
        ny, nx = raw.shape
        heading += [
            f"[DataSet-0:{number}]",
            f"Points={nx}",
            f"Lines={ny}",
            "Frame=Scan forward",
            f"Dim2Name={name}",
        ]
        heading += [f"Dim0Unit={along}", "Dim1Unit=m", f"Dim0Range={nx * PIXEL}", f"Dim1Range={ny * PIXEL}"]
        heading += [f"Dim2Unit={unit}", f"Dim2Range={1e-9 * 2**32:.9e}", f"Dim2Min={-1e-9 * 2**31:.9e}"]
        heading += ["SaveMode=Binary", "SaveBits=32", "SaveSign=Signed", "SaveOrder=Intel"]
    data = b"".join(raw[::-1].astype("<i4").tobytes() for *_, raw in channels)
    path.write_bytes("\r\n".join(heading).encode() + b"\r\n#!" + data)


def write_gwy(path, channels, mask=None):
    """`channels` are tuples of title, unit of edges, unit of heights (empty: none), and raw numbers.

    `mask` marks points of the first of them.
    """

    def component(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + value

    def whole(name, parts):
        content = b"".join(parts)
        return name.encode() + b"\0" + struct.pack("<I", len(content)) + content

    parts, masks = [], [] if mask is None else [("mask", "m", "", mask * 1e9)]
    for number, (title, lateral, unit, raw) in [*enumerate(channels), *((0, entry) for entry in masks)]:
        ny, nx = raw.shape
        numbers = struct.pack("<I", raw.size) + (raw * 1e-9).astype("<f8").tobytes()
        field = [component(name, "i", struct.pack("<i", n)) for name, n in (("xres", nx), ("yres", ny))]
        field += [
            component(name, "d", struct.pack("<d", n * PIXEL)) for name, n in (("xreal", nx), ("yreal", ny))
        ]
        for name, text in (("si_unit_xy", lateral), ("si_unit_z", unit)):
            if text:
                text = component("unitstr", "s", text.encode() + b"\0")
                field.append(component(name, "o", whole("GwySIUnit", [text])))
        field.append(component("data", "D", numbers))
        key = f"/{number}/{'mask' if title == 'mask' else 'data'}"
        parts.append(component(key, "o", whole("GwyDataField", field)))
        parts.append(component(f"{key}/title", "s", title.encode() + b"\0"))
    path.write_bytes(b"GWYP" + whole("GwyContainer", parts))


def write_nms(path, raw, pixel):
    ny, nx = raw.shape
    heading = bytearray(3468)
    struct.pack_into("<2d", heading, 16, 0.0, 65.534)  # µm: a step is 1 nm
    struct.pack_into("<2I2d", heading, 1368, nx, ny, pixel, pixel)
    path.write_bytes(bytes(heading) + raw.astype("<u2").tobytes())


def write_spip(path, raw, void):
    """`void` is the mask of the non-measured points; a matrix of zeros and ones follows the heights."""
    ny, nx = raw.shape
    lines = [f"x-pixels = {nx}", f"y-pixels = {ny}", f"x-length = {2000 * nx}", f"y-length = {2000 * ny}"]
    lines = ["File Format = ASCII", *lines, "z-unit = nm", f"voidpixels = {void.sum()}", "Start of Data:"]
    rows = [" ".join(map(str, row)) for part in (np.where(void, 0, raw), 1 - void) for row in part]
    path.write_text("\n".join([*(f"# {line}" for line in lines), *rows]) + "\n", encoding="ascii")


def write_fringes(path, raw):
    """DATX of Zygo Mx with heights in fringes."""
    import h5py

    word = h5py.string_dtype("ascii")
    link = np.dtype([("Source", word), ("Link", word), ("Destination", word)])
    links = [
        (b"Root", b"Measurement", b"{A}"),
        (b"{A}", b"Surface", b"{B}"),
        (b"{B}", b"Path", b"/M/Surface"),
    ]
    scale = np.dtype([("Category", word), ("BaseUnit", word), ("Parameters", float, (4,))])
    with h5py.File(path, "w") as file:
        file.create_dataset("MetaData", data=np.array(links, dtype=link))
        attributes = file.create_dataset("M/Surface", data=np.where(raw == raw.max(), 1.7e308, raw)).attrs
        attributes["Unit"], attributes["No Data"] = np.array([b"Fringes"], dtype=word), np.array([1.7e308])
        for axis in "XY":
            values = [(b"LateralCat", b"Pixels", [0, PIXEL, 0, 0])]
            attributes[f"{axis} Converter"] = np.array(values, dtype=scale)
        attributes["Z Converter"] = np.array([(b"HeightCat", b"Fringes", [0, 1, 633e-9, 0.5])], dtype=scale)


def write_gsf(path, height, edges, *, units=("m", "m"), padding=0):
    """Heights in the unit of z, edges (y, x) in the unit of x and y; `padding` makes the heading longer."""
    ny, nx = height.shape
    lines = [
        "Gwyddion Simple Field 1.0",
        f"XRes = {nx}",
        f"YRes = {ny}",
        f"XReal = {edges[1]!r}",
        f"YReal = {edges[0]!r}",
    ]
    lines += [f"{key} = {unit}" for key, unit in zip(("XYUnits", "ZUnits"), units, strict=True) if unit]
    heading = "\n".join([*lines, f"Title = {'z' * (padding + 1)}", ""]).encode()
    path.write_bytes(heading + b"\0" * (4 - len(heading) % 4) + height.astype("<f4").tobytes())


def write_esri(path, height, pixel, gap=-9999):
    ny, nx = height.shape
    head = f"ncols {nx}\nnrows {ny}\nxllcorner 0.0\nyllcorner 0.0\ncellsize {pixel}\nNODATA_value {gap}\n"
    rows = (" ".join(f"{gap if np.isnan(z) else z:.9g}" for z in row) for row in height[::-1])
    path.write_text(head + "\n".join(rows) + "\n")


def write_surfer(path, height, pixel, columns=10):
    """Rows are broken after so many numbers, as Surfer does."""
    ny, nx = height.shape
    low, high = np.nanmin(height), np.nanmax(height)
    ends = f"0 {(nx - 1) * pixel}\n0 {(ny - 1) * pixel}\n{low:.9g} {high:.9g}\n"
    numbers = ["1.70141e+38" if np.isnan(z) else f"{z:.9g}" for z in height.ravel()]
    rows = (" ".join(numbers[start : start + columns]) for start in range(0, len(numbers), columns))
    path.write_text(f"DSAA\n{nx} {ny}\n{ends}" + "\n".join(rows) + "\n")


def write_keyence(path, height, pixel_nm):
    """Table of heights in µm of the program of a laser microscope."""
    ny, nx = height.shape
    entries = [
        ("Model", "VK-X200 Series"),
        ("XY Calibration", f"{pixel_nm:.3f}", "nm"),
        ("Output image data", "Height"),
        ("Horizontal", nx),
        ("Vertical", ny),
        ("Unit", "um"),
        (),
        ("Height",),
        *([f"{z:.6f}" for z in row] for row in height),
    ]
    path.write_text("\n".join(",".join(f'"{field}"' for field in entry) for entry in entries) + "\n")


def write_zygo(path, height, pixel):
    """Points with numbers of pixels and heights in µm; the pixel is in m."""
    ny, nx = height.shape
    head = ["Zygo XYZ Data File - Format 1", '1 9 1 0 "Mon Jan 06 09:00:00 2020"', "0 0 0 0 0 0"]
    head += [f"0 0 {nx} {ny}", '""', '""', '""', f"0 0.5 6.328e-07 0 1 10 {pixel:.9g} 1578300000"]
    head += [f'{nx} {ny} 5 0 0 0 "10X"', *(3 * ["0 0 0 0 0 0"]), '""', "#"]
    rows = [
        f"{x} {y} {'No Data' if np.isnan(height[y, x]) else f'{height[y, x]:.9g}'}"
        for y in range(ny)
        for x in range(nx)
    ]
    path.write_text("\n".join([*head, *rows, "#"]) + "\n")
