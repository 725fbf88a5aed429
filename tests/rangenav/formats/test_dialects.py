"""Tables as spreadsheets, pandas and other tools write them: the same numbers whatever the dialect, and it is said."""

import csv
import gzip
import io

import numpy as np
import pytest

from rangenav import formats
from rangenav.formats import text
from tests.support.present import present
from tests.support.refusals import exactly

NAMES = ("t", "p_x", "p_y", "p_z")
VALUES = np.array([[0.0, 1.5, -0.25, 1e-6], [0.02, 1.25, 3.0, -2.5], [0.04, 1.0, 7.125, np.nan], [0.06, 0.5, 2.0, 4.0]])


def written(separator=",", decimal=".", quoted=False, names=NAMES, end="\n", before=""):
    """The table as Python's own writer of CSV files writes it."""
    out = io.StringIO()
    writer = csv.writer(
        out, delimiter=separator, quoting=csv.QUOTE_ALL if quoted else csv.QUOTE_MINIMAL, lineterminator=end
    )
    writer.writerow(names)
    for row in VALUES.tolist():
        writer.writerow(["" if v != v else repr(v).replace(".", decimal) for v in row])
    return (before + out.getvalue()).encode()


def read(data):
    return text.table(data, source="x.csv")


@pytest.mark.parametrize(
    ("data", "remarks"),
    [
        (written(), ()),
        (written(end="\r\n"), ()),
        (written(";"), ("the entries are separated by semicolons",)),
        (written("\t"), ("the entries are separated by tabs",)),
        (written("|"), ("the entries are separated by vertical bars",)),
        (written(";", ","), ("the entries are separated by semicolons", "the numbers have decimal commas")),
        (written("\t", ","), ("the entries are separated by tabs", "the numbers have decimal commas")),
        (written(",", ","), ("the numbers have decimal commas", "entries stand in quotes")),
        (written(quoted=True), ("entries stand in quotes",)),
        (b"\xef\xbb\xbf" + written(), ("a byte order mark in front",)),
        (
            written("\t").decode().encode("utf-16"),
            ("a byte order mark in front", "the entries are separated by tabs"),
        ),
        (b"# a run\n# " + written(), ("the names of the columns are in the comment on line 2",)),
        (b'# 5" screen\n# ' + written(), ("the names of the columns are in the comment on line 2",)),
        (b"// of a tracker\n%" + written(), ("the names of the columns are in the comment on line 2",)),
        (written().replace(b"\n", b",\n"), ()),
    ],
)
def test_every_dialect_gives_the_same_numbers_and_is_said(data, remarks):
    imported = read(data)
    assert imported.names == NAMES
    np.testing.assert_array_equal(imported.values, VALUES)
    assert imported.remarks == remarks


@pytest.mark.parametrize("header", [",t,p_x,p_y,p_z", "t,p_x,p_y,p_z"])
def test_an_index_column_without_a_name_is_not_used_and_said(header):
    """As pandas writes it, with an empty name, and as R writes it, with a header that is one name shorter."""
    rows = [",".join([str(k), *("" if v != v else repr(v) for v in row)]) for k, row in enumerate(VALUES[:2].tolist())]
    imported = read("\n".join([header, *rows]).encode())
    assert imported.names == NAMES
    np.testing.assert_array_equal(imported.values, VALUES[:2])
    assert imported.remarks == ("column 1 has no name and is not used",)


def test_columns_of_text_are_not_used_and_said_and_a_complaint_shows_one_of_their_entries():
    data = b"%time,frame,x\n09.11.2020 06:41:34,imu,1\n09.11.2020 06:41:35,,2.5\n"
    imported = read(data)
    assert (imported.names, imported.values.tolist()) == (("x",), [[1.0], [2.5]])
    assert imported.remarks[-2:] == (
        "column time holds text and is not used",
        "column frame holds text and is not used",
    )
    said = "x.csv: no column named t; the file's columns are x; text and no numbers in "
    with pytest.raises(ValueError, match=exactly(said + "time ('09.11.2020 06:41:34'), frame ('imu')")):
        text.columns(imported, ("t",))


@pytest.mark.parametrize("form", ["csv", "reference"])
def test_a_path_whose_names_have_si_units_is_read_as_one_whose_names_have_none(form):
    """A unit that is not SI is no part of the format, and the complaint shows it."""
    rows = [f"{k / 50},{k / 50},{(k / 50) ** 2},1" for k in range(60)]
    bare = "\n".join(["t,p_x,p_y,p_z", *rows]).encode()
    named = "\n".join(["t [s],p_x [m],p_y [m],p_z [m]", *rows]).encode()
    read_bare, read_named = (formats.parse(one, form, source="x", confirm={"frame": "z-up"}) for one in (bare, named))
    assert present(read_bare.path) == present(read_named.path)
    with pytest.raises(ValueError, match=r"no column named t; the file's columns are t \[ms\], p_x"):
        formats.parse(named.replace(b"t [s]", b"t [ms]"), form, source="x", confirm={})


@pytest.mark.parametrize(("first", "way"), [(b"ULog\x01\x12\x35", "ulog2csv"), (b"PK\x03\x04", "unpack it")])
def test_a_format_without_text_is_refused_with_the_way_to_a_table(first, way):
    with pytest.raises(ValueError, match=f"x: .* is not read; .*{way}"):
        formats.parse(first + bytes(100), "log", source="x", confirm={})


