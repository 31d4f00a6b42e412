"""Fields are written for others, and their meshes judged later."""

import json
from pathlib import Path

import nrrd
import numpy as np
import pytest
import trimesh
from isograde.adapters import export, open_adapter
from isograde.adapters.directory import fingerprint
from isograde.adapters.protocol import check_json
from isograde.model import CONTOURS, CURVES, AdapterError, Case, Limits, Outcome, Request, Status
from isoref.field import Field
from isoref.methods import METHODS
from scipy.spatial import KDTree

ORIGIN, SPACING = (9.0, 8.0, 7.0), (1.0, 2.0, 3.0)


def ball() -> Field:
    """High in the middle, with a place of its own."""
    i, j, k = np.indices((5, 6, 7))
    values = 4 - (i - 2.1) ** 2 - (j - 2.4) ** 2 - (k - 3.2) ** 2
    return Field.of(values, SPACING, ORIGIN)


CASE = Case("made/ball", ball, (1.0,), 210)
REQUEST = Request("made/ball", "plain", ball(), (1.0,))
MESH = METHODS["asymptotic-decider"](ball(), 1.0)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An exported field and a variant of it."""
    small = Request("made/ball", "as-float32", Field.of(ball().values.astype("f4")), (1.0,))
    assert export(tmp_path / "vectors", [CASE, small]) == 2
    return tmp_path / "vectors"


def ask(folder: Path, request: Request = REQUEST) -> Outcome:
    """What the adapter has for the request."""
    adapter = open_adapter(f"dir:{folder}")
    adapter.open(Limits())
    return adapter.run(request)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl"])
def test_a_mesh_beside_the_field_is_its_answer(folder: Path, suffix: str) -> None:
    trimesh.Trimesh(MESH.vertices, MESH.simplices, process=False).export(
        folder / f"made/ball{suffix}"
    )
    outcome = ask(folder)
    assert outcome.mesh is not None, outcome.detail
    assert len(outcome.mesh.vertices) == len(MESH.vertices)
    assert KDTree(MESH.vertices).query(outcome.mesh.vertices)[0] == pytest.approx(0, abs=1e-5)
    solid = trimesh.Trimesh(outcome.mesh.vertices, outcome.mesh.simplices, process=False)
    assert solid.is_watertight
    assert solid.volume > 0


def test_a_pair_of_arrays_is_an_answer_to_the_last_bit(folder: Path) -> None:
    np.save(folder / "made/ball.vertices.npy", MESH.vertices)
    for name in ("simplices", "faces"):
        np.save(folder / f"made/ball.{name}.npy", MESH.simplices)
        outcome = ask(folder)
        assert outcome.vertices is not None
        assert np.array_equal(outcome.vertices, MESH.vertices)
        (folder / f"made/ball.{name}.npy").unlink()
    np.save(folder / "made/ball.faces.npy", MESH.simplices)
    np.save(folder / "made/ball.simplices.npy", MESH.simplices)
    assert "the same thing twice" in ask(folder).detail


def test_json_beside_the_field_is_its_answer(folder: Path) -> None:
    """As programs answer: rows, polygons, or names of files beside it."""
    said = {"vertices": MESH.vertices.tolist(), "faces": MESH.simplices.tolist()}
    (folder / "made/ball.json").write_text(json.dumps(said))
    outcome = ask(folder)
    assert outcome.vertices is not None, outcome.detail
    assert np.array_equal(outcome.vertices, MESH.vertices)
    (folder / "made/ball.json").write_text(json.dumps({**said, "faces": [[0, 1, 2, 3], [0, 1, 2]]}))
    polygons = ask(folder)
    assert polygons.simplices is not None, polygons.detail
    assert polygons.simplices.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2]]
    for wrong in ("{", "[]", '{"vertices": []}', '{"polylines": []}'):
        (folder / "made/ball.json").write_text(wrong)
        assert ask(folder).status is Status.GARBAGE


def test_every_kind_is_exported_and_answered(tmp_path: Path) -> None:
    """Contours, curves and surfaces in one folder, each with its own answer."""
    plane = Request("plane", "plain", Field.of(np.eye(3)), (0.5,))
    pair = Field.of(np.arange(48.0).reshape(2, 2, 3, 4), dimension=3)
    curves = Request("pair", "plain", pair, (3.0, 25.0))
    assert export(tmp_path / "vectors", [plane, curves, CASE]) == 3
    manifest = json.loads((tmp_path / "vectors/manifest.json").read_text())
    check_json(manifest, "manifest", "the manifest")
    assert [entry["kind"] for entry in manifest["fields"]] == [[2, 1], [3, 2], [3, 1]]
    assert [entry["isovalues"] for entry in manifest["fields"]] == [[0.5], [3.0, 25.0], [1.0]]
    assert {"kind", "values", "vertices", "simplices", "answer"} <= set(manifest["conventions"])
    assert np.load(tmp_path / "vectors/pair.npy").shape == (2, 2, 3, 4)
    lines = {"polylines": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}
    (tmp_path / "vectors/plane.json").write_text(json.dumps(lines))
    np.save(tmp_path / "vectors/pair.vertices.npy", np.eye(3))
    np.save(tmp_path / "vectors/pair.simplices.npy", [[0, 1], [1, 2]])
    adapter = open_adapter(f"dir:{tmp_path / 'vectors'}")
    assert set(adapter.open(Limits()).limits.kinds) == {(2, 1), (3, 1), (3, 2)}
    contour, curve = (adapter.run(one) for one in (plane, curves))
    mesh = contour.mesh_of(CONTOURS)
    assert mesh is not None, contour.detail
    assert mesh.simplices.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert curve.mesh_of(CURVES) is not None, curve.detail
    assert adapter.run(REQUEST).status is Status.DECLINED


def test_what_is_no_field_is_of_no_kind(tmp_path: Path) -> None:
    """A wrong rank, as the claims on bad input pose it, makes a folder of surfaces no other."""
    flat = Request("made/ball", "rank", Field.of(np.eye(3)), (0.5,))
    export(tmp_path / "vectors", [CASE, flat])
    trimesh.creation.box().export(tmp_path / "vectors/made/ball.ply")
    assert open_adapter(f"dir:{tmp_path / 'vectors'}").open(Limits()).limits.kinds == ((3, 1),)


def test_a_declaration_that_names_no_kinds_has_those_of_the_folder(tmp_path: Path) -> None:
    plane = Request("plane", "plain", Field.of(np.eye(3)), (0.5,))
    export(tmp_path / "vectors", [plane])
    (tmp_path / "vectors/plane.json").write_text('{"polylines": []}')
    for said, status in (("{}", Status.OK), ('{"limits": {"kinds": [[3, 1]]}}', Status.DECLINED)):
        (tmp_path / "vectors/declaration.json").write_text(said)
        assert ask(tmp_path / "vectors", plane).status is status


def test_a_mesh_file_is_no_answer_but_for_surfaces(tmp_path: Path) -> None:
    plane = Request("plane", "plain", Field.of(np.eye(3)), (0.5,))
    export(tmp_path / "vectors", [plane])
    trimesh.creation.box().export(tmp_path / "vectors/plane.ply")
    assert "hold surfaces in space, not contours" in ask(tmp_path / "vectors", plane).detail


def test_a_declaration_beside_the_manifest_is_believed(folder: Path) -> None:
    """Turned faces and reversed coordinates in samples come out as the house has them."""
    declared = {"level": 3, "conventions": {"units": "index", "axes": "reversed"}}
    (folder / "declaration.json").write_text(json.dumps(declared))
    index = (MESH.vertices - ORIGIN) / SPACING
    np.save(folder / "made/ball.vertices.npy", index[:, ::-1])
    np.save(folder / "made/ball.faces.npy", MESH.simplices[:, ::-1])
    adapter = open_adapter(f"dir:{folder}")
    assert adapter.open(Limits()).level == 3
    outcome = adapter.run(REQUEST)
    assert outcome.mesh is not None
    assert outcome.mesh.vertices == pytest.approx(MESH.vertices)
    a, b, c = outcome.mesh.vertices[outcome.mesh.simplices].swapaxes(0, 1)
    assert np.einsum("ij,ij->", a - ORIGIN, np.cross(b - a, c - a)) > 0


def test_no_file_is_not_an_empty_mesh(folder: Path) -> None:
    np.save(folder / "made/ball@as-float32.vertices.npy", np.empty((0, 3)))
    np.save(folder / "made/ball@as-float32.faces.npy", np.empty((0, 3), int))
    assert ask(folder).status is Status.DECLINED


def test_other_numbers_under_the_same_name_are_declined(folder: Path) -> None:
    np.save(folder / "made/ball.vertices.npy", MESH.vertices)
    np.save(folder / "made/ball.faces.npy", MESH.simplices)
    moved = Request("made/ball", "plain", ball(), (1.5,))
    assert "export again" in ask(folder, moved).detail
    assert "not exported" in ask(folder, Request("made/ball", "mirror", ball(), (1.0,))).detail


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("ball.ply", "no mesh"),
        ("ball.off", "no mesh"),
        ("ball.stl", "no mesh"),
        ("ball.stl", ""),
        ("ball.obj", ""),
        ("ball.obj", "no mesh"),
        ("ball.vertices.npy", "no array"),
    ],
)
def test_a_file_that_is_no_mesh_is_garbage(folder: Path, name: str, text: str) -> None:
    (folder / "made" / name).write_text(text)
    outcome = ask(folder)
    assert outcome.status is Status.GARBAGE
    assert outcome.detail


@pytest.mark.parametrize(
    ("suffix", "content"),
    [
        (".off", b"OFF\n0 0 0\n"),
        (".obj", b"# nothing\n"),
        (".stl", bytes(84)),
        (".stl", b"solid nothing\nendsolid nothing\n"),
        (
            ".ply",
            b"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
            b"property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
            b"end_header\n",
        ),
    ],
)
def test_every_format_can_say_that_there_is_no_surface(
    folder: Path, suffix: str, content: bytes
) -> None:
    (folder / f"made/ball{suffix}").write_bytes(content)
    mesh = ask(folder).mesh
    assert mesh is not None
    assert (mesh.vertices.shape, mesh.simplices.shape) == ((0, 3), (0, 3))


def test_two_answers_are_one_too_many(folder: Path) -> None:
    for suffix in (".ply", ".off"):
        trimesh.creation.box().export(folder / f"made/ball{suffix}")
    assert "more than one" in ask(folder).detail


def test_nrrd_and_npy_hold_the_same_field(folder: Path) -> None:
    """NRRD: per-axis spacing and origin in space, first axis first."""
    values, header = nrrd.read(str(folder / "made/ball.nrrd"))
    assert np.array_equal(values, np.load(folder / "made/ball.npy"))
    assert np.array_equal(values, ball().values)
    assert np.array_equal(header["space directions"], np.diag(SPACING))
    assert header["space origin"].tolist() == list(ORIGIN)


@pytest.mark.parametrize("kind", ["bool", "uint8", ">i2", "float16", "float32", "uint64"])
def test_samples_of_any_type_are_exported(tmp_path: Path, kind: str) -> None:
    values = np.arange(24).reshape(2, 3, 4).astype(kind)
    export(tmp_path / "vectors", [Request("a", "plain", Field.of(values), (1.0,))])
    assert np.array_equal(np.load(tmp_path / "vectors/a.npy"), values)
    assert np.array_equal(nrrd.read(str(tmp_path / "vectors/a.nrrd"))[0], values)


def test_components_are_exported_as_arrays_only(tmp_path: Path) -> None:
    pair = Field.of(np.zeros((2, 3, 4, 5)), dimension=3)
    export(tmp_path / "vectors", [Request("a", "plain", pair, (1.0, 2.0))])
    assert sorted(p.name for p in (tmp_path / "vectors").iterdir()) == ["a.npy", "manifest.json"]


def test_a_failed_export_leaves_nothing(tmp_path: Path) -> None:
    def build() -> Field:
        raise RuntimeError("no such volume")

    with pytest.raises(RuntimeError, match="no such volume"):
        export(tmp_path / "vectors", [CASE, Case("a", build, (1.0,), 8)])
    assert list(tmp_path.iterdir()) == []


def test_an_export_overwrites_nothing(folder: Path) -> None:
    with pytest.raises(AdapterError, match="not empty"):
        export(folder, [CASE])


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda f: (f / "manifest.json").unlink(), "isograde export"),
        (lambda f: (f / "manifest.json").write_text("{"), "cannot be read"),
        (lambda f: (f / "manifest.json").write_text("{}"), "required"),
        (
            lambda f: (f / "declaration.json").write_text('{"level": 9}'),
            "9 is no whole number from 0 to 4",
        ),
        (lambda f: None, "no mesh beside any of the 2 fields"),
    ],
)
def test_a_folder_that_cannot_be_judged_is_an_error_of_the_adapter(
    folder: Path, spoil: object, words: str
) -> None:
    assert callable(spoil)
    spoil(folder)
    with pytest.raises(AdapterError, match=words):
        open_adapter(f"dir:{folder}").open(Limits())


def test_the_fingerprint_is_of_everything_that_was_asked() -> None:
    """Samples, type, place and isovalue."""
    field = ball()
    others = [
        (Field.of(field.values, SPACING), (1.0,)),
        (Field.of(field.values, (1, 2, 2), ORIGIN), (1.0,)),
        (Field.of(np.asarray(field.values, "f4"), SPACING, ORIGIN), (1.0,)),
        (Field.of(-field.values, SPACING, ORIGIN), (1.0,)),
        (field, (1.5,)),
        (field, (1.0, 1.0)),
    ]
    assert len({fingerprint(field, (1.0,)), *(fingerprint(*other) for other in others)}) == 7