def test_units_behind_the_names_are_understood():
    header = ",".join(["t_s", *(f"gyro_{a}_deg_s" for a in "xyz"), *(f"acc_{a}_m_s2" for a in "xyz"), "range_mm"])
    rows = [f"{k / 100},0,0,0,0,0,9.81,1500" for k in range(20)]
    confirm = {"frame": "z-up", "gyro": "deg/s", "range": "mm"}
    imported = formats.parse("\n".join([header, *rows]).encode(), "log", source="x.csv", confirm=confirm)
    assert imported.questions == ()
    assert present(imported.flight).range[0] == 1.5


def test_lines_are_counted_with_comments_empty_lines_and_line_breaks_inside_quotes():
    data = b'# front\n"t","note\nof two lines","p_x",\n\n0,1,2\n# between\n1,"3\n",4\n2,5,six\n'
    with pytest.raises(ValueError, match=exactly("x.csv, line 9: p_x must be a number, got 'six'")):
        read(data)
    assert read(data.replace(b"six", b"6")).lines.tolist() == [5, 7, 9]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"0,1,2\n1,2,3\n", "x.csv, line 1: holds numbers, and no line before it names the columns"),
        (b"# only a remark\n0,1,2\n1,2,3\n", "x.csv, line 2: holds numbers, and no line before it names the columns"),
        (b"t;a\n0;1\n1;2;3\n", "x.csv, line 3: 3 entries where 2 columns are named"),
        (b"t;a\n0,5;1,5\n1,5;1.000,5\n", "x.csv, line 3: a must be a number, got '1.000.5'"),
    ],
)
def test_what_is_no_table_is_refused_by_its_line(data, said):
    with pytest.raises(ValueError, match=exactly(said)):
        read(data)


def test_a_quote_that_does_not_close_is_named_by_the_line_where_it_opens():
    with pytest.raises(ValueError, match=r"x\.csv, line 3: quotes that cannot be read"):
        read(b't,a\n0,1\n"1,2\n2,3\n' + b"3,4\n" * 15)


def test_a_complaint_about_a_missing_column_lists_the_columns_that_are_there():
    data = b"time,x,y,z\n0,1,2,3\n1,2,3,4\n2,3,4,5\n"
    with pytest.raises(ValueError, match=exactly("x.csv: no column named t; the file's columns are time, x, y, z")):
        formats.parse(data, "reference", source="x.csv", confirm={})
    with pytest.raises(ValueError, match="no column for gyro x, y, z; the file's columns are time, x, y, z"):
        formats.parse(data, "log", source="x.csv", confirm={})


def test_a_unit_in_an_unknown_spelling_is_asked_and_the_answer_overrules_it():
    names = ["t [s]", *(f"{name} [{unit}]" for name, unit in (("gx", "rpm"), ("gy", "rpm"), ("gz", "rpm")))]
    header = ",".join([*names, *(f"a{axis} [m/s2]" for axis in "xyz")])
    rows = [f"{k / 100},0,0,0,0,0,9.81" for k in range(20)]
    data = "\n".join([header, *rows]).encode()
    (question,) = formats.parse(data, "log", source="x.csv", confirm={"frame": "z-up"}).questions
    assert (question.key, question.flag) == ("gyro", "--gyro-unit")
    assert question.evidence.startswith('the file says "rpm"')
    answered = formats.parse(data, "log", source="x.csv", confirm={"frame": "z-up", "gyro": "deg/s"})
    assert (answered.questions, answered.flight is not None) == ((), True)


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"ULog\x01\x12\x35\x01", "a ULog of PX4"),
        (b"#ROSBAG V2.0\n\x45\x00", "a ROS bag"),
        (b"PK\x03\x04\x14\x00", "a zip archive"),
        (gzip.compress(b"t,gyro_x\n", mtime=0), "a gzip archive"),
        (b"\xa3\x95\x80\x80", "a DataFlash log of ArduPilot"),
    ],
)
def test_a_binary_log_is_named_by_its_first_bytes(data: bytes, kind: str):
    with pytest.raises(ValueError, match=rf"^x\.bin: {kind} is not read; (convert it to CSV|unpack it)"):
        formats.parse(data, "log", source="x.bin", confirm={})


@pytest.mark.parametrize(
    ("format", "row"),
    [
        ("log", "0.0{k},0,0,1,0,0,9.81"),
        ("polynomial", "0.5" + ",1" + 7 * ",0" + 24 * ",0"),
        ("reference", "0.0{k},0.0{k},0,1"),
    ],
)
def test_a_table_without_a_header_is_read_with_the_header_that_the_refusal_names(format: str, row: str):
    rows = "".join(row.format(k=k) + "\n" for k in range(9)).encode()
    rule = r"line 1: holds numbers, and no line before it names the columns; put a header before it: "
    with pytest.raises(ValueError, match=rule) as refused:
        formats.parse(rows, format, source="x.csv", confirm={})
    header = str(refused.value).rpartition("before it: ")[2]
    assert formats.parse(f"{header}\n".encode() + rows, format, source="x.csv", confirm={}).format == format
